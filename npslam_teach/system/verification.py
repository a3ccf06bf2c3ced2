"""Test a finished set-up: ``python -m npslam_teach.system.verification environment.txt`` imports what was installed.

It needs nothing but the standard library, because the packages may be missing or broken.
"""

import importlib
import re
import sys
from importlib.metadata import packages_distributions
from pathlib import Path


def main(requirements: str) -> int:
    """Import every package that the file asks for; 1 and one sentence on standard error for the first that fails."""
    modules = {}
    for module, distributions in packages_distributions().items():
        for name in distributions:
            modules.setdefault(_canonical(name), []).append(module)
    for line in Path(requirements).read_text(encoding="utf-8").splitlines():
        wanted = re.match(r"[\w.-]+", line)
        if wanted is None:
            continue
        found = modules.get(_canonical(wanted.group()))
        if found is None and ";" in line:
            continue  # not asked for on every machine
        problems = ["it is not there"] if found is None else filter(None, map(_problem_with, found))
        for problem in problems:
            print(f"npslam_teach: {wanted.group()}: {problem}.", file=sys.stderr)
            return 1
    return 0


def _canonical(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def _problem_with(module: str) -> str | None:
    """Why a module cannot be imported; None where it can."""
    if module.startswith("_") or not module.isidentifier():
        return None  # private to its package
    try:
        importlib.import_module(module)
    except Exception as error:  # a package that is broken may raise anything
        return " ".join(f"{type(error).__name__}: {error}".split())
    return None


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
