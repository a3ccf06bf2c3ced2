"""A start by dead reckoning: every pose is laid where one factor after the other puts it, starting at what is fixed."""

from dataclasses import replace

import numpy as np

from npslam_teach import se2
from npslam_teach.pose_graph.object_headings import faced_from
from npslam_teach.types import PoseGraph


def odometry_start(graph: PoseGraph) -> PoseGraph:
    """The graph laid out along a tree of between factors, odometry before loop closures, and its landmarks where seen.

    The tree has the least sum of ``|i - j|``, so it is the odometry where there is one. Of poses that no between
    factors tie to a fixed one, the first keeps its estimate.

    Args:
        graph: of whose estimate only what the factors leave open is used.
    """
    order, parent = _tree(graph)
    i, j, measured = graph.between.i.tolist(), graph.between.j.tolist(), graph.between.relative_pose
    ends = [*zip(i, j, strict=True), *zip(j, i, strict=True)]
    steps = dict(zip(ends, np.concatenate([measured, se2.inverse(measured)]), strict=True))
    poses = graph.poses.copy()
    for pose in order.tolist():
        if (parent[pose], pose) in steps:
            poses[pose] = se2.compose(poses[parent[pose]], steps[parent[pose], pose])
    return replace(graph, poses=poses, landmarks=faced_from(graph, poses, _where_seen(graph, poses)))


def _tree(graph: PoseGraph) -> tuple[np.ndarray, list[int]]:
    """The poses, each after its parent in the tree; and their parents, T for those that have none."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree

    root, poses = len(graph.poses), np.arange(len(graph.poses))
    # All hang on one root: what is fixed lightly, and everything else only where nothing better is to be had.
    is_fixed = np.isin(poses, graph.fixed_poses)
    to_root = np.where(is_fixed, 0.5, (root + 1.0) * (poses + 1))
    low, high = np.minimum(graph.between.i, graph.between.j), np.maximum(graph.between.i, graph.between.j)
    low, high = np.unique(np.column_stack([low, high]), axis=0).T
    rows, cols = np.append(low, poses), np.append(high, np.full(root, root))
    lengths = np.concatenate([high - low, to_root])
    tree = minimum_spanning_tree(csr_array((lengths, (rows, cols)), shape=(root + 1,) * 2))
    order, parent = breadth_first_order(tree, root, directed=False)
    return order[1:], parent.tolist()


def _where_seen(graph: PoseGraph, poses: np.ndarray) -> np.ndarray:
    """The mean of each landmark's observations, (K, 2) m; the estimate of one that is fixed, or has none."""
    seen, num_landmarks = graph.observations, len(graph.landmarks)
    xy = se2.apply(poses[seen.pose], seen.xy)
    counts = np.bincount(seen.landmark, minlength=num_landmarks)
    sums = [np.bincount(seen.landmark, weights=column, minlength=num_landmarks) for column in xy.T]
    kept = counts == 0
    kept[graph.fixed_landmarks] = True
    return np.where(kept[:, None], graph.landmark_xy, np.column_stack(sums) / np.maximum(counts, 1)[:, None])
