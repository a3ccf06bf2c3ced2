"""One function per kind of figure; each takes an ``Axes`` and returns it, or makes a whole ``Figure`` of panels.

This is the door to all pictures: looks come from ``style``, single maps from ``maps``, several maps and the animation
from ``panels``, curves from ``curves``, files and notebooks from ``pictures``.
"""

from npslam_teach.plotting.curves import (
    plot_cumulative_error,
    plot_error_against_objects,
    plot_object_counts,
    plot_objective,
)
from npslam_teach.plotting.export import save, show, show_animation
from npslam_teach.plotting.maps import plot_objects, plot_snapshot, plot_trajectory, plot_truth, plot_view
from npslam_teach.plotting.panels import animate, plot_iterations, plot_methods
from npslam_teach.plotting.result import result_figures
from npslam_teach.plotting.style import class_style, method_style, new_figure
from npslam_teach.plotting.success_maps import plot_share_table, success_figures

__all__ = [
    "animate",
    "class_style",
    "method_style",
    "new_figure",
    "plot_cumulative_error",
    "plot_error_against_objects",
    "plot_iterations",
    "plot_methods",
    "plot_object_counts",
    "plot_objective",
    "plot_objects",
    "plot_snapshot",
    "plot_trajectory",
    "plot_truth",
    "plot_view",
    "plot_share_table",
    "result_figures",
    "save",
    "show",
    "show_animation",
    "success_figures",
]
