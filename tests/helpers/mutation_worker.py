"""A process that gives damaged files to the command line, one after the other, and tells what became of each.

``python mutation_worker.py SUFFIX NUMBERS FOLDER [DATA]`` prints one JSON object per line: first
``{"begin": n}``, then the outcome. Whoever started it knows from the last line which file it died of.
"""

import contextlib
import functools
import hashlib
import io
import json
import os
import sys
import time
import warnings
import zipfile
from pathlib import Path

import numpy as np
from mutations import BOMB_EVERY, SUFFIXES, damaged, small_run

from npslam_teach import datasets, pose_graph, types
from npslam_teach.cli import parser
from npslam_teach.datasets import log_fields, log_files
from npslam_teach.experiments import runs
from npslam_teach.methods import METHODS
from npslam_teach.pose_graph import observation_factors, odometry_factors

MEGABYTE = 1 << 20
YARDSTICK = "NPSLAM_TEACH_TEST_YARDSTICK"  # what an earlier worker of the same campaign has measured
UPPER = {size: np.triu_indices(size) for size in (2, 3)}  # places of an upper triangle, in the order of g2o
# Every method in turn, the slow ones a twelfth as often. A test sees that every method meets every kind of damage.
FAST = tuple(name for name in METHODS if name not in ("online", "posterior"))
METHODS_IN_TURN = (*METHODS, *11 * FAST)


def main(suffix: str, numbers: list[int], folder: Path, bases: dict | None) -> None:
    """Try some files of a format."""
    parser.build_parser = functools.cache(parser.build_parser)  # a process of its own would build it once, too
    runs._warm_up = lambda method: None  # nobody looks at the seconds of a method
    limit_memory(2048 * MEGABYTE)
    for number in numbers:
        tell(begin=number)
        case = damaged(suffix, number, bases)
        path = folder / f"damaged.{suffix}"
        path.unlink(missing_ok=True)  # to cut the old file short, where some systems first write it to the disk
        path.write_bytes(case.contents)
        told = {"name": case.name, "digest": hashlib.sha1(case.contents).hexdigest(), "yardstick": yardstick()}
        tell(**told, **outcome(path, number))


@functools.cache
def yardstick() -> float:
    """The processor's seconds that the slowest method takes here and now for one of our logs, undamaged."""
    if YARDSTICK in os.environ:
        return float(os.environ[YARDSTICK])
    log, _ = small_run(0)
    begin = time.process_time()
    *_, _ = METHODS["posterior"](log)
    return time.process_time() - begin


def tell(**fields) -> None:
    """One line for whoever listens."""
    sys.__stdout__.write(json.dumps(fields) + "\n")
    sys.__stdout__.flush()


