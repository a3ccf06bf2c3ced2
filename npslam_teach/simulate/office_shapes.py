"""The shapes and colours of the office's objects, as the camera renders them."""

from npslam_teach.simulate.office import DESK_SIZE

DESK_TOP = 0.72  # m

# The bodies of each class as (round, half length x, half length y, z from, z to, y), in m and the object's frame; z is
# measured from the surface that the object stands on, and the half length of a round body is its radius.
SHAPES = {
    "chair": (
        (False, 0.23, 0.23, 0.40, 0.48, 0.0),
        (False, 0.22, 0.03, 0.48, 0.95, -0.20),
        (True, 0.05, 0.05, 0.0, 0.40, 0.0),
    ),
    "screen": ((False, 0.27, 0.03, 0.10, 0.45, 0.0), (True, 0.05, 0.05, 0.0, 0.10, 0.0)),
    "cup": ((True, 0.05, 0.05, 0.0, 0.12, 0.0),),
    "book": ((False, 0.11, 0.15, 0.0, 0.10, 0.0),),
    "keyboard": ((False, 0.22, 0.08, 0.0, 0.03, 0.0),),
    "phone": ((False, 0.09, 0.11, 0.0, 0.08, 0.0),),
    "plant": (
        (True, 0.17, 0.17, 0.0, 0.35, 0.0),
        (True, 0.28, 0.28, 0.45, 1.20, 0.0),
        (True, 0.04, 0.04, 0.3, 0.5, 0.0),
    ),
    "bin": ((True, 0.16, 0.16, 0.0, 0.40, 0.0),),
}
DESK_SHAPE = (
    (False, DESK_SIZE[0] / 2, DESK_SIZE[1] / 2, DESK_TOP - 0.04, DESK_TOP, 0.0),
    (False, DESK_SIZE[0] / 2, 0.02, 0.10, DESK_TOP - 0.04, 0.3),
)
COLORS = {  # red, green, blue, as in a real office; not the colours of the maps
    "chair": (0.25, 0.35, 0.60),
    "screen": (0.12, 0.13, 0.16),
    "cup": (0.80, 0.25, 0.20),
    "book": (0.90, 0.65, 0.15),
    "keyboard": (0.32, 0.32, 0.36),
    "phone": (0.45, 0.20, 0.45),
    "plant": (0.20, 0.50, 0.25),
    "bin": (0.55, 0.45, 0.35),
}
DESK_COLOR, FLOOR_COLOR, WALL_COLOR = (0.78, 0.66, 0.50), (0.55, 0.55, 0.53), (0.90, 0.89, 0.85)
