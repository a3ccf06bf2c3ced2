"""Checks of what comes in: each names the argument, what was expected and what came, in one sentence."""

import numpy as np

LARGEST = 1e15  # beyond it, squares and information matrices leave the range of floating point


def checked_array(name: str, value, shape: tuple, dtype=float, gaps: bool = False) -> np.ndarray:
    """Return a read-only copy of ``value``, or say in one sentence what is wrong with it.

    ``shape`` lists the expected length of each axis; ``None`` accepts any length. With ``gaps``, NaN stands for an
    unknown number.
    Raises ``ValueError`` that names the argument, what was expected and what came.
    """
    try:
        array = np.array(value)
    except ValueError as error:
        raise ValueError(f"{name}: expected a regular array, got {error}") from None
    kinds = "biuf" if dtype is float else "iu"
    is_empty_list = array.size == 0 and array.dtype == float
    if array.dtype.kind not in kinds and not is_empty_list:
        wanted = "real numbers" if dtype is float else "integers"
        are_whole = array.dtype.kind == "f" and (array == np.floor(array)).all()
        hint = "; all are whole, so .astype(int) will do" if are_whole else ""
        raise ValueError(f"{name}: expected {wanted}, got dtype {array.dtype}{hint}")
    if array.ndim != len(shape) or any(n is not None and n != m for n, m in zip(shape, array.shape, strict=True)):
        wanted = "(" + ", ".join("any" if n is None else str(n) for n in shape) + ")"
        raise ValueError(f"{name}: expected shape {wanted}, got {array.shape}")
    if array.dtype.kind == "u" and array.max(initial=0) > np.iinfo(np.int64).max:
        raise ValueError(f"{name}: expected integers below 2^63, got {array.max()}")
    array = array.astype(np.float64 if dtype is float else np.int64)
    if dtype is float:
        _require_finite(name, array[~np.isnan(array)] if gaps else array)
    array.setflags(write=False)
    return array


def set_checked(instance, name: str, shape: tuple, dtype=float, gaps: bool = False) -> None:
    """Replace a field of a frozen dataclass by its ``checked_array``."""
    object.__setattr__(instance, name, checked_array(name, getattr(instance, name), shape, dtype, gaps))


def set_headings(log) -> None:
    """Check the headings of a ``RobotLog``: ``obs_theta`` and its standard deviation together, or neither.

    Raises:
        ValueError: names the field, what was expected and what came.
    """
    if (log.obs_theta is None) != (log.observation_theta_std is None):
        missing = "obs_theta" if log.obs_theta is None else "observation_theta_std"
        raise ValueError(f"{missing}: expected obs_theta and observation_theta_std together, got only one of them")
    if log.obs_theta is not None:
        set_checked(log, "obs_theta", (log.num_observations,))
        std = checked_array("observation_theta_std", log.observation_theta_std, ()).item()
        require_positive("observation_theta_std", np.array(std))
        object.__setattr__(log, "observation_theta_std", std)
    if log.class_symmetry is not None:
        set_checked(log, "class_symmetry", (log.num_classes,), int)
        require_range("class_symmetry", log.class_symmetry, 0, 1001, "how many headings look alike, 0 = all,")


def _require_finite(name: str, array: np.ndarray) -> None:
    if not np.isfinite(array).all():
        raise ValueError(
            f"{name}: expected finite numbers, got {np.count_nonzero(~np.isfinite(array))} NaN or infinite"
        )
    if np.abs(array).max(initial=0.0) > LARGEST:
        raise ValueError(f"{name}: expected numbers up to {LARGEST:g}, got {np.abs(array).max():g}")


def checked_index(name: str, index, length: int) -> np.ndarray:
    """Indices (N,) into something of a length; ``ValueError`` for one that does not exist, negative ones included."""
    index = checked_array(name, np.ravel(index), (None,), int)
    require_range(name, index, 0, length, "an index")
    return index


def require_range(name: str, index: np.ndarray, low: int, high: int, what: str) -> None:
    """Raise ``ValueError`` unless every entry of ``index`` lies in [low, high)."""
    bad = np.flatnonzero((index < low) | (index >= high))
    if bad.size:
        raise ValueError(f"{name}: expected {what} from {low} to {high - 1}, got {index[bad[0]]} at entry {bad[0]}")


def require_positive(name: str, value: np.ndarray) -> None:
    """Raise ``ValueError`` unless every number is positive."""
    if not (value > 0).all():
        raise ValueError(f"{name}: expected positive numbers, got {value.tolist()}")


def require_definite(name: str, covariance: np.ndarray) -> None:
    """Raise ``ValueError`` unless every matrix (n, d, d) is symmetric and positive definite."""
    symmetric = np.abs(covariance - covariance.swapaxes(1, 2)) <= 1e-9 * np.abs(covariance)
    least = np.linalg.eigvalsh(covariance)[:, 0] if len(covariance) else np.ones(0)
    bad = np.flatnonzero(~symmetric.all(axis=(1, 2)) | (least <= 0))
    if bad.size:
        matrix = covariance[bad[0]].tolist()
        raise ValueError(f"{name}: expected symmetric positive definite matrices, got {matrix} at {bad[0]}")


def require_semidefinite(name: str, information: np.ndarray) -> None:
    """Raise ``ValueError`` unless every matrix is symmetric and positive semidefinite."""
    if information.size == 0 or _are_definite(information):
        return
    scale = np.abs(information).max(axis=(1, 2))
    asymmetry = np.abs(information - information.swapaxes(1, 2)).max(axis=(1, 2))
    bad = np.flatnonzero((asymmetry > 1e-9 * scale) | (np.linalg.eigvalsh(information)[:, 0] < -1e-9 * scale))
    if bad.size:
        raise ValueError(f"{name}: expected symmetric positive semidefinite matrices, entry {bad[0]} is not")


def _are_definite(matrices: np.ndarray) -> bool:
    """Whether all matrices are symmetric and definite, as nearly always: much faster than looking at eigenvalues."""
    if not (matrices == matrices.swapaxes(1, 2)).all():
        return False
    try:
        np.linalg.cholesky(matrices)
    except np.linalg.LinAlgError:
        return False
    return True


def require_distributions(name: str, rows: np.ndarray) -> None:
    """Raise ``ValueError`` unless every row (C,) holds probabilities that sum to one, but for a file's rounding."""
    if (rows < 0).any() or not np.allclose(rows.sum(axis=-1), 1.0, atol=1e-3):
        raise ValueError(f"{name}: expected rows of probabilities that sum to one")
