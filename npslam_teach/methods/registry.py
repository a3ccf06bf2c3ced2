"""Every method of the package, each in one record: what it is called, how it is drawn, what it can be asked for."""

import inspect
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from npslam_teach.methods.ekf_slam import ekf_slam
from npslam_teach.methods.frame_by_frame import frame_by_frame
from npslam_teach.methods.np_graph import np_graph
from npslam_teach.methods.online import online
from npslam_teach.methods.open_loop import open_loop
from npslam_teach.methods.posterior import posterior
from npslam_teach.methods.robust_slam import robust_slam
from npslam_teach.methods.soft_em import soft_em
from npslam_teach.types import RobotLog, Snapshot


@dataclass(frozen=True)
class Method:
    """A method by its name; calling it runs it."""

    name: str  # on the command line and in tables
    function: Callable[..., Iterator[Snapshot]]
    style: dict  # of its lines in every picture: colour, line and marker in matplotlib's words
    assumes: str  # what a reader of its answer must know, in a clause
    has_objective: bool = False  # whether it lowers ``association.objective``
    sees_classes: bool = False  # whether ``RobotLog.class_probabilities`` have an effect
    sees_headings: bool = False  # whether ``RobotLog.obs_theta`` has
    in_paper: bool = True  # whether the paper compares it

    def __call__(self, log: RobotLog, **settings) -> Iterator[Snapshot]:
        """Run it on a log; see its function for the settings."""
        return self.function(log, **settings)

    def scaled_by(self, scale: dict) -> dict:
        """Of a scale (``settings.paper_settings`` or ``settings_for``) what this method can be asked for.

        A default of None means the log's own noise, which no scale changes.
        """
        return {name: value for name, value in scale.items() if self.settings.get(name) is not None}

    @property
    def settings(self) -> dict:
        """What it can be asked for besides the log, with the defaults, in the order of its signature."""
        parameters = list(inspect.signature(self.function).parameters.values())[1:]
        return {parameter.name: parameter.default for parameter in parameters}


_ALL = (
    Method(
        "np-graph",
        np_graph,
        {"color": "#00659f", "linestyle": "-", "marker": "o"},
        "every observation is of a real object that stands still (clutter becomes objects), and no class is confused",
        has_objective=True,
        sees_headings=True,
    ),
    Method(
        "robust-slam",
        robust_slam,
        {"color": "#d45e00", "linestyle": "-.", "marker": "s"},
        "there is one object of each class; what disagrees with it is left out",
    ),
    Method(
        "open-loop",
        open_loop,
        {"color": "#712553", "linestyle": "--", "marker": "D"},
        "the odometry does not drift, every observation is of a real object, and no class is confused",
    ),
    # Its trajectory is open loop's, so that their curves coincide: a wide line shows on both sides of the dashed one.
    Method(
        "frame-by-frame",
        frame_by_frame,
        {"color": "#38ba8d", "linestyle": "-", "marker": "^", "linewidth": 6.0, "zorder": 1.8},
        "the odometry does not drift, and nothing is seen twice",
    ),
    Method(
        "ekf",
        ekf_slam,
        {"color": "#ddd32e", "linestyle": (0, (6, 1)), "marker": "v"},
        "the log's noise is right, and no class is confused beyond the log's class probabilities; clutter far from "
        "every object becomes one",
        sees_classes=True,
        sees_headings=True,
        in_paper=False,
    ),
    Method(
        "soft-em",
        soft_em,
        {"color": "#c78ab8", "linestyle": (0, (1, 1)), "marker": "X"},
        "the log's noise is right; the number of objects is the filter's, less those that prove to be one; clutter far "
        "from every object becomes one",
        sees_classes=True,
        in_paper=False,
    ),
    Method(
        "online",
        online,
        {"color": "#1800a8", "linestyle": (0, (5, 2, 1, 2)), "marker": "d"},
        "the log's noise is right; an association is final a hundred poses after the object went out of sight, but for "
        "whole objects that prove to be one; wrong mergers in a large building may make it diverge; what is seen once "
        "only is taken for clutter",
        sees_classes=True,
        in_paper=False,
    ),
    Method(
        "posterior",
        posterior,
        {"color": "#000000", "linestyle": (0, (3, 1, 1, 1)), "marker": "P"},
        "the log's noise is right and white (where residuals show outliers, displaced passes are joined), no class is "
        "confused beyond the log's class probabilities, two observations of a frame are two objects, and things stay "
        "in view about as long as tracklets do; what is seen once only is taken for clutter",
        sees_classes=True,
        sees_headings=True,
        in_paper=False,
    ),
)
METHODS = {method.name: method for method in _ALL}
