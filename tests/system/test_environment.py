"""The environment of `python3 -m npslam_teach`: found, made, repaired, never used incomplete. Runs offline."""

import ast
import json
import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from npslam_teach.system import environment as env
from npslam_teach.system import interpreter

ROOT = Path(__file__).parents[2]
SYSTEM = ("__init__.py", "streams.py", "environment.py", "interpreter.py", "interruption.py", "locking.py")
STDLIB_ONLY = ["__main__.py", "__init__.py", *(f"system/{name}" for name in SYSTEM)]
VERIFICATION = "npslam_teach.system.verification"
ABSENT = "there-is-no-such-package"


@pytest.fixture
def course(tmp_path):
    """A folder whose environment.txt no interpreter satisfies."""
    (tmp_path / "environment.txt").write_text(f"{ABSENT}>=1\n")
    return env.Environment(tmp_path)


class Pip:
    """Stands in for everything that would run in the new interpreter; records its calls and what it saw."""

    def __init__(self, monkeypatch, course):
        self.calls, self.stamps_seen, self.exit_code = [], [], 0
        self.verifications, self.verification_code = 0, 0
        self.error, self.course = None, course
        monkeypatch.setattr(env, "run_python", self.run)

    def run(self, environment, arguments, lock):
        if arguments[1] == VERIFICATION:
            self.verifications += 1
            return self.verification_code
        self.calls.append(arguments[1])
        self.stamps_seen.append(self.course.stamp.exists())
        if self.error is not None and arguments[1] == "pip":
            raise self.error
        return self.exit_code if arguments[1] == "pip" else 0


@pytest.fixture
def pip(monkeypatch, course):
    return Pip(monkeypatch, course)


def enter(course, capfd, monkeypatch, arguments=("solve",)):
    """Call enter_environment; return its exit code, the command that it started over with, and its messages."""
    started = []
    monkeypatch.setattr(interpreter, "start_over", lambda python, rest, root: started.append((python, rest)))
    try:
        interpreter.enter_environment(list(arguments), course.root)
        code = 0
    except SystemExit as stop:
        code = stop.code
    out, err = capfd.readouterr()
    assert out == ""
    return code, started, err


def assert_one_sentence(err):
    last = err.splitlines()[-1]
    assert last.startswith("npslam_teach: ") and last.endswith(".") and "Traceback" not in err
    assert ". " not in last, "more than one sentence"


def site_packages_of(course):
    return next((course.folder / "lib").glob("python*/site-packages"), course.folder / "Lib" / "site-packages")


# Which interpreter


def test_an_interpreter_that_satisfies_environment_txt_is_used_as_it_is(course, pip, capfd, monkeypatch):
    course.requirements.write_text("# a comment\n\npytest>=7  # why\nabsent>=1; python_version < '3'\n")
    monkeypatch.delenv("PYTHONPATH", raising=False)
    assert enter(course, capfd, monkeypatch) == (0, [], "")
    assert pip.calls == [] and [path.name for path in course.root.iterdir()] == ["environment.txt"]
    # Its kernels start in other folders and must find the package all the same.
    assert os.environ["PYTHONPATH"] == str(course.root)


def test_it_starts_over_without_the_packages_of_others(course, pip, capfd, monkeypatch):
    course.requirements.write_text("pytest\n")
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(["/opt/ros/lib", str(course.root)]))
    assert enter(course, capfd, monkeypatch) == (0, [(Path(sys.executable), ["solve"])], "")
    assert pip.calls == []


def test_packages_that_only_pythonpath_has_are_used(course, pip, capfd, monkeypatch, tmp_path):
    """As on a cluster whose modules provide NumPy."""
    metadata = tmp_path / "modules" / "cluster_numpy-2.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: cluster-numpy\nVersion: 2.0\n")
    course.requirements.write_text("pytest\ncluster-numpy>=2\n")
    monkeypatch.syspath_prepend(str(tmp_path / "modules"))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "modules"))
    assert enter(course, capfd, monkeypatch) == (0, [], "")
    assert pip.calls == []
    assert os.environ["PYTHONPATH"] == os.pathsep.join([str(course.root), str(tmp_path / "modules")])


