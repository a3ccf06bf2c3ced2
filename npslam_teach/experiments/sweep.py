"""Many runs: methods x noise x alpha x threshold x kernel x scene x seeds, on as many processors as there are.

A *point* of the grid is everything that decides a run, so that its row is the same wherever it is computed, and a row
says which point it is of: an interrupted sweep goes on with the points that have no row yet (``sweep_files``).
"""

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, Executor, Future
from contextlib import AbstractContextManager, suppress
from dataclasses import asdict, dataclass, fields, replace
from functools import lru_cache
from itertools import product
from queue import Empty, SimpleQueue

import numpy as np

from npslam_teach import simulate
from npslam_teach.evaluation import compared_labels, distances_to_truth
from npslam_teach.experiments import paper_simulation
from npslam_teach.experiments.runs import LEAST_ARI, Scene, run_method
from npslam_teach.methods import METHODS, settings_for
from npslam_teach.types import GroundTruth, RobotLog

SETTINGS = ("alpha", "threshold", "kernel_std")  # of a method, that a sweep can vary
SCALES = ("paper", "sensor")  # the paper's constants, or the same scaled to the noise of the log
MOST_DEATHS = 3  # of workers in a row, without a single row
_AT_WORK = 512  # points handed out at a time: enough for a cluster, and little to take back after Ctrl-C


@dataclass(frozen=True)
class Point:
    """Everything that decides a run."""

    scene: str  # a name of ``scene_names``, or the path of a log with truth
    method: str
    scale: str  # one of SCALES
    noise: float  # times the paper's
    alpha: float | None  # None: the method's own
    threshold: float | None
    kernel_std: float | None
    seed: int


AXES = tuple(field.name for field in fields(Point))
RESULTS = ("objects", "objects_true", "ari", "ari_used", "pose_error", "object_error", "used")
RESULTS += ("objective", "chi2", "seconds")
COLUMNS = (*AXES, *RESULTS, "error")


def scene_names() -> list[str]:
    """Scenes that need no file: the paper's, and the worlds of the gallery."""
    return ["fifteen_objects", *simulate.GALLERY]


def grid(
    methods: Iterable[str],
    seeds: Iterable[int],
    noise: Iterable[float] = (1.0,),
    scenes: Iterable[str] = ("fifteen_objects",),
    scales: Iterable[str] = ("paper",),
    **settings: Iterable[float | None],
) -> list[Point]:
    """Every combination, once: a method that does not have a setting is not run again for every value of it.

    The points of a room are neighbours, because a worker keeps the last rooms that it has simulated.

    Args:
        methods: names from ``methods.METHODS``.
        seeds: of the noise, and of a simulated scene.
        noise: 1 is the paper's.
        scenes: names from ``scene_names``, or paths of logs with truth.
        scales: of SCALES.
        **settings: values of SETTINGS; None is the method's own.

    Raises:
        ValueError: a name that is not known, or a setting that none of the methods has.
    """
    for name, values, known in (("methods", methods, METHODS), ("scales", scales, SCALES), ("", settings, SETTINGS)):
        for value in values:
            if value not in known:
                raise ValueError(f"{name or value}: expected one of {', '.join(known)}, got {value!r}")
    for name, values in settings.items():
        if list(values) != [None] and not any(name in METHODS[method].settings for method in methods):
            raise ValueError(f"{name}: expected a method that has it, got {', '.join(methods)}")
    rooms = product(scenes, noise, seeds)
    each = list(product(methods, scales, *(settings.get(name, (None,)) for name in SETTINGS)))
    points = (
        Point(str(scene), method, scale, float(level), *values, int(seed))
        for scene, level, seed in rooms
        for method, scale, *values in each
    )
    return list(dict.fromkeys(_as_run(point) for point in points))


def _as_run(point: Point) -> Point:
    """The point without the settings that its method does not have."""
    known = METHODS[point.method].settings
    return replace(point, **{name: None for name in SETTINGS if name not in known})


@lru_cache(maxsize=8)
def scene_of(name: str, noise: float, seed: int) -> Scene:
    """The room of a point; the last ones are kept, because neighbours in the grid share them.

    Args:
        name: as ``Point.scene``.
        noise: times the paper's.
        seed: of the noise, and of a simulated scene.
    """
    if name in simulate.GALLERY:
        drawing = replace(simulate.GALLERY[name].drawing, noise=noise, seed=seed)
        return Scene(name, seed, noise, *simulate.drawn_run(drawing))
    if name == "fifteen_objects":
        return next(iter(paper_simulation.scenes(None, noise, [seed])))
    return paper_simulation.with_noise_added(name, *_recorded(name), noise, seed)


