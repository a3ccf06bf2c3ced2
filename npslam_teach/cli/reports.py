"""The results of one run as plain dictionaries (for ``--json``) and as text (for people)."""

import math
from dataclasses import asdict

from npslam_teach.evaluation import map_quality
from npslam_teach.experiments.runs import Run, run_summary
from npslam_teach.pose_graph import Optimum
from npslam_teach.types import GroundTruth

OFFICE_THRESHOLD = 0.3  # epsilon: an object of two observations is one no longer doubted
CERTIFICATES = {
    "certified": "certified: no other minimum is lower",
    "gap": "gap <= {gap:.4g}: no other minimum is lower by more",
    "none": "none: nothing is known about lower minima",
}


def solve_result(run: Run, truth: GroundTruth | None) -> dict:
    """What ``solve --json`` prints: the summary, the association, the trajectory and the map."""
    last = run.snapshots[-1]
    counts = last.votes[:, 1:].sum(axis=1)
    objects = [
        {
            "xy": xy.tolist(),
            "class": int(votes[1:].argmax()),
            "votes": votes.tolist(),
            "num_observations": int(count),
        }
        for xy, votes, count in zip(last.graph.landmarks, last.votes, counts, strict=True)
    ]
    quality = asdict(map_quality(last, run.log, OFFICE_THRESHOLD))
    arrays = {"labels": last.labels.tolist(), "poses": last.graph.poses.tolist(), "objects": objects}
    return run_summary(run, truth) | {"quality": quality} | arrays


def solve_text(result: dict) -> str:
    """The same for people."""
    lines = [
        f"method                {result['method']}",
        f"settings              {_settings_text(result['settings'])}",
        f"observations          {result['num_observations']}",
        f"objects               {' -> '.join(map(str, result['counts_per_iteration']))}",
        f"chi2                  {result['chi2']:.2f}",
        *([] if result["objective"] is None else [f"objective             {result['objective']:.2f}"]),
        f"seconds               {result['seconds']:.3f}",
        *_restart_lines(result["restarts"]),
    ]
    metrics = result.get("metrics")
    if metrics is None:
        return "\n".join([*lines, *_quality_lines(result["quality"]), "the file holds no truth to compare with"])
    return "\n".join(
        [
            *lines,
            f"mean pose error       {metrics['mean_pose_error']:.3f} m",
            f"mean object error     {_number_text(metrics['mean_object_error'], ' m')}",
            f"objects in truth      {metrics['num_objects_true']}",
            f"ARI, V-measure        {metrics['ari']:.3f}, {metrics['v_measure']:.3f}",
            f"observations used     {100 * metrics['observations_used']:.1f}%",
            f"chi2 per dof          {_number_text(metrics['chi2_per_dof'])}",
        ]
    )


def _number_text(value: float, unit: str = "") -> str:
    return "does not exist" if math.isnan(value) else f"{value:.3f}{unit}"


def _settings_text(settings: dict) -> str:
    """Everything that was used, in one line."""
    words = [settings["name"]]
    for name, value in settings.items():
        if name == "exclusive":
            words.append("one object per observation of a frame" if value else "observations one by one")
        elif name != "name":
            numbers = value if isinstance(value, tuple | list) else [value]
            shown = " ".join(each if isinstance(each, str) else f"{each:.4g}" for each in numbers)
            words.append(f"{name.replace('_', '-')} {shown}")
    return ", ".join(words)


def _restart_lines(restarts: list[dict]) -> list[str]:
    """How much hangs on the order of the visits."""
    if len(restarts) == 1:
        return []
    counts, objectives = ([each[name] for each in restarts] for name in ("num_objects", "objective"))
    spread = f"{min(counts)} to {max(counts)} objects, objective {min(objectives):.2f} to {max(objectives):.2f}"
    return [f"restarts              {len(restarts)} orders: {spread}; the lowest is kept"]


def _quality_lines(quality: dict) -> list[str]:
    """The measures of lesson 08, for a result that nobody can compare with the truth."""
    scatter = quality["position_variance"]
    return [
        f"valid objects         {quality['num_valid']}",
        f"their observations    {quality['num_inliers']}",
        *([] if math.isnan(scatter) else [f"scatter               {math.sqrt(scatter):.3f} m around the objects"]),
    ]