def test_a_set_up_is_verified_before_it_is_stamped(course, pip, capfd, monkeypatch):
    pip.verification_code = 1
    code, started, err = enter(course, capfd, monkeypatch)
    assert (code, started, pip.verifications) == (2, [], 1) and not course.stamp.exists()
    assert_one_sentence(err)
    pip.verification_code = 0
    assert enter(course, capfd, monkeypatch)[:2] == (0, [(course.python, ["solve"])])
    assert course.stamp.exists()


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ("pytest>=7\n# why\n\nnbval\nabsent; python_version < '3'\n", None),
        ("pytest\nthere-is-none\n", "there-is-none: "),
        ("broken\n", "broken: RuntimeError: half installed."),
    ],
)
def test_what_was_installed_is_imported(tmp_path, lines, words):
    metadata = tmp_path / "site" / "broken-1.0.dist-info"
    metadata.mkdir(parents=True)
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: broken\nVersion: 1.0\n")
    (metadata / "top_level.txt").write_text("broken_module\n")
    (tmp_path / "site" / "broken_module.py").write_text("raise RuntimeError('half\\ninstalled')\n")
    (tmp_path / "requirements.txt").write_text(lines)
    path = os.pathsep.join([str(tmp_path / "site"), str(ROOT)])
    done = run([sys.executable, "-m", VERIFICATION, "requirements.txt"], tmp_path, PYTHONPATH=path)
    if words is None:
        assert (done.returncode, done.stderr) == (0, "")
    else:
        assert done.returncode == 1 and done.stderr.startswith("npslam_teach: " + words)
        assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("line", "answer"),
    [
        ("pytest", True),
        ("pytest>=7,<1000", True),
        ("pytest>=1000", False),
        ("pytest>=1000; python_version < '3'", True),
        (ABSENT, False),
        ("-r other.txt", False),
    ],
)
def test_satisfies_reads_names_bounds_and_markers(course, line, answer):
    course.requirements.write_text(f"packaging\n{line}\n")
    assert interpreter.satisfies(course.requirements) is answer


def test_without_packaging_nothing_is_satisfied(course, monkeypatch):
    course.requirements.write_text("pytest\n")
    monkeypatch.setitem(sys.modules, "packaging.requirements", None)
    assert interpreter.satisfies(course.requirements) is False


def test_a_half_removed_package_does_not_satisfy(course, monkeypatch):
    course.requirements.write_text("pytest\n")
    monkeypatch.setattr("importlib.metadata.version", lambda name: None)
    assert interpreter.satisfies(course.requirements) is False


def test_installed_from_a_wheel_the_current_interpreter_is_used(course, pip, capfd, monkeypatch):
    course.requirements.unlink()
    assert enter(course, capfd, monkeypatch) == (0, [], "")
    assert pip.calls == []


def test_in_the_environment_itself_the_stamp_decides(course, pip, capfd, monkeypatch):
    course.requirements.write_text("pytest\n")  # which this interpreter has
    env.set_up(course)
    del pip.calls[:]
    monkeypatch.setattr(sys, "prefix", str(course.folder))
    monkeypatch.delenv("PYTHONPATH", raising=False)
    assert enter(course, capfd, monkeypatch)[1] == [] and pip.calls == []
    monkeypatch.setenv("PYTHONPATH", "/opt/ros/lib")  # then it starts over without
    assert enter(course, capfd, monkeypatch)[1] == [(course.python, ["solve"])] and pip.calls == []
    monkeypatch.delenv("PYTHONPATH")
    course.stamp.unlink()
    assert enter(course, capfd, monkeypatch)[1] == [(course.python, ["solve"])] and "pip" in pip.calls


@pytest.mark.parametrize("version", [(3, 6, 15), (3, 9, 2), (3, 10, 13)])
def test_an_old_python_is_told_what_to_install(version, course, capfd, monkeypatch):
    monkeypatch.setattr(sys, "version_info", version)
    code, started, err = enter(course, capfd, monkeypatch)
    assert (code, started, err.count("\n")) == (2, [], 1)
    assert "Python 3.11 or newer" in err and ".".join(map(str, version)) in err


def test_python_3_11_and_newer_are_accepted():
    for version in [(3, 11, 0), (3, 12, 1), (3, 13, 0), (4, 0, 0)]:
        interpreter.check_python(version)


