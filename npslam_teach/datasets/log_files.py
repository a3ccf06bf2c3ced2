"""Robot logs in and out: our own .npz and .csv files, and the authors' two kinds of .mat files by their variables."""

import warnings
from pathlib import Path

import numpy as np

from npslam_teach.datasets.csv_files import read_csv_log, write_csv_log
from npslam_teach.datasets.log_doubts import doubts_about
from npslam_teach.datasets.log_fields import FIELDS, fields_of, run_from
from npslam_teach.datasets.mat_files import read_mat
from npslam_teach.datasets.mu2016 import (
    SIMULATION_VARIABLES,
    STATA_VARIABLES,
    simulation_from,
    stata_office_from,
)
from npslam_teach.datasets.npz_files import read_npz
from npslam_teach.system.files import atomic_write, prefix_errors, shorten
from npslam_teach.types import GroundTruth, RobotLog

__all__ = ["load_log", "save_log"]


def load_log(path) -> tuple[RobotLog, GroundTruth | None]:
    """Read what a robot recorded, and what really happened as far as the file knows.

    A ``.npz`` log holds the fields of `RobotLog` under their names, ``class_names`` and the covariances of single steps
    (``odometry_cov``) and observations (``observation_cov``) and what each observation says of all classes
    (``class_probabilities``) and which way its object faces (``obs_theta``, ``observation_theta_std`` and
    ``class_symmetry``) if it likes, and of the truth whatever is known: ``true_poses`` (T, 3), or (T, 2) without
    headings, NaN where unknown; ``true_object`` (M,), -1 for clutter, -2 for unknown; ``object_xy`` (K, 2),
    ``object_class`` (K,) and ``object_theta`` (K,). Other entries are ignored. A ``.csv`` log holds the same in rows,
    see ``csv_files``; it is one file or a folder of them. A ``.mat`` file is one of the authors' two (see
    `load_mu2016_simulation` and `load_stata_office`); its variables tell which.

    Args:
        path: a .npz, .csv or .mat file, or a folder of .csv files.

    Raises:
        FileNotFoundError: no such file.
        ValueError: anything else; names the file and the field, what was expected and what came.
    """
    suffix = Path(path).suffix.lower()
    if suffix == ".mat":
        return _load_mat(path)
    if suffix == ".csv" or (Path(path).is_dir() and suffix != ".npz"):
        fields = read_csv_log(path)
    elif suffix == ".npz":
        fields = read_npz(path, FIELDS)
    else:
        wanted = "a file name that ends in .npz, .csv or .mat, or a folder of .csv files"
        raise ValueError(f"{path}: expected {wanted}, got {shorten(suffix)}")
    with prefix_errors(path):
        log, truth = run_from(fields)
    for doubt in doubts_about(log):
        warnings.warn(f"{path}: {doubt}", stacklevel=2)
    return log, truth


def _load_mat(path) -> tuple[RobotLog, GroundTruth | None]:
    variables = read_mat(path, SIMULATION_VARIABLES + STATA_VARIABLES)
    with prefix_errors(path):
        if not variables:
            wanted = f"{', '.join(SIMULATION_VARIABLES)} (simulation) or {STATA_VARIABLES[0]} (office)"
            raise ValueError(f"expected the variables {wanted}, got none of them")
        if STATA_VARIABLES[0] in variables:
            return stata_office_from(variables), None
        return simulation_from(variables)


def save_log(path, log: RobotLog, truth: GroundTruth | None = None) -> None:
    """Write a log, and the truth if there is one, to a file that `load_log` reads back exactly.

    Args:
        path: the file to make or replace; its name must end in .npz or .csv. Untouched when something goes wrong.
        log: what the robot recorded.
        truth: what really happened, for the same poses and observations.

    Raises:
        FileNotFoundError: the folder does not exist.
        ValueError: the file cannot be written, or the truth does not belong to the log.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in (".npz", ".csv"):
        raise ValueError(f"{path}: expected a file name that ends in .npz or .csv, got {shorten(suffix)}")
    fields = fields_of(log, truth)
    with prefix_errors(path):
        run_from(fields)
    if suffix == ".csv":
        write_csv_log(path, fields)
        return
    with atomic_write(path, "wb") as stream:
        np.savez(stream, **fields)
