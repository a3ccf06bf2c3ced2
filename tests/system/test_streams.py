"""Streams that the caller has closed, a device that is full, a backend that is missing: no traceback, no wrong file."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from commands import small_log

from npslam_teach import datasets

ROOT = Path(__file__).parents[2]
pytestmark = pytest.mark.skipif(os.name == "nt", reason="a POSIX shell closes the streams")


@pytest.fixture(scope="module")
def log_file(tmp_path_factory):
    path = tmp_path_factory.mktemp("streams") / "run.npz"
    datasets.save_log(path, *small_log())
    return path


def shell(words, folder, **more):
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | more
    command = f"'{sys.executable}' -m npslam_teach {words}"
    return subprocess.run(command, shell=True, cwd=folder, env=environment, capture_output=True, text=True, timeout=120)


@pytest.mark.parametrize("closed", ["<&-", ">&-", "2>&-", "<&- >&- 2>&-"])
def test_closed_streams_change_nothing(tmp_path, log_file, closed):
    done = shell(f"solve {log_file} --out result.json --out objects.csv {closed}", tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert ("method" in done.stdout) == (">&-" not in closed.replace("2>&-", ""))
    assert (tmp_path / "objects.csv").read_text().startswith("object,x,y,class")
    assert (tmp_path / "result.json").read_text().startswith("{")
    done = shell(f"solve nothing.npz {closed}", tmp_path)
    assert done.returncode == 2 and done.stdout == ""


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="Linux has a device that is always full")
def test_a_full_device_is_one_sentence(tmp_path, log_file):
    done = shell(f"solve {log_file} > /dev/full", tmp_path)
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1 and "No space left" in done.stderr


def test_figures_are_the_same_whatever_the_user_has_set(tmp_path, log_file):
    (tmp_path / "matplotlibrc").write_text("text.usetex: True\nfont.size: 30\naxes.grid: True\nlines.linewidth: 9\n")
    settings = {"MPLBACKEND": "there-is-no-such-backend", "MATPLOTLIBRC": str(tmp_path / "matplotlibrc")}
    for folder, more in (("plain", {}), ("theirs", settings)):
        done = shell(f"solve {log_file} --figures {folder}", tmp_path, **more)
        assert (done.returncode, done.stderr) == (0, "")
    for path in (tmp_path / "plain").iterdir():
        assert path.read_bytes() == (tmp_path / "theirs" / path.name).read_bytes(), path.name


def test_lessons_put_the_user_s_settings_aside(tmp_path):
    (tmp_path / "matplotlibrc").write_text("text.usetex: True\nfont.size: 30\n")
    program = "import matplotlib as m; m.rcParams['text.usetex'] or 1 / 0; import npslam_teach.course.drift.pictures\n"
    program += "assert not m.rcParams['text.usetex'] and m.rcParams['font.size'] == 10"
    environment = os.environ | {"PYTHONPATH": str(ROOT), "MATPLOTLIBRC": str(tmp_path / "matplotlibrc")}
    subprocess.run([sys.executable, "-c", program], env=environment, check=True, timeout=60)