@pytest.mark.parametrize("name", STDLIB_ONLY)
def test_an_old_python_can_read_far_enough_to_say_so(name):
    source = (ROOT / "npslam_teach" / name).read_text(encoding="utf-8")
    tree = ast.parse(source, feature_version=(3, 6))
    names = [alias.name for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) for alias in node.names]
    assert "annotations" not in names, "from __future__ import annotations needs Python 3.7"
    for node in ast.walk(tree):
        for annotation in (getattr(node, "annotation", None), getattr(node, "returns", None)):
            assert not isinstance(annotation, ast.BinOp | ast.Subscript), "evaluated by Python 3.6: quote it"


# Making, updating, repairing


def test_the_first_call_sets_up_and_the_second_does_nothing(course, pip, capfd, monkeypatch):
    code, started, err = enter(course, capfd, monkeypatch, ["solve", "a b.npz", "--json"])
    assert (code, started) == (0, [(course.python, ["solve", "a b.npz", "--json"])])
    assert err.count("\n") == 1 and "about a minute" in err
    assert pip.calls == ["ensurepip", "pip"] and pip.stamps_seen == [False, False]
    assert enter(course, capfd, monkeypatch) == (0, [(course.python, ["solve"])], "")
    assert pip.calls == ["ensurepip", "pip"]


def test_a_changed_environment_txt_is_installed_into_what_is_there(course, pip, capfd, monkeypatch):
    env.set_up(course)
    extra = site_packages_of(course) / "installed_by_a_student.py"
    extra.touch()
    course.requirements.write_text("another-such>=2\n")
    code, started, err = enter(course, capfd, monkeypatch)
    assert (code, started) == (0, [(course.python, ["solve"])]) and "has changed" in err
    assert pip.calls[2:] == ["pip"] and not any(pip.stamps_seen) and extra.exists()
    assert course.is_stamped()


def break_nothing_but_the_stamp(course):
    course.stamp.unlink()


def garble_the_stamp(course):
    course.stamp.write_bytes(b"\xff\xfe")
    course.python.unlink()


def let_python_dangle(course):
    course.python.unlink()
    course.python.symlink_to(course.root / "python-that-was-uninstalled")


def remove_python(course):
    course.python.unlink()


def let_python_fail(course):
    course.python.unlink()
    course.python.write_text("#!/bin/sh\nexit 127\n")
    course.python.chmod(0o755)


def upgrade_python(course):
    site_packages = site_packages_of(course)
    site_packages.parent.rename(site_packages.parent.with_name("python3.0"))


def leave_half_a_folder(course):
    shutil.rmtree(course.folder)
    course.folder.mkdir()
    course.stamp.write_text(course.digest())


DAMAGES = [
    break_nothing_but_the_stamp,
    garble_the_stamp,
    let_python_dangle,
    remove_python,
    let_python_fail,
    upgrade_python,
    leave_half_a_folder,
]


@pytest.mark.skipif(os.name == "nt", reason="damages what only POSIX has")
@pytest.mark.parametrize("damage", DAMAGES)
def test_a_damaged_environment_is_made_anew(damage, course, pip, capfd, monkeypatch):
    env.set_up(course)
    leftover = course.folder / "leftover"
    damage(course)
    leftover.touch()
    code, started, err = enter(course, capfd, monkeypatch)
    assert (code, started) == (0, [(course.python, ["solve"])]) and "about a minute" in err
    assert pip.calls[2:] == ["ensurepip", "pip"] and not any(pip.stamps_seen)
    assert not leftover.exists() and course.is_stamped() and course.is_intact()


def test_an_environment_that_somebody_else_made_is_left_alone(course, pip, capfd, monkeypatch):
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", course.folder], check=True)
    (course.folder / "precious").touch()
    code, started, err = enter(course, capfd, monkeypatch)
    assert (code, started, pip.calls) == (2, [], [])
    assert_one_sentence(err)
    assert "was not made by this command" in err and (course.folder / "precious").exists()


