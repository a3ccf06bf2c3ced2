"""Fixtures that several test files share."""

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from kernel_ports import use_own_ports

from npslam_teach.cli import parser

ORIGINALS = (
    "mu2016_simulation.mat",
    "mu2016_stata_office.mat",
    "intel.g2o",
    "manhattan.g2o",
    "victoria_park.g2o",
)


# Kernels and command lines that tests start must find the package, wherever they start.
_ROOT = str(Path(__file__).parent.parent)
os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [_ROOT, os.environ.get("PYTHONPATH")]))
use_own_ports()
os.environ["NPSLAM_TEACH_FRAMES"] = "1"  # as in notebooks/conftest.py
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")  # of kernels and command lines: several run at once
# Hundreds of kernels and command lines import the package, and every worker these files: each would compile them anew
# where bytecode is not kept.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
# On a busy machine even a small run may take the two seconds after which a bar appears among the words under test.
os.environ["TQDM_DISABLE"] = "1"


@pytest.hookimpl(trylast=True)  # when every test has its marks
def pytest_collection_modifyitems(items):
    """Files with something slow begin first: at the end no worker has a long file left while others have none."""
    long = {item.path for item in items if item.get_closest_marker("slow") or item.path.suffix == ".ipynb"}
    items.sort(key=lambda item: item.path not in long)


@pytest.fixture(scope="session")
def cases_folder() -> Path:
    """Small files on which the package once failed; the tests say what is right."""
    return Path(__file__).parent / "cases"


@pytest.fixture(scope="session")
def data_folder() -> Path:
    """The folder with the original data: NPSLAM_TEACH_DATA, or shared/data beside the checkout."""
    beside_the_checkout = Path(__file__).resolve().parents[2] / "shared" / "data"
    folder = Path(os.environ.get("NPSLAM_TEACH_DATA") or beside_the_checkout)
    missing = [name for name in ORIGINALS if not (folder / name).is_file()]
    if missing:
        pytest.skip(f"the original data are not in {folder} (missing {missing[0]}): set NPSLAM_TEACH_DATA")
    return folder


@pytest.fixture(scope="session")
def mu2016_path(data_folder) -> Path:
    """The paper's simulation."""
    return data_folder / "mu2016_simulation.mat"


@pytest.fixture(scope="session")
def stata_path(data_folder) -> Path:
    """The paper's office experiment."""
    return data_folder / "mu2016_stata_office.mat"


@pytest.fixture
def notebook(path):
    """The notebook at ``path``, which each file of tests has a fixture for."""
    import nbformat  # takes a second, and every worker and the process over them would pay it

    return nbformat.read(path, as_version=4)


@pytest.fixture
def refused(capsys):
    """A function that runs a command, sees that it is refused in a single line, and returns the line."""

    def refuse(*arguments) -> str:
        assert parser.main([str(argument) for argument in arguments]) == 2
        out, err = capsys.readouterr()
        assert out == "" and err.count("\n") == 1
        return err

    return refuse


@pytest.fixture(scope="session")
def damaged():
    """A function (bytes, rng) -> bytes: cut short, bytes changed, a piece removed, or a piece repeated."""

    def damage(original: bytes, rng: np.random.Generator) -> bytes:
        damage = bytearray(original)
        start, size = int(rng.integers(1, len(original))), int(rng.integers(1, 20))
        kind = rng.integers(4)
        if kind == 0:
            del damage[start:]
        elif kind == 1:
            for position in rng.integers(len(original), size=rng.integers(1, 4)):
                damage[position] = rng.integers(256)
        elif kind == 2:
            del damage[start : start + size]
        else:
            damage[start:start] = damage[start : start + size]
        return bytes(damage)

    return damage
