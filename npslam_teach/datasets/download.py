"""The original files of Mu et al., IROS 2016, fetched for the user once and checked against a known sha256.

The authors' repository (github.com/BeipengMu/objectSLAM) names no licence, so nothing of it is shipped here.
"""

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

from npslam_teach.system.files import read_bytes, shorten
from npslam_teach.system.interruption import critical_section

_URL = "https://raw.githubusercontent.com/BeipengMu/objectSLAM/master/data/"
DATA_VARIABLE = "NPSLAM_TEACH_DATA"


@dataclass(frozen=True)
class _Original:
    """A file in the authors' repository."""

    name: str  # there
    local_name: str  # here, and in the folder NPSLAM_TEACH_DATA
    sha256: str


_SIMULATION = _Original(
    "simulation.mat",
    "mu2016_simulation.mat",
    "a2e8760a4a68788a802878e20a82450a44b0e1ce926c6ba53ec456c9e95fa162",
)
_STATA_OFFICE = _Original(
    "stata01162016obj.mat",
    "mu2016_stata_office.mat",
    "775fec973c3aefcdfe0656ba21b8c581b780b1ba16afb7377c0ba1d95cfc202e",
)


def fetch_mu2016_simulation() -> Path:
    """The path of the paper's simulation file, downloaded on first use.

    It is taken from the folder that the environment variable ``NPSLAM_TEACH_DATA`` names, if it is there
    (called ``mu2016_simulation.mat`` or, as the authors do, ``figures.mat``), and otherwise from a cache
    in the user's home.

    Raises:
        ValueError: the file that was found or downloaded has another sha256 than the original.
        ConnectionError: it has to be downloaded and cannot be.
    """
    return _fetch(_SIMULATION)


def fetch_stata_office() -> Path:
    """The path of the paper's office experiment, downloaded on first use.

    As `fetch_mu2016_simulation`; in ``NPSLAM_TEACH_DATA`` the file may be called ``mu2016_stata_office.mat``
    or, as the authors do, ``stata01162016obj.mat``.
    """
    return _fetch(_STATA_OFFICE)


def _fetch(original: _Original) -> Path:
    folder = os.environ.get(DATA_VARIABLE)
    for name in (original.local_name, original.name) if folder else ():
        path = Path(folder) / name
        if path.exists():
            found = hashlib.sha256(read_bytes(path)).hexdigest()
            if found != original.sha256:
                raise ValueError(f"{path}: expected the original with sha256 {original.sha256}, got {found}")
            return path
    return _download(original)


def _download(original: _Original) -> Path:
    import pooch

    url = _URL + original.name
    advice = f"put the file into a folder and name the folder in {DATA_VARIABLE}"
    try:
        with critical_section():  # what has been downloaded so far is a file with a name of its own
            path = pooch.retrieve(
                url,
                known_hash="sha256:" + original.sha256,
                fname=original.local_name,
                path=pooch.os_cache("npslam_teach"),
            )
    except OSError as error:  # no network, no such page, no room: requests' errors are OSErrors, too
        reason = shorten(str(error), 120)
        raise ConnectionError(f"{url}: expected to download it, got {reason}; {advice}") from None
    except ValueError:  # what pooch raises when the hash differs
        problem = f"expected the original with sha256 {original.sha256}, got another file"
        raise ValueError(f"{url}: {problem}") from None
    return Path(path)