def optimize_result(optimum: Optimum, chi2_initial: float, seconds) -> dict:
    """What ``optimize --json`` prints."""
    last = optimum.iterations[-1]
    return {
        "chi2": last.chi2,
        "chi2_initial": chi2_initial,
        "certificate": optimum.certificate.status,
        "gap": optimum.certificate.gap,
        "smallest_eigenvalue": optimum.certificate.smallest_eigenvalue,
        "certificate_seconds": optimum.certificate_seconds,
        "start": optimum.start,
        "chi2_by_start": optimum.chi2_by_start,
        "iterations": last.iteration,
        "converged": last.converged,
        "status": last.status,
        "seconds": seconds,
        "poses": last.graph.poses.tolist(),
        "landmarks": last.graph.landmarks.tolist(),
    }


def optimize_text(result: dict) -> str:
    """The same for people."""
    seconds = result["seconds"] if isinstance(result["seconds"], list) else [result["seconds"]]
    return "\n".join(
        [
            f"poses, landmarks      {len(result['poses'])}, {len(result['landmarks'])}",
            f"chi2                  {result['chi2_initial']:.6g} -> {result['chi2']:.6f}",
            f"iterations            {result['iterations']} from the {result['start']} start ({result['status']})",
            f"certificate           {CERTIFICATES[result['certificate']].format(**result)}",
            f"seconds               {', '.join(f'{s:.4f}' for s in seconds)}",
            f"of the certificate    {result['certificate_seconds']:.4f}, other starts included",
        ]
    )


def plain(value):
    """The value as JSON can say it: NaN and infinity become null."""
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def table(header: list[str], rows: list[list[str]]) -> str:
    """Columns side by side: the first to the left, the others to the right."""
    widths = [max(len(row[k]) for row in [header, *rows]) for k in range(len(header))]
    lines = [
        "  ".join([row[0].ljust(widths[0]), *(c.rjust(w) for c, w in zip(row[1:], widths[1:], strict=True))])
        for row in [header, *rows]
    ]
    return "\n".join(line.rstrip() for line in lines)


def reproduce_text(result: dict) -> str:
    """What ``reproduce`` prints for people."""
    scene, summary = result["scene"], result["summary"]
    num_runs = max(entry["num_runs"] for entry in summary.values())
    parts = [_scene_text(scene)]
    if result["iterations"]:
        parts.append("NP-graph, iteration by iteration\n" + _iterations_text(result["iterations"]))
    what = "seed " + str(scene["seed"]) if num_runs == 1 else f"medians of {num_runs} runs"
    parts.append(f"methods, {what}\n" + _methods_text(summary))
    if num_runs > 1 and "np-graph" in summary:
        entry = summary["np-graph"]
        parts.append(f"exactly {scene['num_objects']} objects: {entry['num_exact']} of {num_runs} runs")
        if result["iterations_at_most"] >= 5:
            share = f"{100 * entry['share_exact_after_five']:.0f}%"
            parts[-1] += f" ({share} after five alternations, as the paper ran it)"
    return "\n\n".join(parts)


def _scene_text(scene: dict) -> str:
    return (
        f"{scene['name']}, seed {scene['seed']}, noise {scene['noise']:g}: {scene['num_poses']} poses on "
        f"{scene['path_length']:.1f} m, {scene['num_observations']} observations, {scene['num_objects']} objects "
        f"of {scene['num_classes']} classes\n"
        f"chi2 per degree of freedom with the true association: {scene['chi2_per_dof_true_association']:.3f}"
    )


def _iterations_text(rows: list[dict]) -> str:
    header = ["iteration", "objects", "chi2", "objective", "mean pose error (m)"]
    cells = [
        [
            str(row["iteration"]),
            str(row["num_objects"]),
            f"{row['chi2']:.1f}",
            f"{row['objective']:.1f}",
            f"{row['mean_pose_error']:.3f}",
        ]
        for row in rows
    ]
    return table(header, cells)


def _methods_text(summary: dict) -> str:
    header = [
        "method",
        "mean pose error (m)",
        "cumulative (m)",
        "observations used",
        "objects",
        "object error (m)",
        "ARI",
    ]
    cells = [
        [
            method,
            f"{entry['median_mean_pose_error']:.3f}",
            f"{entry['median_cumulative_pose_error']:.1f}",
            f"{entry['median_num_observations_used']:.0f}",
            f"{entry['median_num_objects']:g}",
            f"{entry['median_mean_object_error']:.3f}",
            f"{entry['median_ari']:.3f}",
        ]
        for method, entry in summary.items()
    ]
    return table(header, cells)
