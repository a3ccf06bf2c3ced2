"""What ``solve --help`` says of the methods: what each assumes, and what each option means for it."""

import textwrap

WIDTH = 78
NOISE = {"odometry-std": "what the solver assumes of a step", "observation-std": "and of an observation"}
KERNEL = {"kernel-std": "how far two observations of one object lie apart"}
OWN_NOISE = {"odometry-std": "of a step, in place of the log's own", "observation-std": "and of an observation"}
MEANINGS = {  # by method, what its options mean; a test compares them with what the methods take
    "np-graph": {
        "alpha": "weight of a new object beside the votes of those that are known",
        "threshold": "the best match is accepted above this probability; without it the most probable one wins",
        "kernel-std": "how far an observation may lie from its object",
        **NOISE,
        "area": "over which objects are uniform; it only shifts the objective",
        "order": "in which observations are visited",
        "iterations": "associate and solve in turn so often at most",
        "exclusive": "two observations of a frame are two objects",
        "restarts": "run with so many orders, keep the lowest objective",
    },
    "robust-slam": {
        "threshold": "an observation is used if its likeness to the first one of its class is above this",
        **KERNEL,
        **NOISE,
    },
    "open-loop": {
        "threshold": "an observation joins an earlier one of its class if their likeness is above this",
        **KERNEL,
        "odometry-std": "with which chi2 is measured; the path is the odometry",
        "observation-std": "the same",
    },
    "frame-by-frame": {
        "odometry-std": "with which chi2 is measured; the path is the odometry",
        "observation-std": "the same",
    },
    "ekf": {
        "gate": "the share of right matches that is let through",
        **OWN_NOISE,
        "filter-only": "the raw filter, not smoothed at the end",
    },
    "soft-em": {
        "iterations": "rounds of expectation and maximization at most",
        "gate": "the share of right matches that are considered at all",
        **OWN_NOISE,
    },
    "online": {
        "alpha": "how many objects are expected where none was seen, per object where some were",
        "area": "over which objects are uniform; by default the box around all that was seen so far",
        "window": "poses out of sight after which an association is final",
        **OWN_NOISE,
    },
    "posterior": {
        "alpha": "concentration of the Dirichlet process: the prior on the number of objects",
        "area": "over which objects are uniform; by default the box around all that was seen",
        **OWN_NOISE,
        "starts": "so many searches at most; fewer when the best partition has been found twice",
        "samples": "draw so many partitions around the best one",
    },
}


def names_text() -> str:
    """The names of all methods."""
    from npslam_teach.methods import METHODS

    return f"Methods: {', '.join(METHODS)}."


def methods_text() -> str:
    """All methods, one paragraph each, and their options."""
    from npslam_teach.methods import METHODS

    parts = ["Methods, what each assumes, and what the options mean for it; others are refused:"]
    for name, method in METHODS.items():
        lines = [_wrapped(f"{name}: {method.assumes}", "  ")]
        lines += [_wrapped(f"--{option}: {meaning}", "    ") for option, meaning in MEANINGS[name].items()]
        parts.append("\n".join(lines))
    return "\n\n".join(parts)


def _wrapped(text: str, indent: str) -> str:
    return textwrap.fill(text, WIDTH, initial_indent=indent, subsequent_indent=indent + "    ", break_on_hyphens=False)
