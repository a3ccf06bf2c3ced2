"""Lesson 08: wrong answers and right ones; see ``test_answers``."""

BINCOUNT_4 = """
def position_variance(xy, labels, n):
    m = np.bincount(labels, minlength=n)
    c = np.stack([np.bincount(labels, xy[:, i], n) / m for i in (0, 1)], axis=1)
    return np.bincount(labels, ((xy - c[labels]) ** 2).sum(axis=1), n) / m
"""

LAST_ROW_4 = """
def position_variance(xy, labels, n):
    return [xy[labels == (k if k < n - 1 else labels.max())].var(axis=0).sum() for k in range(n)]
"""

LIBRARY_1 = """
from npslam_teach.camera import back_project

pixel_to_point = back_project
"""

MATRIX_1 = """
lambda u, v, z, c: z * np.linalg.solve([[c.fx, 0, c.cx], [0, c.fy, c.cy], [0, 0, 1]], [u, v, 1])
"""

LOOP_2 = """
def foreground_centre(points):
    near = np.percentile(points[:, 2], 40)
    kept = [p for p in points if near - 0.3 < p[2] < near + 0.3]
    return sum(p[2] for p in kept) / len(kept), -sum(p[0] for p in kept) / len(kept)
"""

AVERAGE_2 = """
lambda p: np.average(p, axis=0, weights=abs(p[:, 2] - np.quantile(p[:, 2], 0.4)) < 0.3)[[2, 0]] * [1, -1]
"""

LOOP_3 = """
def valid_and_inliers(votes, epsilon):
    objects = seen = 0
    for row in votes:
        if row[0] / sum(row) <= epsilon:
            objects += 1
            seen += sum(row[1:])
    return [objects, seen]
"""

VAR_4 = """
lambda xy, labels, n: [xy[labels == k].var(axis=0).sum() if (labels == k).any() else 0 for k in range(n)]
"""

MOMENTS_4 = """
def position_variance(xy, labels, n):
    out = np.full(n, np.nan)
    for k in set(labels.tolist()) - {-1}:
        own = xy[labels == k]
        out[k] = (own**2).sum(axis=1).mean() - (own.mean(axis=0) ** 2).sum()
    return out
"""

TRACE_4 = """
lambda xy, labels, n: np.array(
    [np.trace(np.atleast_2d(np.cov(o.T, bias=True))) if len(o := xy[labels == k]) else 0 for k in range(n)]
)
"""

A_POINT_AHEAD_5 = """
def floor_pose(T):
    here, there = T[:3, 3], (T @ [0, 0, 1, 1])[:3]
    d = there - here
    return here[2], -here[0], np.arctan2(-d[0], d[2])
"""

