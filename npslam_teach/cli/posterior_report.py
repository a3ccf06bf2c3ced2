"""What ``solve --method posterior --samples N`` tells besides the best partition."""

import numpy as np

from npslam_teach.evaluation.convergence import effective_sample_size, r_hat
from npslam_teach.methods import PosteriorSamples

LARGEST_R_HAT = 1.05  # chains that disagree more have not forgotten where they began


def samples_result(samples: PosteriorSamples) -> dict:
    """The sampled posterior as plain numbers, and how far its chains can be trusted."""
    chains = {"num_objects": samples.num_objects, "log_posterior": samples.log_posterior}
    return {
        "num_samples": int(samples.log_posterior.size),
        "num_chains": len(samples.log_posterior),
        "num_objects_probability": samples.num_objects_probability,
        "num_left_out": int(np.count_nonzero(samples.tracklet < 0)),
        "tracklets": samples.tracklet.tolist(),
        "together": np.round(samples.together, 6).tolist(),
        "best": samples.best.tolist(),
        "objects": [
            {"xy": xy.tolist(), "cov": cov.tolist()}
            for xy, cov in zip(samples.object_xy, samples.object_cov, strict=True)
        ],
        "r_hat": {name: r_hat(values) for name, values in chains.items()},
        "effective_sample_size": {name: effective_sample_size(values) for name, values in chains.items()},
    }


def samples_lines(result: dict) -> list[str]:
    """The same for people: the numbers of objects, the most probable first, and a warning where chains disagree."""
    by_share = sorted(result["num_objects_probability"].items(), key=lambda entry: -entry[1])
    shown = ", ".join(f"{count} ({share:.3f})" for count, share in by_share[:5])
    worst, least = max(result["r_hat"].values()), min(result["effective_sample_size"].values())
    chains = f"{result['num_samples']} in {result['num_chains']} chains, R-hat {worst:.3f}, effective {least:.0f}"
    lines = [f"number of objects     {shown}", f"samples               {chains}"]
    if result["num_left_out"]:
        lines.append(f"not sampled           {result['num_left_out']} observations that fit no tracklet, or not theirs")
    if worst > LARGEST_R_HAT:
        lines.append(f"not converged         R-hat is above {LARGEST_R_HAT}: take more samples before you trust them")
    return lines
