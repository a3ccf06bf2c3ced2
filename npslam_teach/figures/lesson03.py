"""Deck figure 12: the factor graph before and after it is solved, and why solving it is fast."""

from dataclasses import replace

from npslam_teach import plotting, se2, simulate
from npslam_teach.data import PoseGraph
from npslam_teach.evaluate import sensor_fit, true_association_fit
from npslam_teach.figures.files import FigureFile
from npslam_teach.methods.common import mean_landmarks
from npslam_teach.plotting import lesson03
from npslam_teach.plotting.style import class_handles, legend_below
from npslam_teach.pose_graph import chi2


def toy_before_and_after() -> tuple[PoseGraph, PoseGraph]:
    """The toy scene with known associations: along the wheels' path, and at the minimum of chi2."""
    log, truth = simulate.toy_objects()
    poses = se2.dead_reckoning(log.odometry)
    after = sensor_fit(log, truth.obs_object, poses)
    landed = se2.transform_to(poses[log.obs_time], log.obs_xy)
    return replace(after, poses=poses, landmarks=mean_landmarks(truth.obs_object, landed)), after


def factor_graph_figure():
    """Deck figure 12: what the wheels say, and what the solver makes of it."""
    _, truth = simulate.toy_objects()
    world = truth.world
    figure, axes = plotting.new_figure(1, 2, (11.0, 4.3), sharex=True, sharey=True)
    for ax, graph, when in zip(axes, toy_before_and_after(), ("before", "after"), strict=True):
        plotting.plot_trajectory(ax, truth.poses, truth=True, label="true path")
        title = f"{when}: $\\chi^2$ = {chi2(graph):.1f}"
        lesson03.plot_factor_graph(ax, graph, world.object_class, world.class_names, title)
    handles = lesson03.factor_handles() + axes[0].get_legend_handles_labels()[0][:1]
    return legend_below(figure, handles + class_handles(range(3), world.class_names), columns=8)


def sparsity_figure():
    """H of the fifteen-object scene and the fill of its factor, in three orders of the variables."""
    graph = true_association_fit(*simulate.fifteen_objects())
    return lesson03.sparsity_figure(list(lesson03.in_three_orders(graph).items()))


FIGURES = (
    FigureFile(
        "fig12a_factor_graph_solved",
        "Two maps of the toy scene as a factor graph, poses 0 to 5 and four objects joined by lines, one for each "
        "measurement. Before, along the wheels' path, thick lines show sightings that miss their object; after the "
        "solve they are gone and the path lies on the true path.",
        factor_graph_figure,
    ),
    FigureFile(
        "fig12b_sparsity",
        "Three square pictures of where the matrix H of the fifteen-object scene has numbers, and where its factor has "
        "more. With objects first the factor fills the whole triangle; with poses first it fills a border; in the "
        "fill-reducing order hardly anything is added.",
        sparsity_figure,
    ),
)
