"""The command ``solve``: which settings a method gets, how often it is run, and what is said of the answer."""

import math
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from npslam_teach import experiments, se2, simulate
from npslam_teach.association import PAPER_ALPHA, same_partition
from npslam_teach.cli.posterior_report import samples_result
from npslam_teach.evaluation import chi2_per_dof, refitted_objective
from npslam_teach.evaluation.consistency import degrees_of_freedom
from npslam_teach.methods import METHODS, paper_settings, sample_posterior, settings_for
from npslam_teach.methods.noise import with_noise
from npslam_teach.methods.noise_estimate import estimate_noise
from npslam_teach.methods.snapshots import snapshot
from npslam_teach.pose_graph import fit
from npslam_teach.system.progress import track
from npslam_teach.types import PoseGraph, RobotLog

LEAST_SAMPLES = 16  # four for each chain: fewer tell nothing of how they agree
MINDS_THE_NOISE = ("np-graph", "ekf", "soft-em", "posterior")  # of the others no other noise would mend the answer
GIVEN = "alpha threshold kernel_std odometry_std observation_std area order iterations gate window".split()
GIVEN += ["exclusive", "starts"]


def settings_name(options) -> str:
    """Paper or sensor: as asked for, or the paper's own for its own files."""
    return options.settings or ("paper" if Path(options.log).suffix.lower() == ".mat" else "sensor")


def settings_of(options, log: RobotLog) -> dict:
    """The settings that the method is called with; ``require_options`` has seen that it has those asked for."""
    scale = paper_settings() if settings_name(options) == "paper" else settings_for(log)
    return METHODS[options.method].scaled_by(scale) | {
        name: getattr(options, name) for name in GIVEN if getattr(options, name) is not None
    }


def require_options(options) -> None:
    """Raise ``ValueError`` for an option that the method does not have, before any file is read."""
    for name in GIVEN:
        if getattr(options, name) is not None:
            _require(METHODS[options.method].settings, options.method, name)
    if options.samples is not None and options.method != "posterior":
        raise ValueError(f"--samples: expected the method posterior, got {options.method}")
    if options.samples is not None and options.samples < LEAST_SAMPLES:
        raise ValueError(f"--samples: expected at least {LEAST_SAMPLES}, got {options.samples}")
    if options.restarts > 1:
        _require(METHODS[options.method].settings, options.method, "order")
        if options.order is not None:
            raise ValueError("--restarts: expected no --order beside it, because every restart has an order of its own")


def sampled(options, log: RobotLog, settings: dict, found: experiments.Run) -> dict:
    """Where samples are asked for, the posterior around the best partition: ``posterior_report.samples_result``."""
    if options.samples is None:
        return {}
    log = with_noise(log, settings.get("odometry_std"), settings.get("observation_std"))
    known = {name: settings[name] for name in ("alpha", "area", "starts") if name in settings}
    return {"posterior": samples_result(sample_posterior(log, options.samples, found=found.snapshots[-1], **known))}


def with_added_noise(options, log: RobotLog) -> RobotLog:
    """The log with more noise, where that is asked for."""
    rng = np.random.default_rng(options.seed or 0)
    return simulate.add_noise(log, options.noise, rng) if options.noise != 0 else log


def with_estimated_noise(options, log: RobotLog) -> tuple[RobotLog, dict]:
    """Where it is asked for, the log with the noise that its residuals show, and what was found."""
    if not options.estimate_noise:
        return log, {}
    if settings_name(options) == "paper" and METHODS[options.method].settings.get("odometry_std") is not None:
        raise ValueError("--estimate-noise: expected --settings sensor, because the paper's do not look at the noise")
    estimate = estimate_noise(log)
    if not estimate.converged:
        warnings.warn(f"the noise was still changing after {estimate.rounds} rounds of estimation", stacklevel=2)
    numbers = {
        "odometry_std": estimate.odometry_std.tolist(),
        "observation_std": estimate.observation_std.tolist(),
        "within_pass_std": estimate.within_pass_std.tolist(),
        "outlier_share": estimate.outlier_share,
        "is_white": estimate.is_white,
        "rounds": estimate.rounds,
        "converged": estimate.converged,
    }
    return estimate.applied_to(log), {"estimated_noise": numbers}


def agreement(options, found: experiments.Run, refitted: PoseGraph) -> dict:
    """How well the associations fit the log's own noise: chi2 per degree of freedom, and one score for all methods."""
    last, given = found.snapshots[-1], {"alpha": options.alpha, "area": options.area}
    constants = {name: value for name, value in given.items() if value is not None}
    return {
        "score": refitted_objective(last, found.log, graph=refitted, **constants),
        "chi2_per_dof": chi2_per_dof(refitted),
        "dof": degrees_of_freedom(refitted),
    }


