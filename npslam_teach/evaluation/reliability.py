"""Is what was given a probability true as often as it says? The numbers behind a reliability diagram."""

from typing import NamedTuple

import numpy as np

EDGES = (0.0, 0.05, 0.25, 0.5, 0.75, 1.0)


class Reliability(NamedTuple):
    """Events in groups of similar probability, groups without events left out."""

    said: np.ndarray  # (B,) their mean probability
    happened: np.ndarray  # (B,) the share that is true
    counts: np.ndarray  # (B,)
    margin: np.ndarray  # (B,) two standard errors of happened - said

    @property
    def within(self) -> np.ndarray:
        """(B,) bool, where what happened is as near to what was said as the margin allows."""
        return np.abs(self.said - self.happened) <= self.margin

    @property
    def expected_calibration_error(self) -> float:
        """The mean distance of what was said from what happened, over all events."""
        return float(np.abs(self.said - self.happened) @ self.counts / self.counts.sum())


def reliability(said, happened, world, edges=EDGES) -> Reliability:
    """Compare probabilities with what is true.

    Args:
        said: (E,) the probability that each event was given.
        happened: (E,) bool, whether it is true.
        world: (E,) to which simulated world it belongs: events of one world hang together, and the margin minds it.
        edges: (B+1,) of the groups; the last one is closed.
    """
    said, happened, world = np.asarray(said, dtype=float), np.asarray(happened, dtype=float), np.asarray(world)
    if not said.shape == happened.shape == world.shape or said.ndim != 1 or len(said) == 0:
        shapes = f"{said.shape}, {happened.shape} and {world.shape}"
        raise ValueError(f"said, happened, world: expected three arrays of one length, got shapes {shapes}")
    group = np.clip(np.searchsorted(edges, said, side="right") - 1, 0, len(edges) - 2)
    rows = []
    for k in np.unique(group):
        here = group == k
        of_world = np.unique(world[here], return_inverse=True)[1]
        # The sum of the surprises of a world is one draw; of independent draws the variances add up. Where next to
        # nothing happened there were no surprises to judge by: never less than if all events were independent.
        surprise = np.bincount(of_world, weights=(happened - said)[here])
        variance = max((surprise**2).sum(), (said * (1 - said))[here].sum())
        margin = 2 * np.sqrt(variance) / here.sum()
        rows.append((said[here].mean(), happened[here].mean(), here.sum(), margin))
    means, shares, counts, margins = map(np.array, zip(*rows, strict=True))
    return Reliability(means, shares, counts, margins)
