"""Ctrl-C at any moment: exit code 130, one line, no temporary file, and every file that exists is whole."""

import contextlib
import hashlib
import http.server
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import xml.etree.ElementTree

import numpy as np
import pytest
from layouts import small_run
from PIL import Image

from npslam_teach import datasets, methods
from npslam_teach.cli import parser
from npslam_teach.system import interruption

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name == "nt", reason="Windows has no way to send Ctrl-C to one process alone"),
]

# The command line as a process, from the moment when it handles Ctrl-C itself. Only the search for an environment is
# left out: it could begin to install one.
COMMAND = """
import os, sys
from npslam_teach.system import interpreter, interruption
from npslam_teach.__main__ import run
interpreter.enter_environment = lambda arguments: None
interruption.end_at_once()
{before}
os.write(1, b"ready\\n")
sys.exit(run())
"""
# The same as often as somebody asks, in children of a process that has run it once and so imported all that it needs:
# every moment is one of the command's own work, and takes no second start of Python.
CHILDREN = """
import os, sys
from npslam_teach.system import interpreter, interruption
from npslam_teach.__main__ import run
interpreter.enter_environment = lambda arguments: None
{before}
told = os.dup(1)
os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
os.write(told, b"%d\\n" % run())
for _ in sys.stdin:
    child = os.fork()
    if not child:
        interruption.end_at_once()
        os.write(told, b"%d\\n" % os.getpid())
        sys.exit(run())
    _, status = os.waitpid(child, 0)
    os.write(told, b"%d\\n" % os.waitstatus_to_exitcode(status))
"""
OLD = '{"old": true}'


@contextlib.contextmanager
def started(code, arguments=(), folder=None):
    """A Python process that has reported that it is ready."""
    command = [sys.executable, "-c", code, *map(str, arguments)]
    pipes = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(command, cwd=folder, **pipes) as process:
        try:
            assert process.stdout.readline() == b"ready\n"
            yield process
        finally:
            process.kill()


def interrupted(arguments, wait, folder, before="", signal_number=signal.SIGINT):
    """Exit code and standard error of a command that gets a signal after ``wait`` (seconds, or a function)."""
    with started(COMMAND.format(before=before), arguments, folder) as process:
        wait(process) if callable(wait) else time.sleep(wait)
        process.send_signal(signal_number)
        _, err = process.communicate(timeout=120)
    return process.returncode, err.decode()


class Children:
    """Runs of a command, each in a child of one process; used with ``with``."""

    def __init__(self, arguments, folder, before=""):
        self.errors = tempfile.TemporaryFile()
        command = [sys.executable, "-c", CHILDREN.format(before=before), *map(str, arguments)]
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": self.errors}
        self.parent = subprocess.Popen(command, cwd=folder, **pipes)
        assert self.told() == 0

    def __enter__(self):
        return self

    def __exit__(self, *error):
        self.parent.kill()
        self.parent.communicate()
        self.errors.close()

    def told(self):
        return int(self.parent.stdout.readline())

    def run(self, seconds=None):
        """Exit code and standard error of a child; one that has so many seconds gets Ctrl-C after them."""
        begin = self.errors.seek(0, os.SEEK_END)
        self.parent.stdin.write(b"\n")
        self.parent.stdin.flush()
        child = self.told()
        if seconds is not None:
            time.sleep(seconds)
            with contextlib.suppress(ProcessLookupError):  # it has ended already
                os.kill(child, signal.SIGINT)
        code = self.told()
        self.errors.seek(begin)
        return code, self.errors.read().decode()

    def moments(self, count):
        """As the function of this name, for a child."""
        begin = time.perf_counter()
        code, err = self.run()
        assert code == 0, err
        return spread(time.perf_counter() - begin, count)


def assert_answered(code, err):
    """Exit code 130 and one line, or 0 and no output; a progress bar and remarks may come before it."""
    lines = [line.rsplit("\r", 1)[-1] for line in err.split("\n")]
    lines = [line for line in lines if line.strip() and not line.startswith("Downloading data from")]
    remarks = (": warning: chi2 per degree of freedom", "replaces the file that is there", "are replaced")
    lines = [line for line in lines if not any(remark in line for remark in remarks)]
    if code == 0:
        assert not lines, err
    else:
        assert code == interruption.EXIT_CODE, err
        assert len(lines) == 1 and lines[0].endswith(": interrupted"), err


def assert_whole(path):
    """The file can be read completely."""
    if path.suffix == ".json":
        assert json.loads(path.read_text(encoding="utf-8"))
    elif path.suffix == ".g2o":
        assert datasets.load_g2o(path).poses.size
        assert path.read_bytes().endswith(b"\n")
    elif path.suffix == ".png":
        with Image.open(path) as picture:
            picture.load()
    elif path.suffix == ".svg":
        xml.etree.ElementTree.parse(path)
    else:
        pytest.fail(f"{path.name}: nobody asked for this file")