def test_an_interrupted_set_up_leaves_no_stamp_and_is_repaired(course, pip, capfd, monkeypatch):
    pip.error = KeyboardInterrupt()
    code, started, err = enter(course, capfd, monkeypatch)
    assert (code, started) == (130, []) and not course.stamp.exists()
    assert_one_sentence(err)
    pip.error = None
    assert enter(course, capfd, monkeypatch)[:2] == (0, [(course.python, ["solve"])])
    assert pip.calls == ["ensurepip", "pip"] * 2


def test_an_interrupted_update_leaves_no_stamp(course, pip, capfd, monkeypatch):
    env.set_up(course)
    course.requirements.write_text("another-such>=2\n")
    pip.error = KeyboardInterrupt()
    assert enter(course, capfd, monkeypatch)[0] == 130 and not course.stamp.exists()


def test_an_edit_during_the_installation_is_not_stamped(course, pip, monkeypatch):
    def edit(environment, arguments, lock):
        course.requirements.write_text("edited-meanwhile\n")
        return 0

    monkeypatch.setattr(env, "run_python", edit)
    env.set_up(course)
    assert course.stamp.exists() and not course.is_stamped()


def test_the_stamp_is_written_in_one_step(course, monkeypatch):
    course.folder.mkdir()
    moves = []

    def replace(source, target):
        moves.append((Path(source).read_text(), Path(target).exists(), Path(source).parent))
        os.rename(source, target)

    monkeypatch.setattr(os, "replace", replace)
    env.write_stamp(course, "digest")
    assert moves == [("digest", False, course.folder)] and course.stamp.read_text() == "digest"
    assert [path.name for path in course.folder.iterdir()] == [course.stamp.name]


def test_the_pth_is_relative_and_leads_to_the_course(course, pip):
    env.set_up(course)
    site_packages = site_packages_of(course)
    path = (site_packages / "npslam_teach.pth").read_text().strip()
    assert not os.path.isabs(path) and (site_packages / path).resolve() == course.root.resolve()


# Failures


def test_a_failing_pip_is_one_sentence_and_no_stamp(course, pip, capfd, monkeypatch):
    pip.exit_code = 1
    code, started, err = enter(course, capfd, monkeypatch)
    assert (code, started) == (2, []) and not course.stamp.exists()
    assert_one_sentence(err)
    assert "network" in err and "proxy" in err


@pytest.mark.parametrize("module", ["venv", "ensurepip"])
def test_without_venv_or_ensurepip_the_remedy_is_named(module, course, pip, capfd, monkeypatch):
    monkeypatch.setitem(sys.modules, module, None)
    code, started, err = enter(course, capfd, monkeypatch)
    assert (code, started, pip.calls) == (2, [], [])
    assert_one_sentence(err)
    assert "apt install python3-venv" in err


@pytest.mark.parametrize("written", [".venv.lock", ".venv"])
def test_a_folder_that_cannot_be_written_to(written, course, pip, capfd, monkeypatch):
    # Permissions do not stop root, under whom images are built; a file or a folder in the way stops everyone.
    if written == ".venv":
        (course.root / written).write_text("a file")
    else:
        (course.root / written).mkdir()
    code, started, err = enter(course, capfd, monkeypatch)
    assert (code, started, pip.calls) == (2, [], [])
    assert_one_sentence(err)
    assert str(course.folder) in err and "may write to" in err


def test_a_read_only_folder_with_a_finished_environment_still_works(course, pip, capfd, monkeypatch):
    env.set_up(course)
    monkeypatch.setattr(env, "hold_lock", lambda path: pytest.fail("wrote to the folder"))
    assert enter(course, capfd, monkeypatch)[:2] == (0, [(course.python, ["solve"])])


def test_all_that_pip_prints_goes_to_standard_error(course, capfd):
    course.python = Path(sys.executable)
    with env.hold_lock(course.lock) as lock:
        code = env.run_python(course, ["-c", "import sys; print('progress'); sys.exit(5)"], lock)
    assert code == 5 and capfd.readouterr() == ("progress\n", "")[::-1]


def test_pip_sees_the_environment_alone(course, monkeypatch, capfd):
    monkeypatch.setenv("PYTHONPATH", "/elsewhere")
    course.python = Path(sys.executable)
    with env.hold_lock(course.lock) as lock:
        env.run_python(course, ["-c", "import sys; print(sys.path)"], lock)
    assert "/elsewhere" not in capfd.readouterr().err


