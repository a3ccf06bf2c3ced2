"""Arrays that grow with a drive under way."""

import numpy as np


class Rows:
    """An array that grows by rows; its room is doubled when it is full."""

    def __init__(self, shape: tuple = (), rows=(), dtype=float):
        """Of rows of a shape, the first of which may be given."""
        self._room, self._length = np.zeros((16, *shape), dtype=dtype), 0
        for row in rows:
            self.append(row)

    def __len__(self) -> int:
        return self._length

    @property
    def array(self) -> np.ndarray:
        """The rows so far, a view."""
        return self._room[: self._length]

    def append(self, row) -> None:
        """One row more."""
        if self._length == len(self._room):
            self._room = np.concatenate([self._room, np.zeros_like(self._room)])
        self._room[self._length] = row
        self._length += 1