def moments(arguments, folder, count, before=""):
    """Seconds after the start, spread evenly over the time that the command takes."""
    begin = time.perf_counter()
    with started(COMMAND.format(before=before), arguments, folder) as process:
        _, err = process.communicate(timeout=120)
    assert process.returncode == 0, err
    return spread(time.perf_counter() - begin, count)


def spread(whole, count):
    return [whole * (k + 0.5) / count for k in range(count)]


@pytest.fixture(scope="module")
def inputs(tmp_path_factory):
    """A folder with a log and a graph."""
    folder = tmp_path_factory.mktemp("inputs")
    log, truth = small_run(np.random.default_rng(0), num_poses=40, num_observations=80)
    *_, last = methods.np_graph(log)
    datasets.save_log(folder / "run.npz", log, truth)
    datasets.save_g2o(folder / "graph.g2o", last.graph)
    return folder


@pytest.mark.parametrize(
    ("arguments", "name", "count"),
    [
        (["solve", "run.npz", "--out"], "result.json", 12),
        (["optimize", "graph.g2o", "--out"], "solved.g2o", 12),
    ],
)
def test_ctrl_c_while_a_result_is_made(inputs, tmp_path, arguments, name, count):
    arguments = [inputs / entry if (inputs / entry).exists() else entry for entry in arguments] + [tmp_path / name]
    with Children(arguments, inputs) as children:
        check_result(tmp_path / name, children.moments(count), children.run)


def test_ctrl_c_from_the_start_of_a_process_to_its_result(inputs, tmp_path):
    """Most of it are imports."""
    arguments = ["solve", inputs / "run.npz", "--method", "open-loop", "--out", tmp_path / "result.g2o"]
    waits = moments(arguments, inputs, 6)
    check_result(tmp_path / "result.g2o", waits, lambda wait: interrupted(arguments, wait, inputs))


def check_result(path, waits, run):
    """Ctrl-C after each of the times leaves the old file or the new one, alone in its folder."""
    codes = []
    for wait in waits:
        path.write_text(OLD)
        code, err = run(wait)
        assert_answered(code, err)
        assert list(path.parent.iterdir()) == [path]
        if code == 0 or path.read_text() != OLD:
            assert_whole(path)
        codes.append(code)
    assert interruption.EXIT_CODE in codes


# Two figures are as good as all: which files are there between one and the next is seen below.
TWO_FIGURES = """
from npslam_teach.course.fifteen_objects import figures
figures.TEXTS = dict(list(figures.TEXTS.items())[:2])
"""


def test_ctrl_c_while_the_paper_is_reproduced(inputs, tmp_path):
    arguments = ["reproduce", "--data", inputs / "run.npz", "--methods", "open-loop", "--figures", tmp_path / "figures"]
    codes = []
    with Children(arguments, tmp_path, TWO_FIGURES) as children:
        for wait in children.moments(4):
            code, err = children.run(wait)
            assert_answered(code, err)
            for path in tmp_path.rglob("*"):
                assert path.is_dir() or assert_whole(path) is None
            codes.append(code)
    assert interruption.EXIT_CODE in codes


# A command that waits before it gives the file after so many others its name.
WAITING = """
import time
replace, complete = os.replace, []
def wait(*names):
    if len(complete) == {files}:
        os.write(1, b"waiting\\n")
        time.sleep(120)
    complete.append(names)
    replace(*names)
os.replace = wait
"""


@pytest.mark.parametrize("files_before", [0, 1, 4])
def test_ctrl_c_while_figures_are_drawn(tmp_path, files_before):
    """The signal comes when a temporary file has been written after so many complete ones."""
    folder = tmp_path / "figures"

    def waiting(process):
        assert b"waiting\n" in iter(process.stdout.readline, b"")
        assert [path.name for path in folder.iterdir() if path.name.startswith(".tmp-")]

    code, err = interrupted(["figures", "--out", folder], waiting, tmp_path, WAITING.format(files=files_before))
    assert_answered(code, err)
    assert code == interruption.EXIT_CODE
    assert len(list(folder.iterdir())) == files_before
    for path in folder.iterdir():
        assert_whole(path)


# ---- fetch ----

CONTENTS = os.urandom(100_000)


class Slowly(http.server.BaseHTTPRequestHandler):
    """Sends the file in forty pieces with pauses between them."""

    def do_GET(self):
        self.send_response(200)
        self.send_header("Content-Length", str(len(CONTENTS)))
        self.end_headers()
        with contextlib.suppress(OSError):  # the interrupted client closes the connection
            for start in range(0, len(CONTENTS), 2_500):
                self.wfile.write(CONTENTS[start : start + 2_500])
                time.sleep(0.005)

    def log_message(self, *_):
        """Nothing."""


@pytest.fixture
def server():
    """The address of a server with one file."""
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Slowly)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    thread.join()
    server.server_close()


