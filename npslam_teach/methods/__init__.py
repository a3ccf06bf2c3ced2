"""One file per method, all with the same signature: a ``RobotLog`` in, an iterator of ``Snapshot`` out.

``*_, last = method(log)`` gets the answer; ``list(method(log))`` feeds a slider; one loop over ``METHODS`` compares
them all. Every method begins with the same snapshot 0: dead reckoning, every observation an object of its own.
Begin with ``np_graph``, the paper's; ``registry`` has a record of each, ``settings`` the constants of the paper and of
other sensors; ``ekf`` is the filter of ``ekf_slam``, ``block_filter`` the same faster. ``soft_em`` lets an observation
be of several objects, each with its probability. ``posterior`` goes past the paper: read ``tracklets``, ``annealing``
and ``refinement`` with it, and ``posterior_samples``. ``online`` takes frames one at a time: read ``robot``, ``recent``
and ``sightings`` with it. ``noise_estimate`` asks a log how noisy it is, ``oriented`` has what the methods share about
headings.
"""

from npslam_teach.methods.ekf_slam import ekf_slam
from npslam_teach.methods.frame_by_frame import frame_by_frame
from npslam_teach.methods.noise_estimate import NoiseEstimate, estimate_noise
from npslam_teach.methods.np_graph import np_graph
from npslam_teach.methods.online import online
from npslam_teach.methods.open_loop import open_loop
from npslam_teach.methods.oriented import without_headings
from npslam_teach.methods.posterior import posterior
from npslam_teach.methods.posterior_samples import PosteriorSamples, sample_posterior
from npslam_teach.methods.registry import METHODS, Method
from npslam_teach.methods.robot import Online
from npslam_teach.methods.robust_slam import robust_slam
from npslam_teach.methods.settings import paper_settings, settings_for
from npslam_teach.methods.soft_em import soft_em

__all__ = [
    "METHODS",
    "Method",
    "NoiseEstimate",
    "Online",
    "PosteriorSamples",
    "ekf_slam",
    "estimate_noise",
    "frame_by_frame",
    "np_graph",
    "online",
    "open_loop",
    "paper_settings",
    "posterior",
    "robust_slam",
    "sample_posterior",
    "settings_for",
    "soft_em",
    "without_headings",
]
