"""Where is everything, when it is known which observation is of which object?

``gauss_newton`` is the loop of the lecture: begin there. ``levenberg_marquardt`` is the robust driver behind
``optimize``. ``residuals`` are the kinds of factor, ``linearization`` makes the normal equations of them,
``known_association`` the graph of a log and its labels. ``covariance`` says how certain the result is,
``observability`` whether there is one, ``initialization`` where to start, ``incremental`` how a graph grows.
``block_sparsity``, ``factorization`` and ``fill_in`` are the machinery.
"""

from npslam_teach.pose_graph.covariance import joint_covariance, marginal_covariance
from npslam_teach.pose_graph.fill_in import factor_pattern, in_three_orders
from npslam_teach.pose_graph.incremental import IncrementalSolver
from npslam_teach.pose_graph.initialization import chordal_headings, chordal_start
from npslam_teach.pose_graph.known_association import (
    fit,
    mean_landmarks,
    observation_factors,
    odometry_factors,
    with_associations,
)
from npslam_teach.pose_graph.levenberg_marquardt import Step, descend, gauss_newton, optimize
from npslam_teach.pose_graph.linearization import chi2, linearize
from npslam_teach.pose_graph.residuals import (
    between_jacobians,
    between_residual,
    observation_jacobians,
    observation_residual,
)

__all__ = [
    "IncrementalSolver",
    "Step",
    "between_jacobians",
    "between_residual",
    "chi2",
    "chordal_headings",
    "chordal_start",
    "descend",
    "factor_pattern",
    "fit",
    "gauss_newton",
    "in_three_orders",
    "joint_covariance",
    "linearize",
    "marginal_covariance",
    "mean_landmarks",
    "observation_factors",
    "observation_jacobians",
    "observation_residual",
    "odometry_factors",
    "optimize",
    "with_associations",
]
