"""Figure 21, which the deck does not have: drift grows with the noise, and the kernel does not."""

from npslam_teach import plotting, simulate
from npslam_teach.association import PAPER_KERNEL_STD
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.course.what_breaks import pictures
from npslam_teach.plotting.style import ESTIMATE_COLOR, Line2D, class_handles, legend_below

NOISES = (1, 2, 3)


def drift_figure():
    """One room at three noises, with a mark for every pass over an object along the odometry path."""
    figure, axes = plotting.new_figure(1, 3, (13.0, 5.8), sharex=True, sharey=True)
    for ax, noise in zip(axes, NOISES, strict=True):
        log, truth = simulate.fifteen_objects(noise=noise)
        pictures.plot_passes(ax, log, truth, PAPER_KERNEL_STD)
        ax.set(title=f"noise {noise}", ylabel="y (m)" if noise == 1 else "")
    ring = {"marker": "o", "markersize": 12, "markerfacecolor": "none", "markeredgewidth": 2.2, "linestyle": "none"}
    kernel = Line2D([], [], color=ESTIMATE_COLOR, label="the paper's kernel, 0.35 m wide", **ring)
    joined = Line2D([], [], color="0.4", label="passes over one object")
    names = truth.world.class_names
    return legend_below(figure, class_handles(range(len(names)), names) + [joined, kernel], columns=7)


FIGURES = (
    FigureFile(
        "fig21_drift_outgrows_kernel",
        "Three maps of one room along the wheels' path, at noise 1, 2 and 3. Marks are passes over an object; lines "
        "join those over the same one. The lines grow with the noise, from about a metre to several; the circle of the "
        "paper's kernel in the corner stays as it is.",
        drift_figure,
    ),
)
