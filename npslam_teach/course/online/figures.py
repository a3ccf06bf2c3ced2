"""Figure 27, which the deck does not have: time and error of a robot under way, beside a batch."""

from npslam_teach.course.figure_file import FigureFile
from npslam_teach.course.online.pictures import errors_figure
from npslam_teach.course.online.table import load

RUNS = (("told", 100, 0), ("online", 9, 0))


def online_figure():
    """Errors over the drive of two robots."""
    assert {run[0] for run in RUNS} <= {row["case"] for row in load()}
    return errors_figure(list(RUNS))


FIGURES = (
    FigureFile(
        "fig27_online",
        "Mean pose error over the drive through a hundred rooms, told who is who, and through nine rooms, who is who "
        "found on the way: that of the robot then and there lies close to that of a batch solution.",
        online_figure,
    ),
)
