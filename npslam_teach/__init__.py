"""Object SLAM with unknown data association: a small library and the course built on it.

Names are loaded on first use, so that ``import npslam_teach`` costs next to nothing::

    import npslam_teach as nt

    log, truth = nt.fifteen_objects(seed=0)
    *_, last = nt.np_graph(log)
    print(nt.evaluate.evaluate(last, truth, log))
"""

import importlib

__version__ = "0.1.0"

_HOME_OF = {
    "World": "data",
    "SensorModel": "data",
    "RobotLog": "data",
    "GroundTruth": "data",
    "BetweenFactors": "data",
    "ObservationFactors": "data",
    "PoseGraph": "data",
    "Snapshot": "data",
    "simulate_run": "simulate",
    "fifteen_objects": "simulate",
    "toy_objects": "simulate",
    "office": "simulate",
    "add_noise": "simulate",
    "load_log": "datasets",
    "save_log": "datasets",
    "load_mu2016_simulation": "datasets",
    "fetch_mu2016_simulation": "datasets",
    "load_stata_office": "datasets",
    "fetch_stata_office": "datasets",
    "load_g2o": "datasets",
    "save_g2o": "datasets",
    "dead_reckoning": "se2",
    "linearize": "linearization",
    "gauss_newton": "pose_graph",
    "optimize": "pose_graph",
    "chordal_start": "chordal",
    "marginal_covariance": "covariance",
    "IncrementalSolver": "incremental",
    "association_probabilities": "associate",
    "decide": "associate",
    "sweep": "associate",
    "np_graph": "methods",
    "frame_by_frame": "methods",
    "open_loop": "methods",
    "robust_slam": "methods",
    "ekf_slam": "methods",
}
_MODULES = (
    "associate centroids checks chordal covariance data datasets dirichlet drawing evaluate factorize figures "
    "incremental linearization methods plotting pose_graph residuals se2 simulate sparse widgets without_truth"
).split()

__all__ = sorted(_HOME_OF)


def __getattr__(name):
    if name in _HOME_OF:
        value = getattr(importlib.import_module("." + _HOME_OF[name], __name__), name)
        globals()[name] = value
        return value
    if name in _MODULES:
        return importlib.import_module("." + name, __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__():
    return sorted(set(globals()) | set(_HOME_OF) | set(_MODULES))
