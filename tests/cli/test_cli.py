"""What all commands have in common, and those that start other programs."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from commands import ROOT, assert_one_sentence, call, run, small_log

from npslam_teach import datasets, simulate
from npslam_teach.cli import checkout, parser


def test_help_is_printed_without_numpy():
    code = "import sys; from npslam_teach.cli import main\ntry: main(['--help'])\nexcept SystemExit: pass\n"
    code += "sys.exit(not {'numpy', 'scipy'}.isdisjoint(sys.modules))"
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, env=environment, timeout=60)
    assert done.returncode == 0, done.stderr


def test_every_command_has_its_function():
    actions = parser.build_parser()._subparsers._group_actions[0].choices
    assert set(actions) == {
        "lab",
        "import",
        "fetch",
        "test",
        "bench",
        "reproduce",
        "solve",
        "sweep",
        "optimize",
        "figures",
        "site",
        "book",
        "badges",
        "assignment",
    }
    assert all(callable(parser._function_of(name)) for name in actions)


def test_a_closed_pipe_is_no_error(log_file):
    """Whoever pipes into `head` is not told off."""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", "from npslam_teach.cli import main; import sys; sys.exit(main())"]
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(
        [*command, "solve", str(log_file), "--json"],
        stdout=writing,
        stderr=subprocess.PIPE,
        env=environment,
        timeout=120,
    )
    os.close(writing)
    assert (done.returncode, done.stderr) == (141, b"")


def test_warnings_are_one_line_each(capsys, log_file, monkeypatch):
    import warnings

    def warned(*arguments):
        warnings.warn("the solver\nstopped", stacklevel=2)
        raise ValueError("enough")

    monkeypatch.setattr("npslam_teach.experiments.run_method", warned)
    with warnings.catch_warnings():
        warnings.simplefilter("default")
        code, out, err = call(capsys, "solve", log_file)
    assert err.splitlines()[0] == "npslam_teach solve: warning: the solver stopped"


def test_fetch_prints_where_the_file_is(capsys, data_folder, monkeypatch):
    monkeypatch.setenv("NPSLAM_TEACH_DATA", str(data_folder))
    code, out, err = call(capsys, "fetch", "simulation")
    assert (code, err) == (0, "")
    assert Path(out.strip()).is_file()
    assert_one_sentence(*call(capsys, "fetch", "everything"), "everything")


def test_lab_refuses_a_port_that_cannot_be(capsys):
    assert_one_sentence(*call(capsys, "lab", "--port", "99999"), "port", "65535")


def test_reproduce_needs_the_truth(capsys, tmp_path):
    log, _ = small_log()
    datasets.save_log(tmp_path / "blind.npz", log)
    assert_one_sentence(*call(capsys, "reproduce", "--data", tmp_path / "blind.npz"), "blind.npz", "true")


def test_no_command_and_a_wrong_command(capsys):
    assert_one_sentence(*call(capsys), "COMMAND")
    assert_one_sentence(*call(capsys, "dance"), "dance")


def test_ctrl_c_ends_with_130_and_writes_nothing(capsys, log_file, tmp_path, monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("npslam_teach.experiments.run_method", interrupted)
    code, out, err = call(capsys, "solve", log_file, "--out", tmp_path / "result.json")
    assert (code, out) == (130, "")
    assert err.strip().endswith("interrupted")
    assert not (tmp_path / "result.json").exists()


def test_solve_as_a_process_of_its_own(tmp_path):
    log, truth = simulate.fifteen_objects()
    datasets.save_log(tmp_path / "run.npz", log, truth)
    done = run("solve", tmp_path / "run.npz", "--json")
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["num_objects"] == 15
    failed = run("solve", tmp_path / "run.npz", "--alpha", "-1")
    assert_one_sentence(failed.returncode, failed.stdout, failed.stderr, "alpha")


def test_lab_listens_on_the_loopback_address_and_keeps_the_token(monkeypatch):
    started = []
    monkeypatch.setattr(checkout, "_run_module", lambda *called: started.append(called) or 0)
    monkeypatch.setenv("JUPYTER_CONFIG_PATH", "the user's own")
    assert parser.main(["lab", "--port", "9999", "--no-browser"]) == 0
    ((arguments, variables),) = started
    ours, *own = variables["JUPYTER_CONFIG_PATH"].split(os.pathsep)
    assert own == ["the user's own"] and (Path(ours) / "labconfig" / "page_config.json").is_file()
    assert "--ContentsManager.hide_globs=solutions" in arguments
    assert arguments[0] == "npslam_teach.system.trust", "which signs the lessons and is JupyterLab"
    assert "--LabApp.default_url=/lab/tree/notebooks/00_start_here.ipynb" in arguments
    assert f"--ServerApp.root_dir={ROOT}" in arguments
    assert "--ServerApp.ip=127.0.0.1" in arguments
    assert not any("token" in argument.lower() or "password" in argument.lower() for argument in arguments)


def test_what_jupyter_imports_is_left_to_its_own_process():
    """It takes a second, and the process that starts Jupyter would pay it once more."""
    code = (
        "import sys\nfrom npslam_teach.cli import checkout, parser\n"
        "checkout._run_python = lambda arguments: print(arguments[1], 'nbformat' in sys.modules)\n"
        "parser.main(['lab', '--no-browser'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    assert done.stdout.split() == ["npslam_teach.system.trust", "False"]


def test_test_hands_its_arguments_to_pytest(monkeypatch):
    started = []
    monkeypatch.setattr(checkout, "_run_module", lambda arguments, variables: started.append(arguments) or 5)
    assert parser.main(["test", "tests/test_se2.py", "-k", "wrap"]) == 5
    assert started[0][0] == "pytest"
    assert started[0][-3:] == ["tests/test_se2.py", "-k", "wrap"]
    assert "--nbval" in started[0] and "tests" not in started[0]
    assert parser.main(["test", "-k", "wrap"]) == 5
    assert started[1][-4:] == ["notebooks", "tests", "-k", "wrap"]


@pytest.mark.slow
def test_a_quick_test_is_of_the_mathematics_the_files_and_the_command_line(monkeypatch):
    started = []
    monkeypatch.setattr(checkout, "_run_module", lambda arguments, variables: started.append(arguments) or 0)
    assert parser.main(["test", "--quick"]) == 0
    alone = os.environ | {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    assert not any("nbval" in word for word in started[0])  # a second of imports, for no notebook
    places = {word for word in started[0] if word.startswith(("tests/", "notebooks"))}
    files = {path.relative_to(ROOT).as_posix() for place in places for path in files_with_tests(ROOT / place)}
    expected = {"pose_graph/test_gauss_newton", "association/test_dirichlet_process", "methods/test_methods"}
    expected |= {"test_se2", "datasets/test_g2o", "cli/test_cli", "experiments/test_runs"}
    assert {f"tests/{name}.py" for name in expected} <= files
    assert not any(folder in name for name in files for folder in ("browser", "course", "notebooks", "benchmarks"))
    # Of two of these, which pytest collects as it is called; of all of them it takes a quarter of a minute.
    words = [word for word in started[0] if word not in places] + ["tests/test_se2.py", SLOW.split("::")[0]]
    command = [sys.executable, "-m", *words, "--collect-only", "-q", "-n", "0"]
    collected = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True, env=alone).stdout
    assert "tests/test_se2.py::" in collected and SLOW.split("::")[0] in collected and SLOW not in collected


SLOW = "tests/experiments/test_paper_simulation.py::test_the_papers_run_over_thirty_seeds"


def files_with_tests(place):
    return [place] if place.is_file() else place.glob("test_*.py")


def test_no_progress_bar_where_nobody_waits(log_file, monkeypatch):
    """The fastest method, as a process that may show its bar: there is nothing to see in the first two seconds."""
    monkeypatch.delenv("TQDM_DISABLE", raising=False)
    done = run("solve", log_file, "--method", "frame-by-frame")
    assert (done.returncode, done.stderr) == (0, "")
