"""The results of ``optimize`` and ``reproduce`` as plain dictionaries (for ``--json``) and as text (for people)."""

import math

from npslam_teach.pose_graph import Optimum

CERTIFICATES = {
    "certified": "certified: no other minimum is lower by more than a millionth of it",
    "gap": "gap <= {gap:.4g}: no other minimum is lower by more",
    "none": "none: nothing is known about lower minima",
}


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