# Two at once

HOLD = """
import sys, time
from pathlib import Path
from npslam_teach.system.environment import hold_lock
with hold_lock(Path(sys.argv[1])):
    print("in", flush=True)
    time.sleep(float(sys.argv[2]))
    print("out", flush=True)
"""


def hold(path, seconds):
    command = [sys.executable, "-c", HOLD, str(path), str(seconds)]
    return subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_the_second_of_two_waits_and_says_so(course):
    with hold(course.lock, 0.6) as first:
        assert first.stdout.readline() == "in\n"
        with hold(course.lock, 0) as second:
            assert second.stdout.readline() == "in\n"
            assert first.poll() is not None or first.stdout.readline() == "out\n"
            assert "waiting" in second.stderr.read()
        assert "waiting" not in first.stderr.read()


def test_the_lock_dies_with_its_process(course):
    with hold(course.lock, 60) as first:
        assert first.stdout.readline() == "in\n"
        first.kill()
    with hold(course.lock, 0) as second:
        assert second.communicate(timeout=120)[0] == "in\nout\n"


@pytest.mark.skipif(os.name == "nt", reason="a killed parent's pip keeps the lock on POSIX only")
def test_a_pip_that_outlives_its_parent_keeps_the_lock(course):
    course.python = Path(sys.executable)
    with env.hold_lock(course.lock) as lock:
        code = "import os, sys; os.fstat(int(sys.argv[1]))"
        assert env.run_python(course, ["-c", code, str(lock)], lock) == 0


def test_the_one_that_waited_finds_the_work_done(course, pip):
    env.set_up(course)
    env.set_up(course)
    assert pip.calls == ["ensurepip", "pip"]


# The whole of it


@pytest.fixture
def copy(tmp_path):
    """A course in a folder with an awkward name, whose command line prints where it runs."""
    root = tmp_path / "a course, été"
    for folder in ("system", "cli"):
        (root / "npslam_teach" / folder).mkdir(parents=True)
    for name in [*STDLIB_ONLY, "system/verification.py", "system/jupyter.py"]:
        shutil.copy(ROOT / "npslam_teach" / name, root / "npslam_teach" / name)
    (root / "npslam_teach" / "cli" / "parser.py").write_text(
        "import importlib.util, json, sys\n"
        "assert importlib.util.find_spec('ros_messages') is None\n"
        "def main(arguments):\n"
        "    print(json.dumps([arguments, sys.prefix, __file__]))\n"
        "    return 7\n"
    )
    (root / "environment.txt").write_text("pip\n")  # which every virtual environment has, network or not
    return root


def run(command, folder, **more):
    environ = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"} | {"PIP_NO_INDEX": "1"} | more
    return subprocess.run(command, cwd=folder, env=environ, capture_output=True, text=True, timeout=120)


def call(root, *arguments, **more):
    # -S hides site-packages, as on a bare machine: packaging cannot be imported.
    return run([sys.executable, "-S", "-m", "npslam_teach", *arguments], root, **more)


def test_foreign_packages_are_those_of_other_folders(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), "", "/opt/ros/lib"]))
    assert interpreter.foreign_packages(tmp_path) == ["/opt/ros/lib"]
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "."))
    assert interpreter.foreign_packages(tmp_path) == []
    monkeypatch.delenv("PYTHONPATH")
    assert interpreter.foreign_packages(tmp_path) == []


def tiny_wheel(folder):
    """A package that pip can install without the network."""
    with zipfile.ZipFile(folder / "tiny-1.0-py3-none-any.whl", "w") as wheel:
        wheel.writestr("tiny.py", "")
        wheel.writestr("tiny-1.0.dist-info/METADATA", "Metadata-Version: 2.1\nName: tiny\nVersion: 1.0\n")
        wheel.writestr("tiny-1.0.dist-info/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n")
        wheel.writestr("tiny-1.0.dist-info/RECORD", "tiny.py,,\ntiny-1.0.dist-info/METADATA,,\n")