def test_ctrl_c_while_a_file_is_fetched(tmp_path, server, monkeypatch):
    pytest.importorskip("pooch")
    for name in ("http_proxy", "HTTP_PROXY", "all_proxy", "ALL_PROXY", "NPSLAM_TEACH_DATA"):
        monkeypatch.delenv(name, raising=False)
    cache, digest = tmp_path / "cache", hashlib.sha256(CONTENTS).hexdigest()
    before = (
        "import pooch\n"
        "from npslam_teach.datasets import download\n"
        f"download._URL = {server!r}\n"
        f"download._SIMULATION = download._Original('simulation.mat', 'mu2016_simulation.mat', {digest!r})\n"
        f"pooch.os_cache = lambda project: {str(cache)!r}\n"
    )
    codes = []
    file = cache / "mu2016_simulation.mat"
    with Children(["fetch", "simulation"], tmp_path, before) as children:
        file.unlink()
        for wait in children.moments(12):
            file.unlink(missing_ok=True)
            code, err = children.run(wait)
            assert_answered(code, err)
            found = {path.name: path.read_bytes() for path in cache.iterdir()}
            assert found in ({}, {file.name: CONTENTS})
            assert code != 0 or found
            codes.append(code)
    assert interruption.EXIT_CODE in codes


# ---- atomic_write itself ----

# Writes in a child for every line that it is sent: all that a start of Python would add is imports.
WRITER = """
import os, sys
from npslam_teach.system import files, interruption
for _ in sys.stdin:
    child = os.fork()
    if not child:
        interruption.end_at_once()
        os.write(1, b"%d\\n" % os.getpid())
        for k in range(100_000):
            with files.atomic_write(f"{k % 3}.txt") as stream:
                for line in range(50):
                    stream.write(f"line {line}\\n" * 200)
                    stream.flush()
    os.waitpid(child, 0)
    os.write(1, b"ended\\n")
"""
WHOLE = "".join(f"line {line}\n" * 200 for line in range(50))


@pytest.mark.parametrize("signal_number", [signal.SIGINT, signal.SIGTERM])
def test_a_file_is_whole_or_not_there(tmp_path, signal_number):
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([sys.executable, "-c", WRITER], cwd=tmp_path, bufsize=0, **pipes) as parent:
        for k in range(25):
            parent.stdin.write(b"\n")
            child = int(parent.stdout.readline())
            time.sleep(0.0023 * k)  # writing a file takes a few milliseconds
            os.kill(child, signal_number)
            assert parent.stdout.readline() == b"ended\n"
            assert_whole_or_not_there(tmp_path, signal_number)
        parent.stdin.close()


def assert_whole_or_not_there(folder, signal_number):
    """What a writer leaves behind that was ended by a signal."""
    unfinished = {path for path in folder.iterdir() if path.name.startswith(".tmp-")}
    assert not unfinished or signal_number == signal.SIGTERM, "only who is killed may leave a temporary file"
    for path in set(folder.iterdir()) - unfinished:
        assert path.read_text() == WHOLE


def test_a_second_ctrl_c_does_not_interrupt_the_tidying_up(tmp_path):
    code = """
import os, signal, sys, time
from npslam_teach.system import interruption
interruption.end_at_once()
with interruption.critical_section():
    try:
        os.write(1, b"ready\\n")
        time.sleep(60)
    except KeyboardInterrupt:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.2)
        os.write(1, b"tidy\\n")
"""
    with started(code) as process:
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (0, b"tidy\n", b"")


@pytest.mark.parametrize("busy", ["pass", "importlib.reload(json.decoder)", "Loud()"])
def test_ctrl_c_where_python_would_print_a_traceback(busy):
    """In a loop, in an import, and in a destructor, where Python would swallow it."""
    code = f"""
import importlib, json, os
from npslam_teach.system import interruption
class Loud:
    def __del__(self):
        sum(range(1000))
interruption.end_at_once()
os.write(1, b"ready\\n")
while True:
    {busy}
"""
    with started(code) as process:
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (interruption.EXIT_CODE, b"npslam_teach: interrupted\n")


def test_ctrl_c_after_the_end_changes_nothing(tmp_path):
    before = 'import atexit, time\natexit.register(lambda: (os.write(1, b"ready\\n"), time.sleep(1)))'
    code = COMMAND.format(before=before).replace('os.write(1, b"ready\\n")\nsys', "sys")
    with started(code, ["figures", "--out", ""], tmp_path) as process:
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert process.returncode == 2
    assert err.count(b"\n") == 1 and b"name of a folder" in err


def test_a_notebook_survives_ctrl_c(tmp_path):
    """Only the process of the command line ends at once; code that calls ``parser.main`` gets Python's exception."""
    log, truth = small_run(np.random.default_rng(0))
    datasets.save_log(tmp_path / "run.npz", log, truth)
    before = signal.getsignal(signal.SIGINT)
    assert parser.main(["solve", str(tmp_path / "run.npz"), "--json"]) == 0
    assert signal.getsignal(signal.SIGINT) is before