def run(options, log: RobotLog, settings: dict) -> tuple[experiments.Run, list[dict]]:
    """The run with the lowest objective among all restarts, and what every restart came to."""
    orders = [None] + [np.random.default_rng([options.seed or 0, k]) for k in range(1, options.restarts)]
    best, restarts = None, []
    for rng in track(orders, options.restarts, "restarts", "orders"):
        order = {} if rng is None else {"order": rng.permutation(log.num_observations)}
        attempt = experiments.run_method(options.method, log, settings | order)
        last = attempt.snapshots[-1]
        restarts.append({"num_objects": last.num_objects, "objective": last.objective})
        if best is None or last.objective < best.snapshots[-1].objective:
            best = attempt
    if options.method == "ekf" and not options.filter_only:
        last = best.snapshots[-1]
        best.snapshots.append(snapshot(log, 2, last.labels, fit(log, last.labels, last.graph.poses)))
    return best, restarts


def remarks(options, log: RobotLog, settings: dict, found: experiments.Run, fits: dict) -> None:
    """Warn of what a reader would otherwise take for an answer."""
    texts = *_of_the_search(options, settings, found), *_without_effect(options, log), *_of_the_fit(options, fits)
    for text in (*texts, *_of_the_rule(options, log, settings), *_of_the_answer(options, found)):
        warnings.warn(text, stacklevel=2)


def _of_the_search(options, settings: dict, found: experiments.Run) -> Iterator[str]:
    """Whether it could have gone on."""
    if settled(found, settings) is False:
        yield f"stopped after {len(found.snapshots) - 1} iterations while labels were still changing; see --iterations"
    starts = settings.get("starts", METHODS[options.method].settings.get("starts"))
    if options.method == "posterior" and searches_of(found) == starts:
        yield f"all {starts} searches were needed, and the best partition may not have been found twice; see --starts"


def _of_the_fit(options, fits: dict) -> Iterator[str]:
    """Whether the noise of the log is that of its residuals."""
    if _misfits(fits["chi2_per_dof"], fits["dof"]):
        text = f"chi2 per degree of freedom is {fits['chi2_per_dof']:.3g}: the noise in the log is wrong, or who is who"
        yield text + ("; see --estimate-noise" if options.method in MINDS_THE_NOISE else "")


def _of_the_rule(options, log: RobotLog, settings: dict) -> Iterator[str]:
    """Whether a setting leaves nothing to decide."""
    threshold, most = settings.get("threshold"), 1 / (1 + settings.get("alpha", PAPER_ALPHA))
    if options.method == "np-graph" and threshold is not None and threshold >= most:
        text = f"--threshold {threshold:g}: expected less than {most:.3f}, the most that two observations can reach"
        yield f"{text}; nothing can be merged"
    places = se2.apply(se2.dead_reckoning(log.odometry)[log.obs_time], log.obs_xy)
    extent = float(np.ptp(places, axis=0).max()) if len(places) else math.inf
    if settings.get("kernel_std", 0.0) > extent > 0:
        text = f"the kernel is {settings['kernel_std']:.3g} m wide, more than all that was seen ({extent:.3g} m)"
        yield f"{text}; classes alone decide who is who"


def _of_the_answer(options, found: experiments.Run) -> Iterator[str]:
    """Whether nothing was merged, or hardly anything used."""
    last, count = found.snapshots[-1], found.log.num_observations
    if options.method != "frame-by-frame" and last.num_objects == count > 1:
        yield "nothing was merged: every observation is an object of its own"
    used = int(np.count_nonzero(last.labels >= 0))
    if used < count / 2:
        yield f"only {used} of {count} observations are of an object in this answer; the others are left out"


def _misfits(ratio: float, dof: int) -> bool:
    """Whether chi2 per degree of freedom is off by more than chance explains, and by a factor of two."""
    margin = 3 * math.sqrt(2 / max(dof, 1))
    return dof > 0 and not (min(0.5, 1 - margin) <= ratio <= max(2.0, 1 + margin))


def _without_effect(options, log: RobotLog) -> Iterator[str]:
    """What a log carries and a method does not look at, and what it assumes instead; an option that nothing needs."""
    carried = [name for name in ("odometry_cov", "observation_cov") if getattr(log, name) is not None]
    method = options.method
    if carried and METHODS[method].settings["odometry_std"] is not None:
        yield f"{method} assumes one noise for all: {' and '.join(carried)} of the log have no effect"
    if log.class_probabilities is not None and not METHODS[method].sees_classes:
        yield f"{method} takes the most likely class for certain: class_probabilities of the log have no effect"
    if log.obs_theta is not None and not METHODS[method].sees_headings:
        yield f"{method} takes objects for points: obs_theta of the log has no effect"
    if options.seed is not None and options.noise == 0 and options.restarts == 1:
        yield "--seed has no effect without --noise or --restarts"


def searches_of(found: experiments.Run) -> int:
    """How often ``posterior`` searched: it also keeps the start, the tracklets and the repaired or polished end."""
    return len(found.snapshots) - 3


def settled(found: experiments.Run, settings: dict) -> bool | None:
    """Whether an alternation ended because no label changed any more; None for methods that do not alternate."""
    known = METHODS[found.method].settings
    if "iterations" not in known:
        return None
    if len(found.snapshots) - 1 < settings.get("iterations", known["iterations"]):
        return True
    return len(found.snapshots) > 1 and same_partition(found.snapshots[-2].labels, found.snapshots[-1].labels)


def _require(known: dict, method: str, name: str) -> None:
    if name not in known:
        option = name.replace("_", "-")
        raise ValueError(f"--{option}: expected a method that has it, got {method}")
