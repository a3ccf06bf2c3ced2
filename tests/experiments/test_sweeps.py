"""Sweeps: the same rows whoever computes them, each once, whatever happens on the way."""

import contextlib
import itertools
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import killing
import pytest

from npslam_teach.experiments import executors, sweep, sweep_files
from npslam_teach.methods import METHODS


def small_grid(seeds=2):
    return sweep.grid(["np-graph", "open-loop"], range(seeds), [1.0, 2.0], alpha=[None, 0.5])


def without_seconds(rows):
    """Rows by point, without what differs from run to run."""
    rows = list(rows)
    found = {sweep.point_of(row): row | {"seconds": None} for row in rows}
    assert len(found) == len(rows), "a row came twice"
    return found


@pytest.fixture(scope="module")
def expected():
    """The rows of ``small_grid``, computed one after the other in this process."""
    return without_seconds(map(sweep.run_point, small_grid()))


def nobody_else(executor):
    return lambda: contextlib.nullcontext(executor)


def test_a_grid_is_every_combination_once():
    points = sweep.grid(["np-graph", "ekf"], range(2), [1.0, 2.0], alpha=[None, 0.1], kernel_std=[0.2, 0.3])
    for method, settings in (("np-graph", 4), ("ekf", 1)):
        assert sum(point.method == method for point in points) == 2 * 2 * settings
    assert len(set(points)) == len(points)
    for point in points:
        assert all(
            getattr(point, name) is None for name in sweep.SETTINGS if name not in METHODS[point.method].settings
        )
    rooms = [room for room, _ in itertools.groupby((point.scene, point.noise, point.seed) for point in points)]
    assert len(rooms) == 4, "the points of a room are not neighbours"


@pytest.mark.parametrize(
    "wrong, named",
    [
        ({"methods": ["np_graph"]}, "methods: .*np-graph.*'np_graph'"),
        ({"methods": ["ekf"], "alpha": [0.1]}, "alpha: .*ekf"),
        ({"methods": ["ekf"], "gate": [0.1]}, "gate: .*alpha"),
        ({"methods": ["ekf"], "scales": ["mine"]}, "scales: .*paper.*'mine'"),
    ],
)
def test_a_wrong_axis_is_named(wrong, named):
    with pytest.raises(ValueError, match=named):
        sweep.grid(**({"seeds": [0]} | wrong))


def test_settings_arrive_at_the_method():
    rows = [sweep.run_point(point) for point in sweep.grid(["np-graph"], [0], [2.0], kernel_std=[0.05, None, 2.0])]
    found = [row["objects"] for row in rows]
    assert found[0] > found[1] > found[2]
    paper, sensor = (
        sweep.run_point(point)["objects"] for point in sweep.grid(["np-graph"], [0], [2.0], scales=["paper", "sensor"])
    )
    assert paper != sensor


@pytest.mark.parametrize("workers", [1, 2])
def test_processes_give_the_same_rows(expected, workers):
    assert without_seconds(sweep.sweep(small_grid(), partial(executors.local_pool, workers))) == expected


def test_threads_give_the_same_rows(expected):
    with ThreadPoolExecutor(2) as pool:
        assert without_seconds(sweep.sweep(small_grid(), nobody_else(pool))) == expected


def test_a_killed_process_costs_no_row(expected, tmp_path, monkeypatch):
    """The first worker that takes a point dies of it; the pool is made anew and the point computed again."""
    monkeypatch.setenv(killing.FILE, str(tmp_path / "one worker has died"))
    monkeypatch.setattr(sweep, "run_point", killing.die_once)
    assert without_seconds(sweep.sweep(small_grid(), partial(executors.local_pool, 2))) == expected
    assert (tmp_path / "one worker has died").exists()


def test_a_point_that_kills_every_worker_ends_the_sweep_with_a_word(monkeypatch):
    monkeypatch.setattr(sweep, "run_point", killing.die)
    with pytest.raises(ValueError, match="workers: .*fifteen_objects.*3 that died"):
        list(sweep.sweep(small_grid(1), partial(executors.local_pool, 1)))


def test_an_error_of_one_run_stands_in_its_row(monkeypatch):
    def fail(*arguments):
        raise ArithmeticError("the matrix\nis singular")

    monkeypatch.setattr(sweep, "run_method", fail)
    row = sweep.run_point(small_grid()[0])
    assert row["error"] == "ArithmeticError: the matrix is singular"
    assert row["objects"] is None and not sweep.is_right(row)


@pytest.fixture(scope="module")
def cluster():
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, host="127.0.0.1"
    ) as cluster:
        yield cluster


@pytest.mark.slow
def test_a_dask_cluster_gives_the_same_rows_though_a_worker_is_killed(expected, cluster):
    address, killed, rows = cluster.scheduler_address, [], []
    with contextlib.closing(sweep.sweep(small_grid(), partial(executors.dask_pool, address))) as coming:
        for row in coming:
            rows.append(row)
            if len(rows) == 3:
                killed.append(next(iter(cluster.workers.values())).pid)
                os.kill(killed[0], signal.SIGKILL)
    assert killed
    assert without_seconds(rows) == expected


