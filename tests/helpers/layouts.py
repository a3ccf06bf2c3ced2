"""A small run, and the layouts of the files that hold one: our own .npz and the authors' two .mat files."""

import numpy as np

from npslam_teach import se2, types

LOG_FIELDS = ["odometry", "obs_time", "obs_xy", "obs_class", "num_classes", "odometry_std", "observation_std"]
TRUTH_FIELDS = ["true_poses", "true_object", "object_xy", "object_class"]


def small_run(rng, num_poses=6, num_objects=3, num_observations=8):
    """A log without noise and its truth."""
    poses = np.column_stack([rng.normal(size=(num_poses, 2)) * 5, rng.uniform(-np.pi, np.pi, num_poses)])
    world = types.World(rng.normal(size=(num_objects, 2)), np.arange(num_objects) % 2, ["chair", "écran"])
    obs_time, obs_object = rng.integers([[num_poses], [num_objects]], size=(2, num_observations))
    log = types.RobotLog(
        odometry=se2.between(poses[:-1], poses[1:]),
        obs_time=obs_time,
        obs_xy=se2.apply_inverse(poses[obs_time], world.object_xy[obs_object]),
        obs_class=world.object_class[obs_object],
        num_classes=2,
        odometry_std=[0.1, 0.2, 0.3],
        observation_std=[0.4, 0.5],
    )
    return log, types.GroundTruth(world, poses, obs_object)


def fields_of(log, truth=None):
    """The arrays that a .npz log of this run holds."""
    fields = {name: getattr(log, name) for name in LOG_FIELDS}
    if truth is not None:
        values = (truth.poses, truth.obs_object, truth.world.object_xy, truth.world.object_class)
        fields |= dict(zip(TRUTH_FIELDS, values, strict=True)) | {"class_names": np.array(truth.world.class_names)}
    return fields


def simulation_variables(log, truth):
    """A run in the authors' conventions: rotations by R(-theta), and a first step to the first pose."""
    poses = truth.poses * [1, 1, -1] + [0, 0, 2 * np.pi]  # headings are not wrapped in the file
    steps = np.vstack([[0.7, 0.1, 0.2], log.odometry]) * [1, 1, -1]
    return {
        "node_edge": {"dpos": steps[:, :2].T, "dtheta": steps[:, 2]},
        "lm_edge": {
            "id1": log.obs_time.astype(np.uint16),
            "id2": (truth.obs_object + 1).astype(np.uint8),
            "dpos": log.obs_xy.T,
            "label": log.obs_class + 1.0,
        },
        "truth_objects": np.column_stack([truth.world.object_xy, truth.world.object_class]),
        "truth_traj": poses,
        "FOV": 4,
    }


def camera_pose(pose):
    """(4, 4) pose of a level camera (x right, y down, z forward) for a pose on the floor."""
    x, y, theta = pose
    camera = np.eye(4)
    camera[:3, 0] = [np.cos(theta), 0, np.sin(theta)]  # right of forward
    camera[:3, 2] = [-np.sin(theta), 0, np.cos(theta)]  # forward
    camera[:3, 3] = [-y, 0.3, x]
    return camera


def office_variables(log, truth, ids=(17, 6)):
    """The log as frames of the office experiment, the classes given these ids."""
    objects = [[] for _ in range(log.num_poses)]
    for t, (x, y), c in zip(log.obs_time, log.obs_xy, log.obs_class, strict=True):
        pose = np.eye(4, dtype=np.float32)
        pose = pose + np.array([[0, 0, 0, -y], [0, 0, 0, 0.5], [0, 0, 0, x], [0, 0, 0, 0]])
        objects[t].append({"label": float(ids[c]), "score": 0.5, "T": pose})
    frames = np.empty((1, log.num_poses), [("Seq", "O"), ("T", "O"), ("objects", "O")])
    for t, pose in enumerate(truth.poses):
        found = np.array([(o["label"], o["T"]) for o in objects[t]] + [None], [("label", "O"), ("T", "O")])[:-1]
        frames[0, t] = (t, camera_pose(pose), found if len(found) else np.zeros((0, 0)))
    return {"stata_frames": frames}
