"""Every damaged file ends in one sentence or in a right answer: soon, in little memory, and without a crash.

The files go through the command line, in processes that can be killed. Each is measured on its own, so that a crash, a
hang or a hog is reported with the name of its file.
"""

import collections
import contextlib
import itertools
import json
import os
import pickle
import queue
import subprocess
import sys
import threading
from pathlib import Path

import psutil
import pytest
from mutation_worker import YARDSTICK, arguments_for
from mutations import BOMBS, DEEP, KEPT, SUFFIXES, blind, damaged, intact_files, kind_of

from npslam_teach.methods import METHODS

HELPERS = Path(__file__).parents[1] / "helpers"
FILES_PER_FORMAT, DISTINCT_PER_FORMAT = 1_060, 900
# Of the next six hundred those alone that reach lines, or leave them by an exception, where none of the first does.
FARTHER = {"g2o": (1577, 1621, 1691), "npz": (1081, 1268, 1472, 1513), "mat": (1655,)}
# The processor's seconds of a file, as a multiple of what the slowest method takes for an undamaged one in the same
# campaign: the machine may be slow, or busy. Ours take it 0.6 to 1.3 times, by their observations.
MOST_TIMES, MOST_MEGABYTES = 3.0, 500.0
POSES_PER_TIME = 2_500.0  # damage can leave a log that is whole, and long: twenty observations over 20,000 poses
PATIENCE = 60.0  # seconds of silence after which a file counts as a hang, unless the worker has only been waiting its
MOST_CPU_SECONDS = 20.0  # turn on a busy machine: it must have rested, or used the processor for so long


def campaign(suffix, numbers, folder, data=None):
    """The outcome of each damaged file, by its number; ``data``: damage the original files of this folder instead."""
    outcomes, todo, more = {}, list(numbers), {KEPT: str(folder / "intact_files")}
    Path(more[KEPT]).write_bytes(pickle.dumps(intact_files()))
    while todo:
        outcomes |= run_worker(suffix, todo, folder, data, more)
        if measured := [each["yardstick"] for each in outcomes.values() if "yardstick" in each]:
            more[YARDSTICK] = str(measured[0])
        todo = [number for number in todo if number not in outcomes]
    return outcomes


def run_worker(suffix, numbers, folder, data, more):
    """What one worker tells until it is through, or dies of a file, which is then an outcome, too.

    ``more``: of its environment, what it need not work out itself.
    """
    command = [
        sys.executable,
        HELPERS / "mutation_worker.py",
        suffix,
        ",".join(map(str, numbers)),
        folder,
    ]
    environment = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"} | more
    environment.pop("TQDM_DISABLE", None)  # a bar where nobody waits is something that a user would see, too
    outcomes, begun, lines = {}, numbers[0], queue.Queue()
    with (
        (folder / "standard_error").open("w+", encoding="utf-8") as complaints,
        subprocess.Popen(
            [str(part) for part in [*command, *([data] if data else [])]],
            stdout=subprocess.PIPE,
            stderr=complaints,
            encoding="utf-8",
            env=environment,
        ) as worker,
    ):
        reader = threading.Thread(target=lambda: [lines.put(line) for line in itertools.chain(worker.stdout, [""])])
        reader.start()
        problem = None
        while line := next_line(lines, psutil.Process(worker.pid)):
            told = json.loads(line)
            begun = told.get("begin", begun)
            if "name" in told:
                outcomes[begun] = told
        if line is None:
            problem = f"not done after {PATIENCE} s"
            worker.kill()
        reader.join()
        code = worker.wait()
        complaints.seek(0)
        said = complaints.read()[-500:]
    if begun not in outcomes:
        problem = problem or f"the process died with {code}: {said}"
    elif said:
        problem = f"somebody wrote on standard error: {said}"
    if problem:
        outcomes[begun] = {"name": f"{suffix}-{begun}", "problem": problem, "code": None}
    return outcomes


def next_line(lines, worker):
    """What the worker says next, nothing at its end; None when it hangs."""
    begin = cpu_seconds(worker)
    while True:
        before = cpu_seconds(worker)
        try:
            return lines.get(timeout=PATIENCE)
        except queue.Empty:
            now = cpu_seconds(worker)
            if now == before or now - begin > MOST_CPU_SECONDS:
                return None


def cpu_seconds(process):
    """What a process has used; of one that has ended, nothing more is known."""
    with contextlib.suppress(psutil.Error):
        return sum(process.cpu_times()[:2])
    return 0.0


def complaints_about(outcomes):
    """One line for every file that ended in another way than it may."""
    found = []
    for outcome in outcomes.values():
        if outcome["problem"]:
            found.append(f"{outcome['name']}: {outcome['problem']} {outcome.get('said', '')!r}")
            continue
        most_seconds = (MOST_TIMES + outcome["poses"] / POSES_PER_TIME) * outcome["yardstick"]
        if outcome["cpu_seconds"] > most_seconds or outcome["megabytes"] > MOST_MEGABYTES:
            found.append(f"{outcome['name']}: {outcome['cpu_seconds']:.1f} s, {outcome['megabytes']:.0f} MB")
    return found