@lru_cache(maxsize=8)  # each worker reads a file once, and not for every one of its rooms
def _recorded(path: str) -> tuple[RobotLog, GroundTruth]:
    return paper_simulation.recorded(path, is_complete=False)


def run_point(point: Point) -> dict:
    """One run: a row with the names of COLUMNS, plain values that another process can send back.

    A quantity that does not exist is None. ``ari`` is over all observations, ``ari_used`` over the share ``used`` that
    the method does not leave out. ``seconds`` are the method's alone and differ from run to run.
    An error other than wrong input ends this run alone, and stands in the row's ``error``.
    """
    empty = dict.fromkeys(COLUMNS) | asdict(point)
    try:
        scene = scene_of(point.scene, point.noise, point.seed)
        return empty | _measured(scene, run_method(point.method, scene.log, _settings_of(point, scene)))
    except (ArithmeticError, np.linalg.LinAlgError, MemoryError, RuntimeError) as error:
        return empty | {"error": " ".join(f"{type(error).__name__}: {error}".split())}


def _settings_of(point: Point, scene: Scene) -> dict:
    base = METHODS[point.method].scaled_by(settings_for(scene.log)) if point.scale == "sensor" else {}
    return base | {name: getattr(point, name) for name in SETTINGS if getattr(point, name) is not None}


def _measured(scene: Scene, run) -> dict:
    last = run.snapshots[-1]
    used = last.labels >= 0
    pose_errors, object_errors = distances_to_truth(last, scene.truth)
    ari, _, objects_true = compared_labels(last.labels, scene.truth.obs_object)
    counts = {"objects": last.num_objects, "objects_true": None if np.isnan(objects_true) else int(objects_true)}
    numbers = {
        "ari": ari,
        "ari_used": compared_labels(last.labels[used], scene.truth.obs_object[used])[0],
        "pose_error": pose_errors.mean() if pose_errors.size else None,
        "object_error": object_errors.mean() if object_errors.size else None,
        "used": used.mean() if used.size else None,
        "objective": last.objective,
        "chi2": last.chi2,
        "seconds": run.seconds,
    }
    return counts | {
        name: None if value is None or np.isnan(value) else float(value) for name, value in numbers.items()
    }


def point_of(row: dict) -> Point:
    """Which point a row is of."""
    return Point(**{name: row[name] for name in AXES})


def is_right(row: dict) -> bool:
    """Whether a run found exactly the true number of objects, and next to every observation's own."""
    return row["error"] is None and row["objects"] == row["objects_true"] and (row["ari"] or 0.0) >= LEAST_ARI


def sweep(points: Iterable[Point], pool: Callable[[], AbstractContextManager[Executor]]) -> Iterator[dict]:
    """Rows as they are done, one for every point, whatever happens to the workers.

    Args:
        points: of a grid.
        pool: makes the executor and ends it, as a context: ``executors.local_pool`` or ``dask_pool``, or
            ``lambda: contextlib.nullcontext(executor)``. It is made again when one of its workers has died.

    Raises:
        ValueError: wrong input, or workers that die again and again without a row.
    """
    left, fruitless = dict.fromkeys(points), 0
    while left:
        before = len(left)
        with pool() as executor:
            for row in _rows_while_it_lives(executor, list(left)):
                del left[point_of(row)]
                yield row
        fruitless = fruitless + 1 if len(left) == before else 0
        if fruitless == MOST_DEATHS:
            raise ValueError(f"workers: expected one that survives {next(iter(left))}, got {fruitless} that died")


def _rows_while_it_lives(executor: Executor, points: list[Point]) -> Iterator[dict]:
    """Rows as they are done, until all are or a worker has died; what is done by then is still handed on."""
    done: SimpleQueue[Future] = SimpleQueue()
    waiting, at_work, is_broken = iter(points), 0, False
    while True:
        try:
            while not is_broken and at_work < _AT_WORK and (point := next(waiting, None)) is not None:
                executor.submit(run_point, point).add_done_callback(done.put)
                at_work += 1
        except BrokenExecutor:
            is_broken = True
        if not at_work:
            return
        try:
            yield _next(done).result()
        except BrokenExecutor:
            is_broken = True
        at_work -= 1


def _next(done: SimpleQueue) -> Future:
    while True:
        with suppress(Empty):
            return done.get(timeout=0.2)  # on Windows, Ctrl-C is heard only between two waits
