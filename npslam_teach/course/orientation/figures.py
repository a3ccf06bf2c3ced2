"""Figure 26, which the deck does not have: four pairs of chairs back to back, without headings and with them."""

from npslam_teach.course.figure_file import FigureFile
from npslam_teach.course.orientation.pictures import twins_figure
from npslam_teach.experiments.back_to_back import answer, hall

SEED, ERROR = 0, 10.0  # degrees


def back_to_back_figure():
    """The maps of NP-graph from points, and from points that face somewhere."""
    cases = {"points": answer("np-graph", *hall(SEED, 0.0)), "with headings": answer("np-graph", *hall(SEED, ERROR))}
    return twins_figure(cases, hall(SEED, ERROR)[1])


FIGURES = (
    FigureFile(
        "fig26_back_to_back",
        "Two maps of one hall with four pairs of chairs, back to back, and the path around them. Left, from points: as "
        "many objects as chairs, but several lie between or beside them. Right, with headings: every chair in its "
        "place, a short line shows which way it faces.",
        back_to_back_figure,
    ),
)
