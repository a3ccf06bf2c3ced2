"""One number by which results of different methods on one log can be compared when nobody knows the truth."""

from npslam_teach.association import PAPER_ALPHA, count_votes, objective
from npslam_teach.evaluation.clustering import singletons_for_unassigned
from npslam_teach.pose_graph import chi2, fit
from npslam_teach.types import RobotLog, Snapshot


def refitted_objective(snapshot: Snapshot, log: RobotLog, alpha: float = PAPER_ALPHA, area: float = 1.0) -> float:
    """The objective of a result's associations alone, after the best fit at the log's own noise; lower is better.

    What a method assumed of the sensor, and where it stopped, does not count. An observation that it left out counts as
    an object of its own: else leaving out would always pay.

    Args:
        snapshot: the result of any method.
        log: what it was made from.
        alpha: concentration of the Dirichlet process, one for all methods.
        area: m^2, the same.
    """
    labels = singletons_for_unassigned(snapshot.labels)
    graph = fit(log, labels, snapshot.graph.poses)
    votes = count_votes(labels, log.obs_class, len(graph.landmarks), log.num_classes)
    return objective(chi2(graph), votes, alpha, area)
