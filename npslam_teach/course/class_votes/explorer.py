"""Cast votes and watch the Dirichlet distribution on its triangle (lesson 05)."""

from functools import cache

import numpy as np

from npslam_teach import association, plotting
from npslam_teach.course.class_votes import pictures
from npslam_teach.course.explorers import Explorer, slider
from npslam_teach.plotting.style import TEXT_SIZE
from npslam_teach.simulate import TOY_CLASSES

NUM_SAMPLES = 150


def explore_triangle(class_names=TOY_CLASSES, votes=(7, 3, 0), prior: float = 1.0) -> Explorer:
    """Density, mean, mode and samples of ``Dir(votes + prior)`` over three classes (deck figure 10).

    Args:
        class_names: three of them.
        votes: (3,) at the start.
        prior: of every class, before the first vote; below 1 it favours certainty, at 1 it is uniform.
    """
    figure, ax = plotting.new_figure(size=(7.6, 5.8))
    shading = pictures.plot_triangle(ax, np.ones(3), class_names)
    (samples,) = ax.plot([], [], label="sample", zorder=3, **pictures.SAMPLE)
    marks = pictures.plot_summaries(ax, dict.fromkeys(pictures.SUMMARIES))
    style = {"loc": "upper left", "bbox_to_anchor": (-0.02, 1.0), "frameon": False, "fontsize": TEXT_SIZE["legend"]}
    legend = ax.legend(handles=[*pictures.summary_handles(marks), samples], **style)
    legend.set_zorder(0.5)  # below all that moves, so that it is drawn only once

    def update(first: int, second: int, third: int, prior: float) -> str:
        votes = np.array([first, second, third], dtype=float)
        concentration = votes + prior
        summaries = summaries_of(votes, concentration)
        pictures.set_triangle(shading, concentration)
        pictures.set_summaries(marks, summaries)
        samples.set_data(*pictures.on_triangle(samples_of(concentration)).T)
        return _words(class_names, votes, concentration, summaries)

    sliders = {
        name: slider(f"votes: {class_name}", int(cast), 0, 20, 1)
        for name, class_name, cast in zip(("first", "second", "third"), class_names, votes, strict=True)
    }
    frames = {"first": (0, 3, 7, 15), "second": (0, 3, 7)}
    return Explorer(figure, update, frames, **sliders, prior=slider("prior for each class", prior, 0.2, 2.0, 0.1))


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
