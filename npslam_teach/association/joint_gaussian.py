"""One Gaussian over the places of all objects, whose many small changes are carried out together.

Every move of a tracklet changes the covariance by a matrix of rank two. To write it costs as much as to read the whole
covariance, far more than to look at the few columns that a move needs. So changes wait as ``cov = base + U W^T``, and
are added up once there are many: one product of matrices instead of many of vectors (blocked updates; Golub and Van
Loan, "Matrix Computations", 2013, section 1.3).
"""

import math

import numpy as np

MOST_WAITING = 96  # columns of U; fewer where the covariance itself is small


class JointGaussian:
    """Mean (2S,) and covariance (2S, 2S) of S places. Some may be of no object any more; nobody looks at them."""

    def __init__(self, mean: np.ndarray, cov: np.ndarray):
        self.mean = mean
        self._base, self._shared = cov, True
        count = len(mean) // 2
        self.own = cov.reshape(count, 2, count, 2)[np.arange(count), :, np.arange(count)]  # (S, 2, 2) of each place
        self._begin_anew()

    @property
    def cov(self) -> np.ndarray:
        """The covariance, every change carried out; to be read only."""
        if self._waiting:
            self._base = self._base + self._left[:, : self._waiting] @ self._right[:, : self._waiting].T
            self._begin_anew()
            self._shared = False
        return self._base

    def copy(self) -> "JointGaussian":
        """As it is now, whatever becomes of this one. Both share their arrays until one of them has to write."""
        twin = object.__new__(JointGaussian)
        self._shared = True
        twin.__dict__.update(self.__dict__)
        return twin

    def column(self, place: int) -> np.ndarray:
        """The covariance of all places with one, (2S, 2)."""
        here, k = slice(2 * place, 2 * place + 2), self._waiting
        column = self._base[:, here]
        return column + self._left[:, :k] @ self._right[here, :k].T if k else column

    def times(self, matrix: np.ndarray) -> np.ndarray:
        """``cov @ matrix``, of (2S, d)."""
        k, product = self._waiting, self._base @ matrix
        return product + self._left[:, :k] @ (self._right[:, :k].T @ matrix) if k else product

    def change(self, step: np.ndarray, left: np.ndarray, right: np.ndarray) -> None:
        """Add a step (2S,) to the mean, and ``left @ right.T``, which is symmetric, (2S, 2) each, to the covariance."""
        self._own_arrays()
        self.mean = self.mean + step
        self.own = self.own + left.reshape(-1, 2, 2) @ right.reshape(-1, 2, 2).swapaxes(1, 2)
        k = self._waiting
        self._left[:, k : k + 2], self._right[:, k : k + 2] = left, right
        self._waiting = k + 2
        if self._waiting == self._left.shape[1]:
            _ = self.cov

    def put(self, place: int, mean: np.ndarray, own: np.ndarray, column: np.ndarray) -> None:
        """Put an object to a place that is free: its mean (2,), covariance (2, 2), and that of all with it (2S, 2)."""
        self._own_arrays()
        here = slice(2 * place, 2 * place + 2)
        self._left[here], self._right[here] = 0.0, 0.0
        self._base[:, here], self._base[here] = column, column.T
        self._base[here, here] = self.own[place] = own
        self.mean[here] = mean

    def make_room(self, count: int) -> None:
        """Have so many more places, all free."""
        self._base = with_room(self.cov, 2 * count, 2 * count)
        self.mean, self.own = with_room(self.mean, 2 * count), with_room(self.own, count, 0, 0)
        self._begin_anew()
        self._shared = False

    def _begin_anew(self) -> None:
        """With no change that waits."""
        wait = 2 * min(len(self.mean) // 16 + 1, MOST_WAITING // 2)
        self._left, self._right = np.empty((len(self.mean), wait)), np.empty((len(self.mean), wait))
        self._waiting = 0

    def _own_arrays(self) -> None:
        """Before writing: copy what a twin may look at."""
        if self._shared:
            for name in ("mean", "own", "_base", "_left", "_right"):
                setattr(self, name, getattr(self, name).copy())
            self._shared = False


def with_room(array: np.ndarray, *more: int) -> np.ndarray:
    """The array with so many more zeros at the end of each axis; ``np.pad`` takes longer than all else here."""
    larger = np.zeros([size + room for size, room in zip(array.shape, more, strict=True)])
    larger[tuple(map(slice, array.shape))] = array
    return larger


def log_normal(difference: np.ndarray, cov: np.ndarray) -> np.ndarray:
    """The log density at zero of two-dimensional normals: mean (..., 2), covariance (..., 2, 2)."""
    a, b, d = cov[..., 0, 0], cov[..., 0, 1], cov[..., 1, 1]
    # Where rounding has eaten the difference of two nearly equal covariances, it is small, and positive.
    det = np.maximum(a * d - b * b, 1e-12 * np.abs(a * d) + 1e-300)
    x, y = difference[..., 0], difference[..., 1]
    squared = (d * x * x - 2 * b * x * y + a * y * y) / det
    return -squared / 2 - np.log(det) / 2 - math.log(2 * math.pi)
