"""Figure 27, which the deck does not have: time and error of a robot under way, beside a batch."""

from npslam_teach.course.figure_file import FigureFile
from npslam_teach.course.online.pictures import errors_figure

RUNS = (("told", 9, 0), ("online", 9, 0))


def online_figure():
    """Errors over the drive of two robots."""
    return errors_figure(list(RUNS))


FIGURES = (
    FigureFile(
        "fig27_online",
        "Mean pose error over the drive through nine rooms, left of a robot that is told who is who, right of one that "
        "finds it on the way: that of the robot then and there lies close to that of a batch solution.",
        online_figure,
    ),
)