@pytest.fixture
def elsewhere(tmp_path):
    """What the user has told pip: to install to another place, in all the ways there are; and where packages are."""
    tiny_wheel(tmp_path)
    (tmp_path / "pip.conf").write_text(f"[install]\nprefix = {tmp_path / 'prefix'}\nroot = {tmp_path / 'root'}\n")
    more = {"PIP_CONFIG_FILE": tmp_path / "pip.conf", "PIP_TARGET": tmp_path / "target", "PIP_FIND_LINKS": tmp_path}
    return {name: str(value) for name, value in more.items()}


@pytest.mark.slow
def test_from_a_bare_machine_to_an_exit_code(copy, elsewhere):
    """Another place in the configuration of pip is overruled, or tiny would not be found."""
    (copy / "environment.txt").write_text("pip\ntiny\n")
    around = {path.name for path in copy.parent.iterdir()}
    first = call(copy, "solve", "a b.npz", "--json", **elsewhere)
    assert {path.name for path in copy.parent.iterdir()} == around
    assert first.returncode == 7 and "about a minute" in first.stderr
    assert json.loads(first.stdout) == [
        ["solve", "a b.npz", "--json"],
        str(copy / ".venv"),
        str(copy / "npslam_teach" / "cli" / "parser.py"),
    ]

    # The packages of another program, as in a terminal of ROS, must not be used.
    foreign = copy.with_name("foreign")
    foreign.mkdir()
    (foreign / "ros_messages.py").touch()
    for python in ([sys.executable, "-S"], [env.Environment(copy).python]):
        third = run([*python, "-m", "npslam_teach", "lab"], copy, PYTHONPATH=str(foreign))
        assert (third.returncode, third.stderr) == (7, "")

    moved = copy.rename(copy.with_name("moved"))
    made = env.Environment(moved).stamp.stat().st_mtime_ns
    second = call(moved, "lab")
    assert env.Environment(moved).stamp.stat().st_mtime_ns == made  # nothing was made anew
    assert (second.returncode, second.stderr) == (7, "")
    python = env.Environment(moved).python
    kernel = run([python, "-c", "import npslam_teach as package; print(package.__file__)"], "/")
    assert kernel.stdout.strip() == str(moved / "npslam_teach" / "__init__.py")

    (moved / "environment.txt").write_text(f"{ABSENT}\n")
    offline = call(moved, "lab")
    assert (offline.returncode, offline.stdout) == (2, "")
    assert_one_sentence(offline.stderr)
    assert not env.Environment(moved).stamp.exists()


class Child:
    """A process during which the user presses Ctrl-C, and which handles it in its own way."""

    waits = 0

    def __init__(self, command):
        self.command = command

    def __enter__(self):
        return self

    def __exit__(self, *error):
        assert Child.waits == 2, "left while the child was still running"

    def wait(self):
        Child.waits += 1
        if Child.waits == 1:
            raise KeyboardInterrupt
        return 9


@pytest.mark.skipif(os.name == "nt", reason="pretends not to have exec, as on Windows")
def test_without_exec_the_exit_code_and_ctrl_c_are_the_childs(monkeypatch):
    monkeypatch.setattr(os, "execv", lambda path, command: None)
    monkeypatch.setattr(subprocess, "Popen", Child)
    with pytest.raises(SystemExit) as stop:
        interpreter.start_over(Path("python"), ["lab"], ROOT)
    assert stop.value.code == 9


# The files that say what is needed


def requirements_of(lines):
    wanted = [Requirement(line.split("#")[0]) for line in lines if line.split("#")[0].strip()]
    return {each.name: str(each.specifier) for each in wanted}


def test_environment_txt_and_pyproject_ask_for_the_same_versions():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    needed = requirements_of(project["dependencies"])
    installed = requirements_of((ROOT / "environment.txt").read_text(encoding="utf-8").splitlines())
    assert needed and needed.items() <= installed.items()
    assert project["requires-python"] == ">=" + ".".join(map(str, interpreter.OLDEST_PYTHON))


def test_environment_txt_names_what_the_course_needs():
    installed = requirements_of((ROOT / "environment.txt").read_text(encoding="utf-8").splitlines())
    assert {
        "numpy",
        "scipy",
        "matplotlib",
        "ipywidgets",
        "filterpy",
        "jupyterlab",
        "nbval",
    } <= installed.keys()
    assert all(">=" in bounds for bounds in installed.values()), "a lower bound each"
