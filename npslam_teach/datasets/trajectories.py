"""The few poses of a recorded path that a log needs."""

import math

import numpy as np

STEP, TURN = 0.1, 0.1  # m, rad: a pose at least every so far


def keyframes(path: np.ndarray, always: np.ndarray | None = None) -> np.ndarray:
    """Indices of poses that lie at least a step or a turn apart, the first and the last among them.

    Args:
        path: (n, 3) poses.
        always: (n,) bool, poses that are kept wherever they lie; None: no others.
    """
    kept, last = [0], path[0].tolist()
    wanted = np.zeros(len(path), dtype=bool) if always is None else always
    for k, (pose, anyhow) in enumerate(zip(path[1:].tolist(), wanted[1:].tolist(), strict=True), 1):
        turn = abs((pose[2] - last[2] + math.pi) % (2 * math.pi) - math.pi)
        if anyhow or math.hypot(pose[0] - last[0], pose[1] - last[1]) >= STEP or turn >= TURN:
            kept.append(k)
            last = pose
    return np.unique([*kept, len(path) - 1])
