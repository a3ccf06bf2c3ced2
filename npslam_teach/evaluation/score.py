"""One number by which results of different methods on one log can be compared when nobody knows the truth."""

from npslam_teach.association import PAPER_ALPHA, count_votes, objective
from npslam_teach.evaluation.clustering import singletons_for_unassigned
from npslam_teach.pose_graph import chi2, fit
from npslam_teach.types import PoseGraph, RobotLog, Snapshot


def refit(snapshot: Snapshot, log: RobotLog) -> PoseGraph:
    """The best fit that the associations of a result allow, at the log's own noise.

    What a method assumed of the sensor, and where it stopped, does not count. An observation that it left out is an
    object of its own, which adds nothing to chi2 and no degree of freedom.

    Args:
        snapshot: the result of any method.
        log: what it was made from.
    """
    return fit(log, singletons_for_unassigned(snapshot.labels), snapshot.graph.poses)


def refitted_objective(
    snapshot: Snapshot, log: RobotLog, alpha: float = PAPER_ALPHA, area: float = 1.0, graph: PoseGraph | None = None
) -> float:
    """The objective of a result's associations alone, after the best fit at the log's own noise; lower is better.

    An observation that the method left out counts as an object of its own: else leaving out would always pay.

    Args:
        snapshot: the result of any method.
        log: what it was made from.
        alpha: concentration of the Dirichlet process, one for all methods.
        area: m^2, the same.
        graph: of ``refit``, where it is known.
    """
    graph = refit(snapshot, log) if graph is None else graph
    labels = singletons_for_unassigned(snapshot.labels)
    votes = count_votes(labels, log.obs_class, len(graph.landmarks), log.num_classes)
    return objective(chi2(graph), votes, alpha, area)
