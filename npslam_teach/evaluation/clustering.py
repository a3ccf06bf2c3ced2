"""How alike are two partitions of the observations? The adjusted Rand index and the V-measure."""

import numpy as np

from npslam_teach.types import GroundTruth, Snapshot


def singletons_for_unassigned(labels: np.ndarray) -> np.ndarray:
    """Give every -1 (clutter, or left out) a cluster of its own: it belongs with nothing else."""
    alone = labels < 0
    fresh = labels.max(initial=-1) + 1 + np.arange(np.count_nonzero(alone))
    labels = np.array(labels)
    labels[alone] = fresh
    return labels


def compare_partitions(true_labels: np.ndarray, labels: np.ndarray) -> tuple[float, float]:
    """Adjusted Rand index (Hubert and Arabie 1985) and V-measure (Rosenberg and Hirschberg 2007).

    Both are 1 for the same partition, whatever the clusters are called. ARI is 0 on average for a random one.

    Args:
        true_labels: (M,) non-negative integers.
        labels: (M,) non-negative integers.
    """
    _, row = np.unique(true_labels, return_inverse=True)
    _, col = np.unique(labels, return_inverse=True)
    num_rows, num_cols = row.max(initial=-1) + 1, col.max(initial=-1) + 1
    # Only the cells of the contingency table that are not empty: 1098 singletons must not make a 1098 x 1098 table.
    cells = np.unique(row * max(num_cols, 1) + col, return_counts=True)[1]
    rows, cols = np.bincount(row, minlength=num_rows), np.bincount(col, minlength=num_cols)
    return _adjusted_rand(cells, rows, cols), _v_measure(cells, rows, cols)


def _adjusted_rand(cells: np.ndarray, rows: np.ndarray, cols: np.ndarray) -> float:
    together, in_true, in_found, pairs = (_num_pairs(counts) for counts in (cells, rows, cols, rows.sum()))
    expected = in_true * in_found / pairs if pairs else 0.0
    most = (in_true + in_found) / 2
    return 1.0 if most == expected else float((together - expected) / (most - expected))


def _num_pairs(counts: np.ndarray) -> float:
    return float((counts * (counts - 1.0) / 2).sum())


def _v_measure(cells: np.ndarray, rows: np.ndarray, cols: np.ndarray) -> float:
    """Harmonic mean of homogeneity ``I / H(true)`` and completeness ``I / H(found)``: ``2 I / (H + H)``."""
    h_true, h_found, h_joint = (_entropy(counts) for counts in (rows, cols, cells))
    total = h_true + h_found
    return 1.0 if total == 0 else float(2 * (total - h_joint) / total)


def _entropy(counts: np.ndarray) -> float:
    share = counts[counts > 0] / max(counts.sum(), 1)
    return float(-(share * np.log(share)).sum())


def copies_of(snapshot: Snapshot, truth: GroundTruth, at_least: int = 5) -> dict[int, list[int]]:
    """The found objects that hold at least so many observations of each true object that was seen."""
    copies = {}
    for true_object in np.unique(truth.obs_object[truth.obs_object >= 0]):
        found = snapshot.labels[(truth.obs_object == true_object) & (snapshot.labels >= 0)]
        copies[int(true_object)] = np.flatnonzero(np.bincount(found) >= at_least).tolist()
    return copies
