"""Where is everything, when it is known which observation is of which object?

``gauss_newton`` is the loop of the lecture: begin there. ``levenberg_marquardt`` is the robust one, ``multi_start``
runs it from several starts for ``optimize``. ``residuals`` has the mathematics of the factors, ``factor_kinds`` their
list, ``unknowns`` says which number of a step is which, ``linearization`` makes the normal equations,
``known_association`` the graph of a log and its labels, ``object_headings`` which way its objects face.
``covariance`` says how certain the result is,
``observability`` whether there is one, ``certificate`` whether another could be better. Where to start:
``initialization`` from headings, ``spanning_tree`` from odometry, ``relaxation`` from everything at once.
``incremental`` says how a graph grows, ``submap_tree`` how it grows in bounded time, on ``stretches`` and
``submaps``. ``block_sparsity``, ``factorization``, ``augmented_system`` (for weights that differ much), ``fill_in`` and
``complex_form`` are the machinery.
"""

from npslam_teach.pose_graph.certificate import Certificate, certify
from npslam_teach.pose_graph.covariance import joint_covariance, marginal_covariance, mean_leverages, squared_radius
from npslam_teach.pose_graph.fill_in import factor_pattern, in_three_orders
from npslam_teach.pose_graph.gauss_newton import Iteration, gauss_newton
from npslam_teach.pose_graph.incremental import IncrementalSolver
from npslam_teach.pose_graph.initialization import chordal_headings, chordal_start
from npslam_teach.pose_graph.known_association import (
    fit,
    mean_landmarks,
    observation_factors,
    odometry_factors,
    with_associations,
)
from npslam_teach.pose_graph.levenberg_marquardt import levenberg_marquardt
from npslam_teach.pose_graph.linearization import chi2, linearize
from npslam_teach.pose_graph.multi_start import Optimum, certified_minimum, given_start, minimize, optimize
from npslam_teach.pose_graph.object_headings import (
    heading_factors,
    mean_headings,
    positions_only,
    symmetries,
    with_headings,
)
from npslam_teach.pose_graph.relaxation import relaxed_start
from npslam_teach.pose_graph.residuals import (
    between_jacobians,
    between_residual,
    heading_jacobians,
    heading_residual,
    observation_jacobians,
    observation_residual,
)
from npslam_teach.pose_graph.spanning_tree import odometry_start
from npslam_teach.pose_graph.submap_tree import SubmapTree
from npslam_teach.pose_graph.unknowns import retract

__all__ = [
    "Certificate",
    "IncrementalSolver",
    "Iteration",
    "Optimum",
    "between_jacobians",
    "between_residual",
    "SubmapTree",
    "certified_minimum",
    "certify",
    "chi2",
    "chordal_headings",
    "chordal_start",
    "factor_pattern",
    "fit",
    "gauss_newton",
    "heading_factors",
    "heading_jacobians",
    "heading_residual",
    "in_three_orders",
    "joint_covariance",
    "levenberg_marquardt",
    "linearize",
    "marginal_covariance",
    "mean_headings",
    "mean_landmarks",
    "mean_leverages",
    "minimize",
    "observation_factors",
    "observation_jacobians",
    "observation_residual",
    "odometry_factors",
    "given_start",
    "odometry_start",
    "optimize",
    "positions_only",
    "relaxed_start",
    "retract",
    "squared_radius",
    "symmetries",
    "with_associations",
    "with_headings",
]
