"""The explorer of lesson 11 for a posterior that is known exactly, under alpha and temperature."""

import math

import numpy as np

from npslam_teach import plotting
from npslam_teach.association import all_partitions
from npslam_teach.association.partition_posterior import TrackletEvidence, log_posterior
from npslam_teach.course.explorers import Explorer, slider
from npslam_teach.course.the_posterior import pictures
from npslam_teach.plotting.style import ESTIMATE_COLOR, TRUTH_LINE, label_axes

ROWS = 8


class ExactPosterior:
    """Every partition of a few tracklets, and how probable it is for any alpha and temperature."""

    def __init__(self, evidence: TrackletEvidence):
        """List them all.

        Args:
            evidence: of N tracklets of one class, N up to about 9.
        """
        self.partitions = [np.array(labels) for labels in all_partitions([0] * len(evidence.counts))]
        self.num_objects = np.array([labels.max() + 1 for labels in self.partitions])
        log_p = np.array([log_posterior(evidence, labels) for labels in self.partitions])
        # Alpha enters once for every object, and nowhere else.
        self.at_alpha_1 = log_p - self.num_objects * math.log(evidence.alpha)

    def probabilities(self, alpha: float = 1.0, temperature: float = 1.0) -> np.ndarray:
        """Of every partition, (P,): the posterior to the power of one over the temperature, normalised."""
        log_p = (self.at_alpha_1 + self.num_objects * math.log(alpha)) / temperature
        p = np.exp(log_p - log_p.max())
        return p / p.sum()


def explore_posterior(exact: ExactPosterior, true_labels: np.ndarray) -> Explorer:
    """Move alpha and the temperature of a posterior that is known exactly.

    Args:
        exact: of a few tracklets.
        true_labels: (N,) numbered in the order of first observation.
    """
    figure, (left, right) = plotting.new_figure(1, 2, (11.5, 4.6), width_ratios=(1.7, 1))
    most = pictures.PartitionBars(left, ROWS, f"{ROWS} of {len(exact.partitions)} partitions")
    numbers = np.arange(1, exact.num_objects.max() + 1)
    bars = right.bar(numbers, np.zeros(len(numbers)), 0.7, color="0.75", edgecolor=ESTIMATE_COLOR, linewidth=0.8)
    right.axvline(true_labels.max() + 1, **TRUTH_LINE)
    right.set(ylim=(0.0, 1.02), xticks=numbers)
    label_axes(right, "objects (number)", "probability (no unit)", "how many? (dashed: truth)")

    def update(log_alpha: float, temperature: float) -> str:
        p = exact.probabilities(10**log_alpha, temperature)
        order = most.show(exact.partitions, p, true_labels)
        by_number = np.bincount(exact.num_objects, weights=p)[1:]
        for bar, share in zip(bars, by_number, strict=True):
            bar.set_height(share)
        return _words(exact, p, order, by_number, 10**log_alpha, temperature)

    log_alpha = slider("log10 of alpha", 0.0, -3.0, 3.0, 0.1)
    temperature = slider("temperature", 1.0, 0.1, 8.0, 0.1)
    frames = {"log_alpha": (0, 3), "temperature": (0.1, 1, 4)}
    return Explorer(figure, update, frames, log_alpha=log_alpha, temperature=temperature)


def _words(exact: ExactPosterior, p: np.ndarray, order: list, by_number, alpha: float, temperature: float) -> str:
    first, second = (f"{pictures.partition_name(exact.partitions[k])} has {p[k]:.3f}" for k in order[:2])
    needed = int(np.searchsorted(np.cumsum(np.sort(p)[::-1]), 0.95) + 1)
    number = int(np.argmax(by_number)) + 1
    return (
        f"Alpha {alpha:.3g}, temperature {temperature:.1f}: {first}, {second}; {needed} partitions hold 95 %; "
        f"most probably {number} objects, {by_number[number - 1]:.2f}."
    )
