"""The result of ``solve`` as a plain dictionary (for ``--json``) and as text (for people)."""

import math
from dataclasses import asdict

import numpy as np

from npslam_teach.cli.posterior_report import samples_lines
from npslam_teach.evaluation import map_quality
from npslam_teach.experiments.runs import Run, run_summary
from npslam_teach.methods import METHODS
from npslam_teach.types import UNKNOWN, GroundTruth, PoseGraph

OFFICE_THRESHOLD = 0.3  # epsilon: an object of two observations is one no longer doubted


def solve_result(run: Run, truth: GroundTruth | None, refitted: PoseGraph) -> dict:
    """What ``solve --json`` prints: the summary, the association, the trajectory and the map."""
    last = run.snapshots[-1]
    counts = last.votes[:, 1:].sum(axis=1)
    objects = [
        {
            "xy": place[:2].tolist(),
            "class": int(votes[1:].argmax()),
            "votes": votes.tolist(),
            "num_observations": int(count),
        }
        | ({"theta": float(place[2])} if len(place) == 3 else {})
        for place, votes, count in zip(last.graph.landmarks, last.votes, counts, strict=True)
    ]
    quality = asdict(map_quality(last, run.log, OFFICE_THRESHOLD))
    arrays = {"labels": last.labels.tolist(), "poses": last.graph.poses.tolist(), "objects": objects}
    return run_summary(run, truth, refitted) | {"quality": quality} | arrays


def solve_text(result: dict, truth: GroundTruth | None) -> str:
    """The same for people: what was assumed, what was found, and how good it is as far as anybody can tell."""
    lines = [
        f"method                {result['method']}",
        f"assumes               {METHODS[result['method']].assumes}",
        f"settings              {_settings_text(result['settings'])}",
        *_noise_lines(result.get("estimated_noise")),
        f"observations          {result['num_observations']}",
        f"objects               {' -> '.join(map(str, result['counts_per_iteration']))}",
        f"chi2                  {result['chi2']:.2f}",
        f"score                 {result['score']:.2f} (objective of a refit at the log's own noise; lower is better)",
        f"chi2 per dof          {_ratio_text(result['chi2_per_dof'])} (of that refit; near 1 where the noise is right)",
        f"seconds               {result['seconds']:.3f}",
        *_restart_lines(result["restarts"]),
        *(samples_lines(result["posterior"]) if "posterior" in result else []),
    ]
    if truth is None:
        return "\n".join([*lines, *_quality_lines(result["quality"]), "the file holds no truth to compare with"])
    return "\n".join([*lines, *_truth_lines(result["metrics"], truth)])


def _noise_lines(estimated: dict | None) -> list[str]:
    """What the log itself says of its noise, where that was asked for."""
    if estimated is None:
        return []
    stds = {name: " ".join(f"{std:.4g}" for std in estimated[name]) for name in ("odometry_std", "observation_std")}
    lines = [f"estimated noise       odometry {stds['odometry_std']}, observation {stds['observation_std']}"]
    if estimated["outlier_share"] > 0:
        lines.append(f"outliers              {100 * estimated['outlier_share']:.1f}% of the observations")
    if not estimated["is_white"]:
        within = " ".join(f"{std:.4g}" for std in estimated["within_pass_std"])
        lines.append(f"errors last           within one pass they differ by {within} only; methods assume white noise")
    return lines


def _truth_lines(metrics: dict, truth: GroundTruth) -> list[str]:
    """The measures that the truth allows."""
    lines = {
        "mean pose error": _number_text(metrics["mean_pose_error"], " m"),
        "mean object error": _number_text(metrics["mean_object_error"], " m"),
        "objects in truth": "unknown" if math.isnan(metrics["num_objects_true"]) else metrics["num_objects_true"],
        "ARI, V-measure": f"{_number_text(metrics['ari'])}, {_number_text(metrics['v_measure'])}",
        "observations used": f"{100 * metrics['observations_used']:.1f}%",
    }
    if not truth.is_complete:
        lines = {"truth": _known_text(truth)} | lines
    return [f"{name:<22}{text}" for name, text in lines.items()]


def _known_text(truth: GroundTruth) -> str:
    """How much of the truth the file holds."""
    objects, identities = truth.world.object_xy, truth.obs_object != UNKNOWN
    positions = {"poses": truth.poses[:, :2], "headings": truth.poses[:, 2:], "objects": objects}
    known = {name: ~np.isnan(numbers).any(axis=1) for name, numbers in positions.items()} | {"identities": identities}
    return ", ".join(f"{each.sum()} of {len(each)} {name}" for name, each in known.items())


def _ratio_text(ratio: float) -> str:
    return "does not exist" if math.isnan(ratio) else f"{ratio:.3f}"


def _number_text(value: float, unit: str = "") -> str:
    return "unknown" if math.isnan(value) else f"{value:.3f}{unit}"


def _settings_text(settings: dict) -> str:
    """Everything that was used, in one line."""
    words = [settings["name"]] if len(settings) > 1 else ["the log's own noise"]
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
