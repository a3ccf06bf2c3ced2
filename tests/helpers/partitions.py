"""All ways to group n observations into objects, as an oracle."""

from collections.abc import Iterator


def partitions(n: int) -> Iterator[list[int]]:
    """Every partition of n things once, as labels in order of first appearance (restricted growth strings)."""

    def grow(labels):
        if len(labels) == n:
            yield list(labels)
            return
        for label in range(max(labels, default=-1) + 2):
            yield from grow([*labels, label])

    yield from grow([])
