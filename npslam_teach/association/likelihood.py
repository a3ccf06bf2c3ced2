"""The rule for one observation: how well it fits each object, and which one it is given to (paper eq. 8).

An observation carried into the world lands at some distance d from every object. Every object gets the weight
``votes for the observed class * exp(-d^2 / (2 s^2))``, a new object gets alpha, and the largest wins, or the deck's
threshold decides.
"""

import math

import numpy as np

from npslam_teach.association.dirichlet_process import require_alpha, reweight

PAPER_ALPHA = 0.9


PAPER_KERNEL_STD = math.sqrt(1 / 8)  # m; the published script writes exp(-4 d^2)


LEAST_THRESHOLD = 1e-9  # below it, objects at any distance count


def require_rule(alpha: float, threshold: float | None, kernel_std: float) -> None:
    """Raise ``ValueError`` that names the first setting of the association rule that makes no sense."""
    require_alpha(alpha)
    require_kernel(threshold, kernel_std)


def require_kernel(threshold: float | None, kernel_std: float) -> None:
    """The same for a rule without a Dirichlet process."""
    if threshold is not None and not 0 <= threshold <= 1:
        raise ValueError(f"threshold: expected a probability in [0, 1], got {threshold}")
    if not 1e-6 <= kernel_std <= 1e6:
        raise ValueError(f"kernel_std: expected a length from 1e-6 to 1e6 m, got {kernel_std}")


def association_weights(
    class_votes: np.ndarray,
    distance: np.ndarray,
    kernel_std: float = PAPER_KERNEL_STD,
    squared_turn: np.ndarray | float = 0.0,
) -> np.ndarray:
    """How well one observation fits each object: ``votes * exp(-d^2 / (2 s^2))``, and the kernel of headings if any.

    Args:
        class_votes: (K,) each object's votes for the observed class, the observation's own vote not counted.
        distance: (K,) m, from the observation, carried into W, to each object.
        kernel_std: s, m.
        squared_turn: (K,) of headings, see ``headings.SeenHeadings``.
    """
    return class_votes * np.exp(-(distance**2) / (2 * kernel_std**2) - squared_turn / 2)


def association_probabilities(
    class_votes: np.ndarray,
    distance: np.ndarray,
    alpha: float = PAPER_ALPHA,
    kernel_std: float = PAPER_KERNEL_STD,
    squared_turn: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Probabilities that one observation is of each object, or of a new one (deck figures 6 and 7; paper eq. 8).

    Args: as in ``association_weights``, and the concentration alpha.

    Returns:
        (K+1,); the last entry is "new".
    """
    return reweight(association_weights(class_votes, distance, kernel_std, squared_turn), alpha)


def decide(probabilities: np.ndarray, threshold: float | None = None) -> int:
    """Choose an object; the number of objects itself, K, means a new one (deck figure 8).

    Args:
        probabilities: (K+1,); the last entry is "new".
        threshold: None: the most probable wins, as the authors published it. A number: the best match is accepted
            when its probability exceeds it, as the deck tells it. Ties open a new object.
    """
    num_objects = len(probabilities) - 1
    if num_objects == 0:
        return 0
    best = int(np.argmax(probabilities[:-1]))
    bar = probabilities[-1] if threshold is None else threshold
    return best if probabilities[best] > bar else num_objects
