"""Figure 23, which the deck does not have: how a real camera errs, beside one that errs as the methods assume."""

from npslam_teach import plotting, simulate
from npslam_teach.course.a_real_robot import pictures
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.experiments.real_robot import imported
from npslam_teach.plotting.style import legend_below


def errors_figure():
    """The map of a recording, its errors pass by pass, and those of a simulation with white noise."""
    figure, (left, middle, right) = plotting.new_figure(1, 3, (15.0, 5.4), width_ratios=(0.8, 1, 1))
    log, truth = imported(0)
    pictures.plot_wheels(left, log, truth, "a recording: path by the wheels")
    pictures.plot_errors(middle, log, truth, title="a recording: errors last for a pass")
    pictures.plot_errors(right, *simulate.fifteen_objects(), title="white noise, as every method assumes")
    middle.sharey(right)
    handles = left.get_legend().legend_handles
    left.get_legend().remove()
    return legend_below(figure, handles, columns=len(handles))


FIGURES = (
    FigureFile(
        "fig23_errors_that_last",
        "Left, the map of a recording: the path by the wheels leaves the true one by a metre. Middle, by how much each "
        "landmark seems too far, pass by pass: the errors of a pass lie around a mean of their own, up to a quarter of "
        "a metre off. Right, the same for white noise: the errors of every pass lie around zero.",
        errors_figure,
    ),
)
