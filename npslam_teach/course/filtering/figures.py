"""Figure 20, which the deck does not have: two chairs within the gate; either makes the filter equally sure."""

from dataclasses import replace

from npslam_teach import plotting, simulate
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.course.filtering import pictures
from npslam_teach.methods.ekf_slam import filter_steps, run_filter
from npslam_teach.methods.gating import squared_gates
from npslam_teach.plotting.maps import plot_robots
from npslam_teach.plotting.style import ESTIMATE_COLOR, TRUTH_COLOR, Line2D, class_handles, legend_below

# Associations in the toy scene when Obj_4 and Obj_6 are left out, so that only Obj_5 can correct the slip.
RIGHT = (0, 1, 2, -1, 1, -1, 3, 4)
WRONG = (0, 1, 2, -1, 0, -1, 3, 4)
POSE = 4


def two_answers_figure():
    """Left, the gates before Obj_5 is used; right, the belief after it is associated with either chair."""
    log, truth = simulate.toy_objects()
    world = truth.world
    figure, (left, right) = plotting.new_figure(1, 2, (12.0, 5.4), sharex=True, sharey=True)
    before = next(step for step in filter_steps(log, labels=RIGHT) if step.time == POSE)
    only_obj_5 = replace(before, observations=before.observations[:1], squared_distance=before.squared_distance[:1])
    gate = squared_gates(0.99, 0.99)[0] ** 0.5
    picture = pictures.GateMap(left, only_obj_5, log, world.class_names)
    picture.frame(gate)
    picture.decide(gate, gate)
    plotting.plot_objects(right, world.object_xy[:3], world.object_class[:3], world.class_names, truth=True)
    plot_robots(right, truth.poses[[POSE]], truth=True)
    for k, (labels, name) in enumerate(((RIGHT, "taken for chair B"), (WRONG, "taken for chair A"))):
        record = run_filter(log, labels=labels)
        pictures.plot_robot_belief(right, record.poses[POSE], record.pose_cov[POSE], name, k)
    left.set(title="before: both chairs are within the gate", xlim=(-0.2, 3.4), ylim=(-0.6, 2.75))
    right.set(title="after: either answer makes it equally sure", ylabel="")
    beliefs = right.get_legend_handles_labels()[0]
    return legend_below(figure, class_handles((0, 1), world.class_names) + _handles() + beliefs, columns=4)


def _handles() -> list:
    robot = {"marker": "v", "markersize": 11, "linestyle": "none"}
    hollow = {"color": TRUTH_COLOR, "markerfacecolor": "white"}
    looks = {
        "robot, believed": robot | {"color": ESTIMATE_COLOR},
        "sighting": robot | {"color": ESTIMATE_COLOR, "marker": "x", "markeredgewidth": 2.5},
        "robot, true": robot | hollow,
        "true object": robot | hollow | {"marker": "o"},
    }
    return [Line2D([], [], label=label, **look) for label, look in looks.items()]


FIGURES = (
    FigureFile(
        "fig20_filter_two_answers",
        "Two maps of the toy scene. Left, the sighting Obj_5 lies within the overlapping gate ellipses of chair A and "
        "chair B. Right, where the filter believes to be after it took it for one or the other: two small ellipses of "
        "about the same size, more than half a metre apart, only one of them around the true robot.",
        two_answers_figure,
    ),
)
