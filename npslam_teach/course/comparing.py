"""Whether an answer is right: the comparisons that the checks share."""

import numpy as np

CLOSE, SINGLE = 1e-6, 2e-4  # relative errors that pass, in double and in single precision


def close(answer: np.ndarray, truth, tolerance: float = CLOSE) -> bool:
    """Whether two arrays have one shape and the same numbers; zero is judged by the largest number beside it."""
    truth = np.asarray(truth, dtype=float)
    scale = np.abs(truth[np.isfinite(truth)]).max(initial=0.0)
    return answer.shape == truth.shape and np.allclose(answer, truth, rtol=tolerance, atol=1e-3 * tolerance * scale)


def exactly(answer: np.ndarray, truth, tolerance: float = 0.0) -> bool:
    """Whether two arrays have one shape and equal numbers: for counts, labels and truth values."""
    return np.array_equal(answer, np.asarray(truth, dtype=float))


def grouped_alike(answer: np.ndarray, truth, tolerance: float = 0.0) -> bool:
    """Whether two labelings (M,) group alike, whatever their groups are called."""
    truth = np.asarray(truth)
    return answer.shape == truth.shape and np.array_equal(answer[:, None] == answer, truth[:, None] == truth)
