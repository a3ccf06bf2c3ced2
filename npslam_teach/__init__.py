"""Object SLAM with unknown data association: a small library and the course built on it.

Names are loaded on first use, so that ``import npslam_teach`` costs next to nothing::

    import npslam_teach as nt

    log, truth = nt.fifteen_objects(seed=0)
    *_, last = nt.np_graph(log)
    print(nt.evaluate(last, truth, log))
"""

import importlib

__version__ = "0.1.0"

_PUBLIC_NAMES = {
    "types": "World SensorModel RobotLog GroundTruth BetweenFactors ObservationFactors PoseGraph Snapshot",
    "simulate": "simulate_run fifteen_objects toy_objects office add_noise",
    "datasets": "load_log save_log load_mu2016_simulation fetch_mu2016_simulation load_stata_office "
    "fetch_stata_office load_g2o save_g2o",
    "se2": "dead_reckoning",
    "pose_graph": "linearize gauss_newton optimize chordal_start marginal_covariance IncrementalSolver",
    "association": "association_probabilities decide sweep",
    "methods": "np_graph frame_by_frame open_loop robust_slam ekf_slam posterior sample_posterior estimate_noise",
    "evaluation": "evaluate",
}
_HOME_OF = {name: home for home, names in _PUBLIC_NAMES.items() for name in names.split()}
_FOLDERS_AND_MODULES = (
    "association camera course datasets evaluation experiments methods plotting pose_graph se2 simulate types"
).split()

__all__ = sorted(_HOME_OF)


def __getattr__(name):
    if name in _HOME_OF:
        value = getattr(importlib.import_module("." + _HOME_OF[name], __name__), name)
        globals()[name] = value
        return value
    if name in _FOLDERS_AND_MODULES:
        return importlib.import_module("." + name, __name__)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__():
    return sorted(set(globals()) | set(_HOME_OF) | set(_FOLDERS_AND_MODULES))
