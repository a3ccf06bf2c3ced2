"""Cast votes and watch the Dirichlet distribution on its triangle (lesson 05)."""

from functools import cache

import numpy as np

from npslam_teach import association
from npslam_teach.course.class_votes import triangle
from npslam_teach.course.explorers import Explorer, slider
from npslam_teach.course.scene import Scene
from npslam_teach.simulate import TOY_CLASSES

NUM_SAMPLES = 150
MOST = 20  # votes for a class
FRAMES = {"first": (0, 1, 3, 5, 7, 8), "second": (0, 1, 3, 4), "third": (0, 1, 2)}  # without a kernel


def explore_triangle(class_names=TOY_CLASSES, votes=(7, 3, 0), prior: float = 1.0) -> Explorer:
    """Density, mean, mode and samples of ``Dir(votes + prior)`` over three classes (deck figure 10).

    Votes are dropped into the triangle, and taken back out of it.

    Args:
        class_names: three of them.
        votes: (3,) at the start.
        prior: of every class, before the first vote; below 1 it favours certainty, at 1 it is uniform.
    """

    def update(first: int, second: int, third: int, prior: float) -> tuple[str, Scene]:
        votes = np.array([first, second, third], dtype=float)
        concentration = votes + prior
        summaries = summaries_of(votes, concentration)
        scene = Scene(triangle.SIZE)
        triangle.draw_density(scene, concentration, samples_of(concentration), class_names, votes)
        triangle.draw_summaries(scene, summaries)
        triangle.draw_votes(scene, votes, class_names, MOST)
        return _words(class_names, votes, concentration, summaries), scene

    sliders = {
        name: slider(f"votes: {class_name}", int(cast), 0, MOST, 1)
        for name, class_name, cast in zip(triangle.CONTROLS, class_names, votes, strict=True)
    }
    return Explorer(None, update, FRAMES, **sliders, prior=slider("prior for each class", prior, 0.2, 2.0, 0.1))


def summaries_of(votes: np.ndarray, concentration: np.ndarray) -> dict:
    """The three answers to "what is it?": (3,) each, or None where there is none."""
    return {
        "maximum likelihood": votes / votes.sum() if votes.any() else None,
        "mean": concentration / concentration.sum(),
        "mode": association.mode(concentration),
    }


def samples_of(concentration: np.ndarray) -> np.ndarray:
    """Draws (NUM_SAMPLES, 3) that move smoothly with the concentration: gamma quantiles of fixed random levels."""
    from scipy.special import gammaincinv

    gammas = gammaincinv(concentration, _levels())
    return gammas / gammas.sum(axis=1, keepdims=True)


@cache
def _levels() -> np.ndarray:
    return np.random.default_rng(10).uniform(0.001, 0.999, (NUM_SAMPLES, 3))


def _words(class_names, votes: np.ndarray, concentration: np.ndarray, summaries: dict) -> str:
    """The votes, and what each summary says; why there is none where there is none."""

    def triple(point) -> str:
        return ", ".join(f"{share:.2f}" for share in point)

    cast = ", ".join(f"{name} {count:g}" for name, count in zip(class_names, votes, strict=True))
    if summaries["mode"] is not None:
        mode = f"mode {triple(summaries['mode'])}"
    elif (concentration.round(9) < 1).any():
        mode = "no mode: the density is infinite where a class with concentration below 1 has probability 0"
    else:
        mode = "no mode: the density is the same everywhere"
    likely = summaries["maximum likelihood"]
    likelihood = f"maximum likelihood {triple(likely)}" if likely is not None else "no maximum likelihood without votes"
    return (
        f"Votes: {cast}; with the prior the concentration is {triple(concentration)}. "
        f"Probabilities of {', '.join(class_names)}: {likelihood}; mean {triple(summaries['mean'])}; {mode}."
    )
