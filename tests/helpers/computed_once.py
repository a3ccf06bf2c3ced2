"""Results that the page's kernel and the test's own process would compute alike: one computes them, the other reads.

That they are right is compared elsewhere, by nbval with what is committed; the browser tests look at what becomes of
them.
"""

import functools
import importlib
import pickle
from collections.abc import Callable
from pathlib import Path

# (module, function) of what takes an explorer seconds. Each is called once in a notebook, so its name says which it is.
LONG = (
    ("npslam_teach.course.what_breaks.explorer", "results_of"),
    ("npslam_teach.course.a_real_robot.explorer", "results_of_recording_0"),
    ("npslam_teach.course.soft_association.explorer", "results_of"),
    ("npslam_teach.course.orientation.explorer", "results_of"),
    ("npslam_teach.methods", "online"),
)


def compute_once(folder: Path | str, replace: Callable = setattr) -> None:
    """Let these functions keep what they return, and return what another process has kept.

    Args:
        folder: where it is kept.
        replace: ``setattr``, or the ``setattr`` of a ``pytest.MonkeyPatch``.
    """
    for module, name in LONG:
        function = getattr(importlib.import_module(module), name)
        replace(importlib.import_module(module), name, _kept(function, Path(folder) / f"{module}.{name}"))


def _kept(function: Callable, path: Path) -> Callable:
    @functools.wraps(function)
    def kept(*arguments, **named):
        asked = pickle.dumps([arguments, named])
        if path.exists():
            others, result = pickle.loads(path.read_bytes())
            assert others == asked, f"{path.name} was asked for something else"
            return result
        result = function(*arguments, **named)
        result = result if isinstance(result, dict) else list(result)  # a method yields its snapshots
        path.write_bytes(pickle.dumps([asked, result]))
        return result

    return kept
