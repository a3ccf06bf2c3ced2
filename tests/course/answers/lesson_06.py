"""Lesson 06: wrong answers and right ones; see ``test_answers``."""

OVERFLOW_1 = """
from scipy.special import gamma

my_objective = lambda c, v, a, A: (
    c / 2 - len(v) * log(a / A) - np.log(np.prod([gamma(m) for m in v[:, 1:].ravel() if m > 0]))
)
"""

IN_PLACE_2 = """
def votes_of_others(k, labels, c, n):
    own = c == c[k]
    labels[k] = 0
    own[k] = False
    return np.bincount(labels[own], minlength=n)
"""

LIBRARY_1 = """
from npslam_teach.association import objective

my_objective = objective
"""

GAMMALN_1 = """
from scipy.special import gammaln

my_objective = lambda c, v, a, A: (
    c / 2 - len(v) * np.log(a / A) - gammaln(np.where(v[:, 1:] > 0, v[:, 1:], 1)).sum()
)
"""

FACTORIAL_1 = """
from math import factorial

my_objective = lambda c, v, a, A: (
    c / 2 + len(v) * (log(A) - log(a)) - sum(log(factorial(int(m) - 1)) for m in v[:, 1:].ravel() if m)
)
"""

COMPREHENSION_2 = """
lambda k, x, c, n: [sum(1 for j in range(len(x)) if j != k and x[j] == i and c[j] == c[k]) for i in range(n)]
"""

TAKEN_BACK_2 = """
def votes_of_others(k, x, c, n):
    v = np.bincount(x[c == c[k]], minlength=n)
    v[x[k]] -= 1
    return v
"""

RESTARTED_3 = """
from dataclasses import replace


def one_alternation(log, g, x, a, s):
    seen_at = se2.apply(g.poses[log.obs_time], log.obs_xy)
    f = sweep(x, g.landmarks, seen_at, log.obs_class, a)
    tied = with_associations(log, g, f.labels, f.landmarks, s)
    means = f.landmarks.copy()
    for i in set(f.labels.tolist()):
        means[i] = seen_at[f.labels == i].mean(axis=0)
    return f.labels, optimize(replace(tied, landmarks=means))
"""

OTHER_NAMES_3 = """
from npslam_teach.pose_graph import chi2


def one_alternation(log, g, x, a, s):
    f = sweep(x, g.landmarks, se2.apply(g.poses[log.obs_time], log.obs_xy), log.obs_class, a)
    n = len(f.landmarks)
    return n - 1 - f.labels, optimize(with_associations(log, g, n - 1 - f.labels, f.landmarks[::-1], s))
"""

LIBRARY_4 = """
from npslam_teach.association import class_posterior

kept = lambda v, e: [bool(p[0] <= e) for p in class_posterior(v)]
"""

