"""What rows of a CSV log may say besides: covariances, probabilities of classes, headings and their symmetry."""

import numpy as np

from npslam_teach.datasets.csv_tables import Row

COVARIANCES = {  # by kind of row: the upper triangle, row by row
    "odometry": ("cov_xx", "cov_xy", "cov_xt", "cov_yy", "cov_yt", "cov_tt"),
    "observation": ("cov_xx", "cov_xy", "cov_yy"),
}
BELIEFS = "class_probabilities"
SYMMETRY = "symmetry"


def headings_of(rows: dict) -> dict:
    """Which way objects face, as far as any row says so."""
    found, seen, (std,) = {}, rows["observation"], rows["observation_std"]
    if std.text.get("theta") or any(row.text.get("theta") for row in seen):
        found["observation_theta_std"] = np.array(std.numbers("theta")[0])
        found["obs_theta"] = np.reshape([row.numbers("theta") for row in seen], -1)
    if any(row.text.get(SYMMETRY) for row in rows["class"]):
        found["class_symmetry"] = np.array([row.index(SYMMETRY, 1001) for row in rows["class"]])
    if any(row.text.get("theta") for row in rows["true_object"]):
        found["object_theta"] = np.reshape([row.known("theta") for row in rows["true_object"]], -1)
    return found


def covariances_of(rows: list[Row], kind: str) -> np.ndarray | None:
    """The covariance of every row (n, d, d); None where no row has one."""
    columns = COVARIANCES[kind]
    if not any(row.text.get(column) for row in rows for column in columns):
        return None
    size = 3 if kind == "odometry" else 2
    cov, upper = np.empty((len(rows), size, size)), np.triu_indices(size)
    cov[:, *upper] = [row.numbers(*columns) for row in rows]
    cov.swapaxes(1, 2)[:, *upper] = cov[:, *upper]
    return cov


def written_details(fields: dict, kind: str) -> list[dict]:
    """For every row of a kind, what stands in the columns of its covariance and its classes, if it has them."""
    cov = fields.get(f"{kind}_cov")
    rows = [{} for _ in fields["odometry" if kind == "odometry" else "obs_xy"]]
    if cov is not None:
        upper = cov[:, *np.triu_indices(cov.shape[1])].tolist()
        rows = [dict(zip(COVARIANCES[kind], map(repr, row), strict=True)) for row in upper]
    if kind == "observation" and BELIEFS in fields:
        beliefs = fields[BELIEFS].tolist()
        rows = [row | {BELIEFS: " ".join(map(repr, own))} for row, own in zip(rows, beliefs, strict=True)]
    return rows
