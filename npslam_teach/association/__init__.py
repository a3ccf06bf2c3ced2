"""Which object is it? Association of observations with objects, the trajectory and the map held still.

``likelihood`` has the rule of the paper for one observation: begin there. ``sweep`` asks all observations in turn,
plainly and fast, ``exclusive`` frame by frame; ``radius_search`` is the machinery of the fast one.
``headings`` adds which way things face.
``dirichlet_process`` says how probable a new object is, ``class_votes`` what an object is, ``objective`` which number
the alternation lowers, ``partitions`` what can be done with labels alone.
"""

from npslam_teach.association.class_votes import (
    FALSE_POSITIVE,
    class_posterior,
    count_votes,
    false_positives,
    log_density,
    mode,
)
from npslam_teach.association.dirichlet_process import (
    expected_num_objects,
    log_partition_prior,
    require_alpha,
    require_area,
    reweight,
)
from npslam_teach.association.exclusive import exclusive_sweep, one_to_one
from npslam_teach.association.headings import SeenHeadings, heading_kernel
from npslam_teach.association.likelihood import (
    PAPER_ALPHA,
    PAPER_KERNEL_STD,
    association_probabilities,
    association_weights,
    decide,
    require_kernel,
    require_rule,
)
from npslam_teach.association.objective import objective
from npslam_teach.association.partitions import (
    Association,
    all_partitions,
    first_observations,
    in_order_of_sight,
    same_partition,
    without_empty_objects,
)
from npslam_teach.association.sweep import plain_sweep, sweep

__all__ = [
    "Association",
    "FALSE_POSITIVE",
    "PAPER_ALPHA",
    "PAPER_KERNEL_STD",
    "SeenHeadings",
    "association_probabilities",
    "association_weights",
    "class_posterior",
    "count_votes",
    "decide",
    "exclusive_sweep",
    "expected_num_objects",
    "first_observations",
    "heading_kernel",
    "in_order_of_sight",
    "false_positives",
    "all_partitions",
    "log_density",
    "log_partition_prior",
    "mode",
    "objective",
    "one_to_one",
    "plain_sweep",
    "require_alpha",
    "require_area",
    "require_kernel",
    "require_rule",
    "reweight",
    "same_partition",
    "sweep",
    "without_empty_objects",
]