WRONG = {
    1: {
        "not halved": ("chi2 / 2", "chi2"),
        "column 0": ("votes[:, 1:]", "votes"),
        "log m!": ("lgamma(m)", "lgamma(m + 1)"),
        "log m": ("lgamma(m)", "log(m)"),
        "sign of crowds": ("- crowds", "+ crowds"),
        "sign of alpha": ("- len(votes)", "+ len(votes)"),
        "no area": ("log(alpha / area)", "log(alpha)"),
        "alpha once": ("len(votes) * ", ""),
        "classes added": ("votes[:, 1:].ravel()", "votes[:, 1:].sum(axis=1)"),
        "turned round": ("return chi2 / 2 - len(votes)", "return crowds * 2 - chi2 / 2 + len(votes)"),
        "overflow": OVERFLOW_1,
        "alpha at most 1": ("log(alpha / area)", "log(min(alpha, 1.0) / area)"),
        "new object never pays": ("log(alpha / area)", "-abs(log(alpha / area))"),
    },
    2: {
        "no minlength": (", minlength=num_objects", ""),
        "sized by labels": ("minlength=num_objects", "minlength=max(labels) + 1"),
        "own vote": "lambda k, x, c, n: np.bincount(x[c == c[k]], minlength=n)",
        "any class": "lambda k, x, c, n: np.bincount(np.delete(x, k), minlength=n)",
        "everything": "lambda k, x, c, n: np.bincount(x, minlength=n)",
        "own object empty": "lambda k, x, c, n: np.bincount(x[(c == c[k]) & (x != x[k])], minlength=n)",
        "one less each": "lambda k, x, c, n: np.bincount(x[c == c[k]], minlength=n) - 1",
        "the one before": ("np.delete(labels, k)", "np.delete(labels, k - 1)"),
        "other classes": ("== obs_class[k]", "!= obs_class[k]"),
        "in place": IN_PLACE_2,
    },
    3: {
        "no new labels": ("found.labels, optimize", "labels, optimize"),
        "not solved": ("found.labels, optimize(graph)", "found.labels, graph"),
        "old graph": (
            ("graph = with_associations(log, graph, found.labels, found.landmarks, observation_std)\n    "),
            "",
        ),
        "wheels": ("graph.poses[", "se2.dead_reckoning(log.odometry)["),
        "fixed alpha": ((", alpha)\n"), (", 0.5)\n")),
        "alpha of one": ((", alpha)\n"), (", 1.0)\n")),
        "fixed std": ("found.landmarks, observation_std", "found.landmarks, (0.35, 0.35)"),
        "labels ignored": ("sweep(labels, graph.landmarks", "sweep(np.arange(len(labels)), seen_at"),
        "landmarks ignored": (
            "    found = sweep(labels, graph.landmarks",
            "    means = np.array([seen_at[labels == i].mean(axis=0) for i in range(max(labels) + 1)])\n"
            "    found = sweep(labels, means",
        ),
        "not carried": ("se2.apply(graph.poses[log.obs_time], log.obs_xy)", "log.obs_xy"),
        "labels alone": ("found.labels, optimize(graph)", "found.labels"),
        "swapped": ("found.labels, optimize(graph)", "optimize(graph), found.labels"),
        "two sweeps": (
            "    graph = with",
            ("    found = sweep(found.labels, found.landmarks, seen_at, log.obs_class, alpha)\n    graph = with"),
        ),
    },
    4: {
        "those that go": ("<= epsilon", "> epsilon"),
        "exactly there": ("<= epsilon", "< epsilon"),
        "other votes": ("votes.sum(axis=1)", "votes[:, 1:].sum(axis=1)"),
        "no division": (" / votes.sum(axis=1)", ""),
        "everything": ("votes.sum(axis=1)", "votes.sum()"),
        "column 1": ("votes[:, 0]", "votes[:, 1]"),
        "all": "lambda v, e: np.ones(len(v), dtype=bool)",
        "fixed": ("<= epsilon", "<= 0.4"),
        "count": "lambda v, e: np.sum(v[:, 0] / v.sum(axis=1) <= e)",
        "votes": "lambda v, e: v[v[:, 0] / v.sum(axis=1) <= e]",
        "text": "lambda v, e: ['True' if x else 'False' for x in v[:, 0] / v.sum(axis=1) <= e]",
    },
}
RIGHT = {
    1: {
        "library": LIBRARY_1,
        "gammaln": GAMMALN_1,
        "factorial": FACTORIAL_1,
    },
    2: {
        "comprehension": COMPREHENSION_2,
        "taken back": TAKEN_BACK_2,
        "weights": "lambda k, x, c, n: np.bincount(x, weights=(c == c[k]) & (np.arange(len(x)) != k), minlength=n)",
    },
    3: {
        "list": ("found.labels, optimize(graph)", "[list(found.labels), optimize(graph)]"),
        "other names": OTHER_NAMES_3,
        "solved twice": ("found.labels, optimize(graph)", "found.labels, optimize(optimize(graph))"),
        "restarted at the means": RESTARTED_3,
        "loop": (
            "se2.apply(graph.poses[log.obs_time], log.obs_xy)",
            "np.array([se2.apply(graph.poses[t], z) for t, z in zip(log.obs_time, log.obs_xy)])",
        ),
    },
    4: {
        "through m": "lambda v, e: 1 / (1 + v[:, 1:].sum(axis=1)) <= e",
        "not above": "lambda v, e: ~(v[:, 0] / v.sum(axis=1) > e)",
        "library": LIBRARY_4,
    },
}
