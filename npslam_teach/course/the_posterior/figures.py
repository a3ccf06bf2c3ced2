"""Figure 22, which the deck does not have: a search for the best partition, from hot to cold."""

import numpy as np

from npslam_teach import plotting, simulate
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.course.the_posterior.annealing_film import AnnealingFilm
from npslam_teach.methods.annealing import TEMPERATURES, anneal
from npslam_teach.methods.posterior import start_model
from npslam_teach.plotting.style import legend_below

NOISE, SHOWN = 3.0, (0, 2, 12)


def annealing_film(noise: float = NOISE, seed: int = 0) -> AnnealingFilm:
    """One search in the room of the fifteen objects.

    Args:
        noise: of the room.
        seed: of the search.
    """
    log, truth = simulate.fifteen_objects(noise=noise)
    model, graph = start_model(log)
    alone = np.arange(len(model.rivals))
    return AnnealingFilm(list(anneal(model, graph, alone, TEMPERATURES, np.random.default_rng(seed))), model, truth)


def annealing_figure():
    """Three states: hot, cooler, cold."""
    film = annealing_film()
    figure, axes = plotting.new_figure(1, len(SHOWN), (14.0, 5.85), sharex=True, sharey=True)
    for ax, number in zip(axes, SHOWN, strict=True):
        film.draw(ax)(number)
    for ax in axes[1:]:
        ax.set_ylabel("")
    return legend_below(figure, film.handles(), columns=5)


FIGURES = (
    FigureFile(
        "fig22_annealing",
        "Three maps of the room with fifteen objects while the temperature of a search falls. Hot, the tracklets are "
        "thirty objects and the path lies far from the true one; colder, they are twenty; cold, they are fifteen, and "
        "the path lies on the truth.",
        annealing_figure,
    ),
)
