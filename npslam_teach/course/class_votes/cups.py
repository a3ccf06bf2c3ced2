"""What is said of a class that nobody has seen: mean, mode and maximum likelihood, by the prior."""

import numpy as np
from matplotlib.figure import Figure

from npslam_teach.course.small_pictures import curves_figure


def unseen_figure(votes: np.ndarray, priors: np.ndarray) -> Figure:
    """The probability of a class without a vote.

    Args:
        votes: (C,) of an object; the last class has none.
        priors: (N,) votes that each class has from the start.
    """
    a = votes + priors[:, None]
    mode = np.where(priors < 1, np.nan, (a[:, -1] - 1) / (a - 1).sum(axis=1))
    curves = {"mean": a[:, -1] / a.sum(axis=1), "mode": mode}
    labels = ("prior (votes for each class)", "probability of cup (no unit)")
    title = "nobody has seen a cup: only the mean never says zero"
    return curves_figure(priors, curves, labels, title, (0, "maximum likelihood"))
