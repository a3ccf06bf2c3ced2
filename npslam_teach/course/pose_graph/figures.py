"""Deck figure 12: the factor graph before and after it is solved, and why solving it is fast."""

from dataclasses import replace

from npslam_teach import plotting, pose_graph, se2, simulate
from npslam_teach.course.figure_file import FigureFile
from npslam_teach.course.pose_graph import pictures
from npslam_teach.evaluation import true_association_fit
from npslam_teach.plotting import factor_graph
from npslam_teach.plotting.style import class_handles, legend_below
from npslam_teach.pose_graph import chi2, fit, mean_landmarks
from npslam_teach.types import PoseGraph


def toy_before_and_after() -> tuple[PoseGraph, PoseGraph]:
    """The toy scene with known associations: along the odometry path, and at the minimum of chi2."""
    log, truth = simulate.toy_objects()
    poses = se2.dead_reckoning(log.odometry)
    after = fit(log, truth.obs_object, poses)
    landed = se2.apply(poses[log.obs_time], log.obs_xy)
    return replace(after, poses=poses, landmarks=mean_landmarks(truth.obs_object, landed)), after


def factor_graph_figure():
    """Deck figure 12: the graph along the odometry path, and at the minimum of chi2."""
    _, truth = simulate.toy_objects()
    world = truth.world
    figure, axes = plotting.new_figure(1, 2, (11.0, 4.3), sharex=True, sharey=True)
    for ax, graph, when in zip(axes, toy_before_and_after(), ("before", "after"), strict=True):
        plotting.plot_trajectory(ax, truth.poses, truth=True, label="true path")
        title = f"{when}: $\\chi^2$ = {chi2(graph):.1f}"
        factor_graph.plot_factor_graph(ax, graph, world.object_class, world.class_names, title)
    handles = factor_graph.factor_handles() + axes[0].get_legend_handles_labels()[0][:1]
    return legend_below(figure, handles + class_handles(range(3), world.class_names), columns=8)


def sparsity_figure():
    """H of the fifteen-object scene and the fill of its factor, in three orders of the variables."""
    graph = true_association_fit(*simulate.fifteen_objects())
    return pictures.sparsity_figure(list(pose_graph.in_three_orders(graph).items()))


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