WRONG = {
    1: {
        "corner": ("(u - camera.cx)", "u"),
        "corner down": ("(v - camera.cy)", "v"),
        "ray": (
            "return np.array([right, down, depth])",
            ("p = np.array([right, down, depth])\n    return p * depth / np.linalg.norm(p)"),
        ),
        "multiplied": ("/ camera.fx", "* camera.fx"),
        "direction": ("[right, down, depth]", "[right / depth, down / depth, 1.0]"),
        "exchanged": ("[right, down, depth]", "[down, right, depth]"),
        "one focal length": ("camera.fy", "camera.fx"),
        "sign": ("(v - camera.cy)", "(camera.cy - v)"),
        "no depth": ("[right, down, depth]", "[right, down]"),
        "depth first": ("[right, down, depth]", "[depth, right, down]"),
        "of one camera": ("camera.fx", "140.0"),
    },
    2: {
        "whole box": ("np.abs(depth - np.quantile(depth, 0.4)) < 0.3", "depth > 0"),
        "median depth": ("0.4", "0.5"),
        "another quantile": ("0.4", "0.35"),
        "another reach": ("< 0.3", "< 0.25"),
        "wider": ("< 0.3", "< 0.35"),
        "a little wider": ("< 0.3", "< 0.305"),
        "a little narrower": ("< 0.3", "< 0.295"),
        "on one side": ("np.abs(depth - np.quantile(depth, 0.4))", "depth - np.quantile(depth, 0.4)"),
        "sign": ("-right", "right"),
        "order": ("[ahead, -right]", "[-right, ahead]"),
        "down": ("right, _, ahead", "_, right, ahead"),
        "median": ("kept.mean(axis=0)", "np.median(kept, axis=0)"),
        "nearest": ("np.abs(depth - np.quantile(depth, 0.4)) < 0.3", "depth < depth.min() + 0.3"),
        "in place": ("depth = points[:, 2]", ("points.sort(axis=0)\n    depth = points[:, 2]")),
    },
    3: {
        "nobody's": ("votes[valid, 1:]", "votes[valid]"),
        "rejected": ("<= epsilon", "> epsilon"),
        "all sightings": ("votes[valid, 1:]", "votes[:, 1:]"),
        "exactly there": ("<= epsilon", "< epsilon"),
        "other votes": ("votes.sum(axis=1) <=", "votes[:, 1:].sum(axis=1) <="),
        "order": ("valid.sum(), votes[valid, 1:].sum()", "votes[valid, 1:].sum(), valid.sum()"),
        "first alone": ("valid.sum(), votes[valid, 1:].sum()", "valid.sum()"),
        "which": ("return valid.sum(),", "return valid,"),
        "share": ("votes[valid, 1:].sum()", "votes[valid, 1:].sum() / max(votes[:, 1:].sum(), 1)"),
        "fixed": ("<= epsilon", "<= 0.25"),
        "text": ("return valid.sum(),", "return str(valid.sum()),"),
    },
    4: {
        "root": ("return variance", "return np.sqrt(variance)"),
        "half": (".sum(axis=1).mean()", ".mean()"),
        "sums": (".sum(axis=1).mean()", ".sum()"),
        "one less": (".sum(axis=1).mean()", ".sum() / max(len(own) - 1, 1)"),
        "origin": ("own - own.mean(axis=0)", "own"),
        "mean of all": ("own - own.mean(axis=0)", "own - xy.mean(axis=0)"),
        "distance": (
            "((own - own.mean(axis=0)) ** 2).sum(axis=1).mean()",
            "np.linalg.norm(own - own.mean(axis=0), axis=1).mean()",
        ),
        "x alone": (".sum(axis=1).mean()", "[:, 0].mean()"),
        "bincount": BINCOUNT_4,
        "last row": LAST_ROW_4,
        "average": ("return variance", "return variance.mean()"),
        "crowd of -1": ("labels == k", "np.where(labels < 0, num_objects - 1, labels) == k"),
        "present ones": ("range(num_objects)", "np.unique(labels)"),
    },
    5: {
        "other way": ("-looks[0], looks[2]", "looks[0], looks[2]"),
        "arctan": ("np.arctan2(-looks[0], looks[2])", "np.arctan(-looks[0] / looks[2])"),
        "y": ("-T[0, 3]", "T[0, 3]"),
        "first two": ("T[2, 3], -T[0, 3]", "T[0, 3], T[1, 3]"),
        "camera's y": ("T[:3, 2]", "T[:3, 1]"),
        "camera's x": ("T[:3, 2]", "T[:3, 0]"),
        "last row": ("T[:3, 2]", "T[2, :3]"),
        "exchanged": ("-looks[0], looks[2]", "looks[2], -looks[0]"),
        "degrees": ("np.arctan2(-looks[0], looks[2])", "np.degrees(np.arctan2(-looks[0], looks[2]))"),
        "no heading": ("np.arctan2(-looks[0], looks[2])", "0.0"),
        "last row of T": ("T[2, 3], -T[0, 3]", "T[3, 2], -T[3, 0]"),
    },
}
RIGHT = {
    1: {
        "library": LIBRARY_1,
        "matrix": MATRIX_1,
        "tuple": ("np.array([right, down, depth])", "(right, down, depth)"),
    },
    2: {
        "sorted": ("np.quantile(depth, 0.4)", "sorted(depth)[int(0.4 * len(depth))]"),
        "loop": LOOP_2,
        "average": AVERAGE_2,
    },
    3: {
        "through m": "lambda v, e: ((m := v[:, 1:].sum(axis=1))[1 / (m + 1) <= e].size, m[1 / (m + 1) <= e].sum())",
        "loop": LOOP_3,
        "array": (
            "return valid.sum(), votes[valid, 1:].sum()",
            "return np.array([valid.sum(), votes[valid, 1:].sum()])",
        ),
    },
    4: {
        "var": VAR_4,
        "moments": MOMENTS_4,
        "trace": TRACE_4,
    },
    5: {
        "complex": ("np.arctan2(-looks[0], looks[2])", "np.angle(looks[2] - 1j * looks[0])"),
        "turned by a whole turn": ("np.arctan2(-looks[0], looks[2])", "np.arctan2(-looks[0], looks[2]) % (2 * np.pi)"),
        "a point ahead": A_POINT_AHEAD_5,
    },
}