def test_nobody_at_the_address_of_a_cluster(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(executors, "_SECONDS_TO_ANSWER", 0.5)
    with (
        pytest.raises(ValueError, match="dask: expected a scheduler at tcp://127.0.0.1:9"),
        executors.dask_pool("tcp://127.0.0.1:9"),
    ):
        pass


@pytest.mark.parametrize("name", ["distributed", "pyarrow"])
def test_what_is_not_installed_is_asked_for_in_one_sentence(monkeypatch, tmp_path, name):
    monkeypatch.setitem(sys.modules, name, None)
    opened = executors.dask_pool("tcp://127.0.0.1:9") if name == "distributed" else None
    opened = opened or sweep_files.collect(tmp_path / "sweep.parquet", small_grid())
    with pytest.raises(ValueError, match=rf"expected the package {name}.*npslam_teach\[cluster\]"), opened:
        pass
    assert not list(tmp_path.glob("*.parquet"))


def test_a_lesson_loads_neither():
    code = (
        "import sys; from npslam_teach import experiments, plotting; from npslam_teach.experiments import sweep_files;"
    )
    code += "print(*(set(sys.modules) & {'dask', 'distributed', 'pyarrow'}))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip() == ""


@pytest.mark.parametrize("suffix", sweep_files.SUFFIXES)
def test_a_sweep_goes_on_where_it_was_interrupted(expected, tmp_path, suffix):
    if suffix == ".parquet":
        pytest.importorskip("pyarrow")
    points, path = small_grid(), tmp_path / f"sweep{suffix}"
    with pytest.raises(KeyboardInterrupt), sweep_files.collect(path, points) as (missing, keep):
        assert missing == points
        for point in missing[:5]:
            keep(expected[point])
        raise KeyboardInterrupt
    with sweep_files.collect(path, points) as (missing, keep):
        assert missing == points[5:]
        for point in reversed(missing):
            keep(expected[point])
    assert without_seconds(sweep_files.read_rows(path)) == expected
    assert [sweep.point_of(row) for row in sweep_files.read_rows(path)] == points
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("suffix", sweep_files.SUFFIXES)
def test_a_sweep_that_was_killed_loses_only_the_line_that_was_cut(expected, tmp_path, suffix):
    if suffix == ".parquet":
        pytest.importorskip("pyarrow")
    points, path = small_grid(), tmp_path / f"sweep{suffix}"
    journal = path if suffix == ".csv" else tmp_path / "sweep.parquet.rows"
    with sweep_files.collect(path, points) as (_, keep):
        for point in points[:4]:
            keep(expected[point])
        killed_with = journal.read_text()
    path.unlink()
    journal.write_text(killed_with[: killed_with.rfind(",")])
    with sweep_files.collect(path, points) as (missing, _):
        assert missing == points[3:]


def test_rows_of_other_points_and_failed_ones(expected, tmp_path):
    points, path = small_grid(), tmp_path / "sweep.csv"
    failed = expected[points[1]] | {"error": "MemoryError: too much"}
    with sweep_files.collect(path, points) as (_, keep):
        keep(expected[points[0]])
        keep(failed)
    with sweep_files.collect(path, points[1:3]) as (missing, _):
        assert missing == points[1:3], "a run that failed is not run again"
    assert [sweep.point_of(row) for row in sweep_files.read_rows(path)] == points[:1]


def test_two_sweeps_do_not_write_one_file(tmp_path):
    with sweep_files.collect(tmp_path / "sweep.csv", []):
        second = sweep_files.collect(tmp_path / "sweep.csv", [])
        with pytest.raises(ValueError, match="no other sweep is writing"), second:
            pass


@pytest.mark.parametrize("contents", ["a,b\n1,2\n", "", "\n"])
def test_another_file_is_refused_and_left_alone(tmp_path, contents):
    path = tmp_path / "mine.csv"
    path.write_text(contents)
    with pytest.raises(ValueError, match="mine.csv: expected the columns scene, method"), sweep_files.collect(path, []):
        pass
    assert path.read_text() == contents


def wait_until_all_have_ended(group):
    """Workers that outlive their parent would keep the processors for ever."""
    for _ in range(600):
        try:
            os.killpg(group, 0)
        except ProcessLookupError:
            return
        time.sleep(0.1)
    os.killpg(group, signal.SIGKILL)
    pytest.fail("workers have outlived their parent")


COMMAND = "sweep --seeds 200 --workers 2 --noise 1,2 --alpha own,0.5 --out"


@pytest.mark.slow
@pytest.mark.skipif(os.name == "nt", reason="Windows has no groups of processes that hear SIGINT together")
@pytest.mark.parametrize("by", [signal.SIGINT, signal.SIGKILL])
def test_the_command_ends_at_once_and_goes_on_later(tmp_path, by):
    """As a terminal sends Ctrl-C: to the whole group. Killed without a word, the file still holds what was done."""
    path = tmp_path / "sweep.csv"
    command = [sys.executable, "-m", "npslam_teach", *COMMAND.split(), str(path)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        while not path.exists() or len(path.read_text().splitlines()) < 6:
            assert process.poll() is None
            time.sleep(0.05)
        os.killpg(process.pid, by) if by == signal.SIGINT else process.kill()
        message = process.stderr.read() if by == signal.SIGINT else ""
    wait_until_all_have_ended(process.pid)
    if by == signal.SIGINT:
        assert process.returncode == 130
        assert message.strip().endswith("interrupted") and "Traceback" not in message
    rows = sweep_files.read_rows(path)
    assert len(without_seconds(rows)) >= 5
    again = sweep.run_point(sweep.point_of(rows[-1]))
    assert again | {"seconds": None} == rows[-1] | {"seconds": None}
