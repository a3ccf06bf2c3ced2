"""Where is everything, when it is known which observation is of which object?

``gauss_newton`` is the loop of the lecture: begin there. ``levenberg_marquardt`` is the robust one, ``multi_start``
runs it from several starts for ``optimize``. ``residuals`` has the mathematics of the factors, ``factor_kinds`` their
list, ``unknowns`` says which number of a step is which, ``linearization`` makes the normal equations,
``known_association`` the graph of a log and its labels. ``covariance`` says how certain the result is,
``observability`` whether there is one, ``initialization`` where to start, ``incremental`` how a graph grows.
``block_sparsity``, ``factorization`` and ``fill_in`` are the machinery.
"""

from npslam_teach.pose_graph.covariance import joint_covariance, marginal_covariance, squared_radius
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
from npslam_teach.pose_graph.multi_start import minimize, optimize
from npslam_teach.pose_graph.residuals import (
    between_jacobians,
    between_residual,
    observation_jacobians,
    observation_residual,
)
from npslam_teach.pose_graph.unknowns import retract

__all__ = [
    "IncrementalSolver",
    "Iteration",
    "between_jacobians",
    "between_residual",
    "chi2",
    "chordal_headings",
    "chordal_start",
    "factor_pattern",
    "fit",
    "gauss_newton",
    "in_three_orders",
    "joint_covariance",
    "levenberg_marquardt",
    "linearize",
    "marginal_covariance",
    "mean_landmarks",
    "minimize",
    "observation_factors",
    "observation_jacobians",
    "observation_residual",
    "odometry_factors",
    "optimize",
    "retract",
    "squared_radius",
    "with_associations",
]
