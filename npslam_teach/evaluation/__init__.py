"""How good is an estimate?

With the truth: ``metrics`` and ``clustering``. Against its own claims: ``consistency``, ``reliability`` and, for
samples, ``convergence``. Without any truth: ``map_quality``, and ``score`` to compare methods. ``confidence`` says how
sure a share of successful runs is.
"""

from npslam_teach.evaluation.clustering import compare_partitions, copies_of, singletons_for_unassigned
from npslam_teach.evaluation.confidence import wilson_interval
from npslam_teach.evaluation.consistency import (
    chi2_bounds,
    chi2_per_dof,
    chi2_score,
    nis_in_windows,
    share_inside,
    share_within,
    true_association_fit,
)
from npslam_teach.evaluation.map_quality import MapQuality, map_quality, position_variance, valid_only
from npslam_teach.evaluation.metrics import Metrics, align_to_truth, compared_labels, distances_to_truth, evaluate
from npslam_teach.evaluation.score import refit, refitted_objective

__all__ = [
    "Metrics",
    "MapQuality",
    "align_to_truth",
    "chi2_bounds",
    "chi2_per_dof",
    "chi2_score",
    "compare_partitions",
    "compared_labels",
    "copies_of",
    "distances_to_truth",
    "evaluate",
    "position_variance",
    "refit",
    "refitted_objective",
    "map_quality",
    "share_inside",
    "share_within",
    "singletons_for_unassigned",
    "true_association_fit",
    "valid_only",
    "nis_in_windows",
    "wilson_interval",
]