def arguments_for(path: Path, number: int) -> list[str]:
    """What a user types: every method in turn, sometimes with noise, the posterior mostly with a single search."""
    if path.suffix == ".g2o":
        return ["optimize", str(path), "--json"]
    round_, turn = divmod(number, len(METHODS_IN_TURN))
    # The bombs are few, and have a turn of their own.
    in_turn = METHODS_IN_TURN[turn], list(METHODS)[number // BOMB_EVERY % len(METHODS)]
    method = in_turn[number % BOMB_EVERY == 1]
    noise = ["--noise", "0.5"] if number % 7 == 0 else []
    starts = ["--starts", "1"] if method == "posterior" and round_ % 4 else []
    return ["solve", str(path), "--json", "--method", method, *noise, *starts]


def outcome(path: Path, number: int) -> dict:
    """Run the command line on a file: its exit code, what is wrong with its answer, its poses, seconds and memory."""
    arguments = arguments_for(path, number)
    out, err = io.StringIO(), io.StringIO()
    forget_peak()
    wall, cpu = time.perf_counter(), time.process_time()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            code = parser.main(arguments)
        except BaseException as error:  # every one of them would be a traceback, or an exit that nobody explains
            code = f"{type(error).__name__}: {error}"
    seconds = {"seconds": time.perf_counter() - wall, "cpu_seconds": time.process_time() - cpu}
    measured = {**seconds, "megabytes": peak_memory() / MEGABYTE}
    problem = wrong_with(code, out.getvalue(), err.getvalue(), path, arguments)
    poses = len(json.loads(out.getvalue())["poses"]) if code == 0 and problem is None else 0
    return {"code": code, "problem": problem, "said": err.getvalue(), "poses": poses, **measured}


# ---- what an answer must be ----


def wrong_with(code, out: str, err: str, path: Path, arguments: list) -> str | None:
    """What is wrong with an answer, or None."""
    warned = f"npslam_teach {arguments[0]}: warning: "
    lines = [line.rsplit("\r", 1)[-1] for line in err.split("\n")]  # what a progress bar leaves behind
    sentences = [line for line in lines if line.strip() and not line.startswith(warned)]
    if code == 0:
        try:
            return wrong_with_result(out, path, arguments) or (f"said {sentences}" if sentences else None)
        except Exception as error:
            return f"the answer could not be checked: {type(error).__name__}: {error}"
    if code != 2:
        return f"ended with {code!r}"
    if out or len(sentences) != 1 or not sentences[0].startswith(f"npslam_teach {arguments[0]}: {path}"):
        return "expected one sentence that names the file, and nothing on standard output"
    return "the sentence is too long" if len(sentences[0]) > len(str(path)) + 400 else None


def wrong_with_result(out: str, path: Path, arguments: list) -> str | None:
    """Whether the JSON is whole and finite, is about this file, and its chi2 is that of its own numbers."""
    result = json.loads(out, parse_constant=refuse)
    if path.suffix != ".g2o" and not METHODS[result["method"]].has_objective:
        if any(each.pop("objective") is not None for each in (result, *result["restarts"])):
            return f"{result['method']} has an objective"
    where = not_finite(result, "result")
    if where:
        return f"not a number: {where}"
    if path.suffix == ".g2o":
        return wrong_with_graph(result, path)
    return wrong_with_log(result, path, arguments)


def refuse(word: str):
    """What JSON does not know."""
    raise ValueError(f"{word} in JSON")


OF_TRUTH = ("mean_pose_error", "rmse_pose_error", "cumulative_pose_error", "num_objects_true", "ari", "v_measure")
MAY_BE_MISSING = (
    *(f"result.metrics.{name}" for name in OF_TRUTH),  # where the truth is, see ``wrong_with_log``
    "result.metrics.chi2_per_dof",
    "result.chi2_per_dof",
    "result.metrics.mean_object_error",
    "result.quality.position_variance",
    "result.settled",
    "result.smallest_eigenvalue",
)


def not_finite(value, name: str) -> str | None:
    """The first entry that is no finite number; a metric may be missing."""
    if isinstance(value, dict):
        return next(filter(None, (not_finite(entry, f"{name}.{key}") for key, entry in value.items())), None)
    if isinstance(value, list):
        return next(filter(None, (not_finite(entry, f"{name}[{k}]") for k, entry in enumerate(value))), None)
    if value is None:
        return None if name in MAY_BE_MISSING else name
    return None


def wrong_with_graph(result: dict, path: Path) -> str | None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the command has said so already
        graph = datasets.load_g2o(path)
    # Where all poses are at one place, it sets out from the odometry.
    initial = None if (graph.poses == graph.poses[0]).all() else chi2_of_text(path)
    if initial is not None and not close(result["chi2_initial"], initial, 1e-6):
        return f"chi2_initial is {result['chi2_initial']}, by the text of the file it is {initial}"
    solved = moved(graph, result["poses"], result["landmarks"])
    if not close(result["chi2"], pose_graph.chi2(solved), 1e-9):
        return f"chi2 is {result['chi2']}, of its own poses {pose_graph.chi2(solved)}"
    return None if result["chi2"] <= result["chi2_initial"] else "chi2 rose"


def moved(graph, poses, landmarks):
    """The same factors, other estimates."""
    shape = np.reshape(poses, (-1, 3)), np.reshape(landmarks, (-1, 2))
    return type(graph)(*shape, graph.between, graph.observations)


def chi2_of_text(path: Path) -> float | None:
    """chi2 as g2o defines it, from the words of the file; None where rounding would blur it."""
    text = path.read_bytes().removeprefix(b"\xef\xbb\xbf")
    lines = [line.split(b"#")[0].split() for line in text.splitlines()]
    lines = [(line[0], [float(word) for word in line[1:]]) for line in lines if line]
    if not any(tag == b"VERTEX_SE2" for tag, _ in lines) or not any(tag == b"VERTEX_XY" for tag, _ in lines):
        return None  # the edges alone say where everything begins
    if any(abs(number) > 1e3 for tag, numbers in lines if tag != b"FIX" for number in numbers[1:4]):
        return None
    vertex = {
        v[0]: (complex(v[1], v[2]), np.exp(1j * v[3]) if len(v) > 3 else 1) for t, v in lines if t[:6] == b"VERTEX"
    }
    total = 0.0
    for tag, (i, j, *values) in ((tag, values) for tag, values in lines if tag.startswith(b"EDGE")):
        (at, turn), (there, other_turn) = vertex[i], vertex[j]
        offset = (there - at) / turn - complex(*values[:2])
        size = 2 if tag == b"EDGE_SE2_XY" else 3
        if size == 3:
            offset /= np.exp(1j * values[2])  # g2o looks from the measured pose
            residual = [offset.real, offset.imag, np.angle(other_turn / turn / np.exp(1j * values[2]))]
        else:
            residual = [offset.real, offset.imag]
        information = np.zeros((size, size))
        information[UPPER[size]] = values[size:]
        information += np.triu(information, 1).T
        if np.linalg.eigvalsh(information)[0] < 0:
            return None
        total += residual @ information @ residual
    return total


def wrong_with_log(result: dict, path: Path, arguments: list) -> str | None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the command has said so already
        log, truth = log_files.load_log(path)
    labels = np.array(result["labels"], int)
    if path.suffix == ".npz" and (wrong := other_than_numpy(path, log)):
        return wrong
    if len(labels) != log.num_observations or len(result["poses"]) != log.num_poses:
        return "the result is of another size than the log"
    if (truth is None) == ("metrics" in result):
        return "metrics without truth, or truth without metrics"
    if truth is not None and truth.is_complete and None in (result["metrics"][name] for name in OF_TRUTH):
        return "a measure is missing that the truth allows"
    votes = np.array([entry["votes"] for entry in result["objects"]]).reshape(-1, log.num_classes + 1)
    if votes.sum() != np.count_nonzero(labels >= 0) + len(votes) or (votes[:, 0] != 1).any():
        return "votes are not one for every observation and one against every object"
    if "--noise" in arguments:
        return None  # its factors are not those of the file
    return wrong_chi2(result, log, labels)


def wrong_chi2(result: dict, log, labels) -> str | None:
    odometry_std = result["settings"].get("odometry_std", log.odometry_std)
    observation_std = result["settings"].get("observation_std", log.observation_std)
    xy = np.array([entry["xy"] for entry in result["objects"]]).reshape(-1, 2)
    factors = odometry_factors(log, odometry_std), observation_factors(log, labels, observation_std)
    chi2 = pose_graph.chi2(types.PoseGraph(np.array(result["poses"]), xy, *factors))
    return None if close(result["chi2"], chi2, 1e-9) else f"chi2 is {result['chi2']}, of its own poses {chi2}"


def other_than_numpy(path: Path, log) -> str | None:
    """What NumPy's own reader reads differently."""
    with zipfile.ZipFile(path) as archive, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of headers as Python 2 wrote them
        entries = {name.removesuffix(".npy"): name for name in archive.namelist()}
        for name in log_fields.LOG_FIELDS:
            with archive.open(entries[name]) as stream:
                if not np.array_equal(np.lib.format.read_array(stream), getattr(log, name)):
                    return f"{name} is not what NumPy reads"
    return None


def close(a: float, b: float, tolerance: float) -> bool:
    return abs(a - b) <= tolerance * max(abs(a), abs(b)) + 1e-12


# ---- memory ----


def limit_memory(size: int) -> None:
    """An allocation beyond it fails at once, where the system can do so; a hog must not take the machine along."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (size, size))


def forget_peak() -> None:
    """Let the peak start over; only Linux can."""
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def peak_memory() -> int:
    """Bytes of memory at the peak: since ``forget_peak`` on Linux, of the process elsewhere, 0 on Windows."""
    with contextlib.suppress(OSError):
        fields = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
        return 1024 * int(fields["VmHWM"].split()[0])
    with contextlib.suppress(ImportError):
        import resource

        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # macOS counts bytes
    return 0


def originals(data: str) -> dict:
    """The files of a folder by their suffix, to be damaged instead of ours."""
    files = sorted(path for path in Path(data).iterdir() if path.suffix[1:] in SUFFIXES)
    return {suffix: [path.read_bytes() for path in files if path.suffix[1:] == suffix] for suffix in SUFFIXES}


if __name__ == "__main__":
    chosen_suffix, chosen_numbers, chosen_folder = sys.argv[1:4]
    chosen_bases = originals(sys.argv[4]) if len(sys.argv) > 4 else None
    main(chosen_suffix, [int(number) for number in chosen_numbers.split(",")], Path(chosen_folder), chosen_bases)