@pytest.mark.slow
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_damaged_file_ends_in_one_sentence_or_a_right_answer(tmp_path, suffix):
    numbers = [*range(FILES_PER_FORMAT), *FARTHER[suffix]]
    outcomes = campaign(suffix, numbers, tmp_path)
    assert sorted(outcomes) == numbers
    assert not complaints_about(outcomes)
    codes = collections.Counter(outcome["code"] for outcome in outcomes.values())
    # Damage that is always noticed, or never, would test only half.
    assert codes[0] > FILES_PER_FORMAT // 10 and codes[2] > FILES_PER_FORMAT // 2
    assert len({outcome["digest"] for outcome in outcomes.values()}) >= DISTINCT_PER_FORMAT


def test_a_damaged_file_is_known_by_its_number():
    for suffix in SUFFIXES:
        for number in range(0, 400, 20):
            assert damaged(suffix, number) == damaged(suffix, number)


@pytest.mark.parametrize("suffix", ["npz", "mat"])
def test_every_method_meets_every_kind_of_damage(suffix):
    met = collections.defaultdict(set)
    for number in range(FILES_PER_FORMAT):
        *_, method = (word for word in arguments_for(Path(f"x.{suffix}"), number) if word in METHODS)
        met[method].add(kind_of(suffix, number))
    assert met.keys() == METHODS.keys()
    assert all(kinds >= {blind, *DEEP[suffix], BOMBS[suffix]} for kinds in met.values())


# ---- the harness itself notices ----

FEW_TIMES = 0.5  # in place of MOST_TIMES, so that nobody need be busy for so long
# What answers a file instead of the command, and words of the complaint about it.
ANSWERS = (
    ("import os, signal; os.kill(os.getpid(), signal.SIGKILL)", "the process died with"),
    ("import time; time.sleep(1000)", "not done after"),
    ("raise RuntimeError('unexpected')", "ended with 'RuntimeError: unexpected'"),
    ("hog = b'1' * 600_000_000; raise ValueError(path + ': no')", " MB"),
    (
        f"import time, __main__; end = time.process_time() + {FEW_TIMES + 0.3} * __main__.yardstick()\n"
        "        while time.process_time() < end: pass\n"
        "        raise ValueError(path + ': no')",
        " s, ",
    ),
    ("print('[NaN]'); return 0", "could not be checked"),
    ("return 0", "could not be checked"),
    ("raise ValueError('no name')", "expected one sentence that names the file"),
)
# Looks at the number of the file, which after a crash is not the first that the process meets.
BROKEN = """
import sys
from npslam_teach.cli import parser as cli
original, calls = cli.main, []
def broken(number, path):
{branches}
def main(arguments):
    calls.append(1)
    number = int(sys.argv[2].split(",")[len(calls) - 1])
    if not 1 <= number <= {count}: return original(arguments)
    try: return broken(number, arguments[1])
    except ValueError as error: return cli._explain('npslam_teach', arguments[0], error)
cli.main = main
"""


@pytest.fixture(scope="module")
def complaints(tmp_path_factory):
    """About files of which all but the first and the last are answered by ``ANSWERS``."""
    folder, count = tmp_path_factory.mktemp("broken"), len(ANSWERS)
    branches = "\n".join(f"    if number == {k}:\n        {what}" for k, (what, _) in enumerate(ANSWERS, 1))
    (folder / "sitecustomize.py").write_text(BROKEN.format(branches=branches, count=count), encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", os.pathsep.join([str(folder), os.environ["PYTHONPATH"]]))
        patch.setattr(sys.modules[__name__], "PATIENCE", 5.0)
        patch.setattr(sys.modules[__name__], "MOST_TIMES", FEW_TIMES)
        return complaints_about(campaign("g2o", range(count + 2), folder))


@pytest.mark.slow
@pytest.mark.parametrize(("number", "what", "words"), [(k, *answer) for k, answer in enumerate(ANSWERS, 1)])
def test_a_crash_a_hang_a_hog_and_a_traceback_are_noticed(complaints, number, what, words):
    if not hasattr(os, "fork") and "signal" in what:
        pytest.skip("no SIGKILL on this system")
    if not Path("/proc/self/clear_refs").exists() and words == " MB":
        pytest.skip("the peak of one file is known on Linux only")
    (complaint,) = [each for each in complaints if each.startswith(f"g2o-{number}")]
    assert words in complaint


def test_nothing_is_said_against_files_that_are_answered_as_ever(complaints):
    assert not [each for each in complaints if each.startswith(("g2o-0", f"g2o-{len(ANSWERS) + 1}"))]
