"""``lab`` on machines with other set-ups: foreign kernels, folders, settings and backends."""

import json
import os
import shutil
import subprocess
import sys
import urllib.error
import urllib.request
from pathlib import Path

import psutil
import pytest
from lab_process import running_lab

from npslam_teach.system import jupyter

ROOT = Path(__file__).parents[2]


def lab_at(course, folder, **environment):
    """JupyterLab on a course, with its runtime files and its log in a folder."""
    return running_lab(course, folder / "lab.log", {"JUPYTER_RUNTIME_DIR": str(folder)} | environment)


def status(address):
    try:
        with urllib.request.urlopen(address, timeout=20) as answer:
            return answer.status
    except urllib.error.HTTPError as error:
        return error.code


def foreign_kernel(folder):
    """A kernel ``python3`` of another Python, which ends at once."""
    (folder / "kernels" / "python3").mkdir(parents=True)
    spec = {"argv": ["/bin/false", "{connection_file}"], "display_name": "Python 3", "language": "python"}
    (folder / "kernels" / "python3" / "kernel.json").write_text(json.dumps(spec))
    return str(folder)


def copy_of_the_course(folder):
    for name in ("npslam_teach", "notebooks"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "environment.txt", folder)
    return folder


@pytest.mark.slow
def test_lab_starts_our_kernel_beside_foreign_ones_in_a_folder_of_an_awkward_name(tmp_path):
    """The kernels and the settings of a user, a home of which nothing can be written, and brackets in the name."""
    course = copy_of_the_course(tmp_path / "a [course] of 100%, été")
    config = tmp_path / "config"
    config.mkdir()
    preferred = tmp_path / "preferred"
    preferred.mkdir()
    (config / "jupyter_server_config.json").write_text(json.dumps({"ServerApp": {"preferred_dir": str(preferred)}}))
    settings = {
        "JUPYTER_CONFIG_DIR": str(config),
        "JUPYTER_DATA_DIR": foreign_kernel(tmp_path / "data"),
        "JUPYTER_PATH": foreign_kernel(tmp_path / "path"),
        "JUPYTER_PREFER_ENV_PATH": "0",
        "MPLBACKEND": "there-is-no-such-backend",
    }
    with lab_at(course, tmp_path, **settings) as (lab, site, token, _):
        assert status(f"{site}/api/contents/notebooks/00_start_here.ipynb?content=0&token={token}") == 200
        start = urllib.request.Request(
            f"{site}/api/kernels?token={token}",
            data=b'{"name": "python3"}',
            headers={"Content-Type": "application/json"},
        )
        with urllib.request.urlopen(start, timeout=60) as answer:
            assert answer.status == 201
        kernels = [each for each in psutil.Process(lab.pid).children() if "ipykernel_launcher" in each.cmdline()]
        assert [Path(each.exe()).resolve() for each in kernels] == [Path(sys.executable).resolve()]
        assert "MPLBACKEND" not in kernels[0].environ()


@pytest.mark.skipif(os.name == "nt", reason="a home that is a device is one of POSIX")
def test_where_the_home_cannot_be_written_jupyter_writes_elsewhere(tmp_path):
    home = {name: None for name in jupyter.WRITTEN}
    environment = {name: value for name, value in os.environ.items() if name not in home}
    program = "import os, sys; from npslam_teach.system.jupyter import writable_folders as w; print(sorted(w()))"
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=environment | {"HOME": "/dev/null", "TMPDIR": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.stdout.strip() == str(sorted(jupyter.WRITTEN))
    assert (
        done.stderr.startswith("npslam_teach: the home folder cannot be written to; ") and done.stderr.count("\n") == 1
    )


@pytest.mark.slow
def test_lab_serves_the_course_to_whoever_has_the_token(tmp_path):
    """Where a home can be a device, nothing can be written to it."""
    nowhere = {name: f"/dev/null/{name}" for name in jupyter.WRITTEN} | {"HOME": "/dev/null", "TMPDIR": str(tmp_path)}
    with lab_at(ROOT, tmp_path, **({} if os.name == "nt" else nowhere)) as (_, site, token, address):
        assert "/lab/tree/notebooks/00_start_here.ipynb?token=" in address
        assert status(address) == 200
        assert status(f"{site}/api/contents/notebooks/00_start_here.ipynb?content=0&token={token}") == 200
        assert status(f"{site}/files/figures/fig16_simulation_iterations.png?token={token}") == 200
        assert status(f"{site}/api/contents/notebooks?content=0") == 403


@pytest.mark.skipif(os.name == "nt", reason="a home that is a device is one of POSIX")
def test_where_the_home_cannot_be_written_matplotlib_does_not_speak_up(tmp_path):
    here = {name: value for name, value in os.environ.items() if name not in ("MPLCONFIGDIR", "XDG_CONFIG_HOME")}
    program = (
        "from npslam_teach.system.jupyter import matplotlib_folder\n"
        "with matplotlib_folder():\n    import matplotlib; print(matplotlib.get_configdir())"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=here | {"HOME": "/dev/null", "TMPDIR": str(tmp_path)},
        capture_output=True,
        text=True,
    )
    assert done.stderr == "" and Path(done.stdout.strip()).parent == tmp_path
    assert list(tmp_path.iterdir()) == []


def test_where_the_home_can_be_written_matplotlib_goes_there(tmp_path, monkeypatch):
    monkeypatch.delenv("MPLCONFIGDIR", raising=False)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "home"))
    with jupyter.matplotlib_folder():
        assert "MPLCONFIGDIR" not in os.environ
    assert list(tmp_path.iterdir()) == []


def test_a_home_that_can_be_written_is_left_as_it_was(tmp_path, monkeypatch, capsys):
    for name in jupyter.WRITTEN:
        monkeypatch.setenv(name, str(tmp_path / "home" / name))
    assert jupyter.writable_folders() == {}
    assert list(tmp_path.iterdir()) == [] and capsys.readouterr().err == ""
