"""What each command on logs and graphs does. Every function takes the parsed options and returns an exit code."""

import json
import time
from contextlib import nullcontext
from functools import cache
from pathlib import Path

from npslam_teach.cli import reports
from npslam_teach.cli.checkout import ROOT
from npslam_teach.cli.output_files import announce, folder_named, require_names, writer

SOLVE_FILES = (".json", ".g2o", ".tum", ".csv")


def fetch(options) -> int:
    """Fetch one of the authors' files and print its path."""
    from npslam_teach import datasets

    fetchers = {"simulation": datasets.fetch_mu2016_simulation, "office": datasets.fetch_stata_office}
    print(fetchers[options.name]())
    return 0


def solve(options) -> int:
    """Run one method on a log and tell what it found."""
    from npslam_teach import datasets, evaluation
    from npslam_teach.cli import solve_report, solving
    from npslam_teach.system import files

    solving.require_options(options)
    write, folder = writer(options.out, SOLVE_FILES), folder_named(options.figures)
    log, truth = datasets.load_log(options.log)
    with files.prefix_errors(options.log):
        log, estimated = solving.with_estimated_noise(options, solving.with_added_noise(options, log))
        settings = solving.settings_of(options, log)
        run, restarts = solving.run(options, log, settings)
        refitted = evaluation.refit(run.snapshots[-1], log)  # once: the score needs it, and so do the metrics
        fits = solving.agreement(options, run, refitted)
        result = solve_report.solve_result(run, truth, refitted) | fits | estimated
        result |= solving.sampled(options, log, settings, run)
    result["settings"] = {"name": solving.settings_name(options)} | settings
    result |= {"settled": solving.settled(run, settings), "restarts": restarts}
    solving.remarks(options, log, settings, run, fits)
    write(result, run.snapshots[-1].graph, run)
    _print(result if options.json else solve_report.solve_text(result, truth), options.json)
    _draw_result(run, truth, folder)
    return 0


def _draw_result(run, truth, folder: Path | None) -> None:
    if folder is None:
        return
    from npslam_teach import plotting

    plotting.style.put_settings_aside()
    folder.mkdir(parents=True, exist_ok=True)
    for name, figure in plotting.result_figures(run.snapshots, run.log, truth).items():
        plotting.save(figure, folder / name)


def import_recording(options) -> int:
    """Turn a recording into a log, and say what it holds."""
    from npslam_teach import datasets
    from npslam_teach.cli.import_options import given_options

    given, truth, remarks = given_options(options), None, []
    announce(options.out)
    if options.format == "mrclam":
        log, truth = datasets.load_mrclam(options.path, **given)
    elif options.format == "rosbag":
        log, remarks = datasets.load_rosbag(options.path, **given)
    elif options.format == "victoria-park":
        log, truth = datasets.load_hidden(options.path)
    else:
        log, truth = datasets.load_log(options.path)
    datasets.save_log(options.out, log, truth)
    classes = "one class" if log.num_classes == 1 else f"{log.num_classes} classes"
    print(f"{options.out}: {log.num_poses} poses, {log.num_observations} observations of {classes}")
    print(*remarks, sep="\n", end="\n" if remarks else "")
    return 0


def reproduce(options) -> int:
    """Run the paper's simulation once or over many seeds, with every method."""
    from npslam_teach.experiments import paper_simulation
    from npslam_teach.methods import METHODS
    from npslam_teach.system import files

    methods = options.methods or list(METHODS)
    folder = folder_named(options.figures)
    first_seed = options.first_seed
    if first_seed is None:
        first_seed = 2016 if options.data is None and options.seeds == 1 else 0
    seeds = range(first_seed, first_seed + options.seeds)
    scenes = paper_simulation.scenes(options.data, options.noise, seeds)
    with nullcontext() if options.data is None else files.prefix_errors(options.data):
        result, first, runs = paper_simulation.run_all(scenes, methods, options.iterations, options.seeds)
    _print(result if options.json else reports.reproduce_text(result), options.json)
    if options.table:
        paper_simulation.write_runs(result["runs"], Path(options.table))
    if folder is not None:
        from npslam_teach.course.fifteen_objects import figures as drawing

        folder.mkdir(parents=True, exist_ok=True)
        snapshots = {method: run.snapshots for method, run in runs.items()}
        drawing.draw_simulation(drawing.Comparison(first.log, first.truth, snapshots), folder)
    return 0


def sweep(options) -> int:
    """Run methods over a grid of points; the table grows row by row, and a second call goes on."""
    from npslam_teach.cli.sweep_options import run_sweep

    require_names([options.out], (".csv", ".parquet"))  # what is there is continued, not replaced
    points, computed, failed = run_sweep(options)
    print(f"{options.out}: {points} runs, {computed} of them computed now" + (f", {failed} failed" if failed else ""))
    return 0


def optimize(options) -> int:
    """Solve a pose graph read from a file; the seconds are those from arrays to solution."""
    from npslam_teach import datasets, pose_graph
    from npslam_teach.system import files, progress

    write = writer([options.out] if options.out is not None else [], (".g2o",))
    graph = datasets.load_g2o(options.graph)
    _warm_up_solver()
    with files.prefix_errors(options.graph):
        initial = pose_graph.chi2(pose_graph.given_start(graph))
        optimum = pose_graph.certified_minimum(graph, options.tolerance)
        seconds = [optimum.seconds]
        again = (options.repeat or 1) - 1
        for _ in progress.track(range(again), again, "optimize", "runs"):
            begin = time.perf_counter()
            pose_graph.minimize(graph, options.tolerance)
            seconds.append(time.perf_counter() - begin)
    result = reports.optimize_result(optimum, initial, seconds if options.repeat else seconds[0])
    write(result, optimum.graph)
    _print(result if options.json else reports.optimize_text(result), options.json)
    return 0


def figures(options) -> int:
    """Draw every figure of the course anew, or those of a sweep."""
    if options.sweep is not None:
        return _draw_sweep(options)
    from npslam_teach.course import all_figures

    folder = ROOT / "figures" if options.out is None else folder_named(options.out)
    folder.mkdir(parents=True, exist_ok=True)
    all_figures.draw_all(folder)
    print(f"figures: {folder}")
    return 0


def _draw_sweep(options) -> int:
    from npslam_teach import plotting
    from npslam_teach.experiments import sweep_files
    from npslam_teach.system import files

    rows = sweep_files.read_rows(options.sweep)
    folder = folder_named(str(Path(options.sweep).with_suffix("")) if options.out is None else options.out)
    plotting.style.put_settings_aside()
    with files.prefix_errors(options.sweep):
        drawn = plotting.success_figures(rows)
    folder.mkdir(parents=True, exist_ok=True)
    for name, figure in drawn.items():
        plotting.save(figure, folder / name)
    print(f"figures: {folder}")
    return 0


@cache
def _warm_up_solver() -> None:
    """Solve a triangle: whatever the solver imports on its way, SciPy above all, is not its own time."""
    import numpy as np

    from npslam_teach import pose_graph, types

    steps = types.BetweenFactors([0, 1, 2], [1, 2, 0], np.zeros((3, 3)), [np.eye(3)] * 3)
    nothing = types.ObservationFactors([], [], np.zeros((0, 2)), np.zeros((0, 2, 2)))
    poses = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]
    pose_graph.certified_minimum(types.PoseGraph(poses, np.zeros((0, 2)), steps, nothing))


def _print(result, as_json: bool) -> None:
    print(json.dumps(reports.plain(result), allow_nan=False) if as_json else result)
