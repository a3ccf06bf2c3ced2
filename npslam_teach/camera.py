"""From a detector's box and a depth image to an observation: where the centre of an object is, ahead and to the left.

The camera's frame has x to the right, y down and z forward, in metres; a pixel (u, v) counts columns and rows from the
centre of the first one. The robot looks where its camera looks, so on the floor a point is ``(z, -x)``: ahead, left.
"""

import math
from dataclasses import dataclass

import numpy as np

NEAR_QUANTILE = 0.4  # of the depths in a box: the surface that `foreground` takes for the object
FOREGROUND_BAND = 0.3  # m, how far on either side of that surface still counts


@dataclass(frozen=True)
class Intrinsics:
    """A pinhole camera: a point (x, y, z) is seen at ``u = fx x / z + cx``, ``v = fy y / z + cy``."""

    width: int  # px
    height: int  # px
    fx: float  # px
    fy: float  # px
    cx: float  # px
    cy: float  # px

    @classmethod
    def from_field_of_view(cls, width: int, height: int, field_of_view: float) -> "Intrinsics":
        """A camera with square pixels that looks through the middle of its picture.

        Args:
            width: px.
            height: px.
            field_of_view: rad, horizontal, full opening angle.
        """
        focal = width / (2 * math.tan(field_of_view / 2))
        return cls(width, height, focal, focal, (width - 1) / 2, (height - 1) / 2)


def back_project(u, v, depth, intrinsics: Intrinsics) -> np.ndarray:
    """The point in space that a pixel with a depth shows.

    Args:
        u: (...) px, column.
        v: (...) px, row.
        depth: (...) m along the optical axis, not along the ray.
        intrinsics: of the camera.

    Returns:
        (..., 3) m: right, down, ahead.
    """
    u, v, depth = np.broadcast_arrays(u, v, np.asarray(depth, dtype=float))
    x, y = (u - intrinsics.cx) / intrinsics.fx, (v - intrinsics.cy) / intrinsics.fy
    return np.stack([x * depth, y * depth, depth], axis=-1)


def on_floor(xyz_camera: np.ndarray) -> np.ndarray:
    """The plan view of points in the camera's frame: (..., 3) right, down, ahead to (..., 2) ahead, left."""
    return np.stack([xyz_camera[..., 2], -xyz_camera[..., 0]], axis=-1)


def points_in_box(depth: np.ndarray, box, intrinsics: Intrinsics) -> np.ndarray:
    """The point cloud inside a box; pixels without a reading are left out.

    Args:
        depth: (H, W) m; 0 is no reading.
        box: x1, y1, x2, y2 px; the columns from x1 up to and without x2, and so with rows.
        intrinsics: of the camera.

    Returns:
        (N, 3) m: right, down, ahead.
    """
    x1, y1, x2, y2 = np.asarray(box, dtype=int)
    v, u = np.mgrid[max(y1, 0) : min(y2, depth.shape[0]), max(x1, 0) : min(x2, depth.shape[1])]
    points = back_project(u, v, depth[v, u], intrinsics)
    return points[points[..., 2] > 0]


def foreground(points: np.ndarray) -> np.ndarray:
    """Which points belong to the object: those near a depth somewhat below the median; (N,) bool.

    There is more of the world behind an object than before it, so the object is looked for on the near side of the
    middle. Wrong where the background fills more than 60 % of the box, or something before the object more than 40 %.
    """
    near = np.quantile(points[:, 2], NEAR_QUANTILE)
    return np.abs(points[:, 2] - near) < FOREGROUND_BAND


def centroid_from_box(depth: np.ndarray, box, intrinsics: Intrinsics, use: str = "foreground") -> np.ndarray:
    """The measured centre of the object in a box: box and depth to point cloud to centre (deck figure 18).

    A box also holds what is behind the object. Its mean over everything lies somewhere between the object and the wall;
    the median forgives the background until it fills half of the box; the mean of the foreground leaves it out. All of
    them see the front of the object only, so the centre comes out too near by up to half its depth.

    Args:
        depth: (H, W) m; 0 is no reading.
        box: x1, y1, x2, y2 px.
        intrinsics: of the camera.
        use: "foreground", "median" or "mean".

    Returns:
        (2,) m: ahead, left. NaN when nothing in the box has a reading.

    Raises:
        ValueError: no such ``use``.
    """
    if use not in ("foreground", "median", "mean"):
        raise ValueError(f"use: expected foreground, median or mean, got {use!r}")
    points = points_in_box(depth, box, intrinsics)
    if len(points) == 0:
        return np.full(2, np.nan)
    if use == "median":
        return np.median(on_floor(points), axis=0)
    return on_floor(points[foreground(points)] if use == "foreground" else points).mean(axis=0)
