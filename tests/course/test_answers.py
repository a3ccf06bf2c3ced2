"""Every check accepts every right answer and no wrong one: lists of both, run in a kernel as students run theirs.

``answers/lesson_NN.py`` has for each exercise at least eight wrong answers and three right ones of unusual kinds. An
answer is a cell that defines the function, an expression for it, or a pair: what to replace in the solution, by what.
"""

import importlib
import json
import sys
from pathlib import Path

import pytest
from exercises import SOLUTIONS, exercises
from jupyter_client.manager import KernelManager
from kernel_ports import use_own_ports

HELPERS = Path(__file__).parents[1] / "helpers"
sys.path.insert(0, str(Path(__file__).parent))
EXERCISES = exercises()


def listed(exercise, kind: str) -> dict:
    lesson = importlib.import_module(f"answers.lesson_{exercise.lesson[:2]}")
    return getattr(lesson, kind.upper())[exercise.number]


def cells(exercise) -> dict[str, str]:
    import nbformat

    path = SOLUTIONS / f"{exercise.lesson[:2]}_solutions.ipynb"
    tagged = {}
    for cell in nbformat.read(path, as_version=4).cells:
        for tag in cell.metadata.get("tags", []):
            tagged[tag] = cell.source
    return tagged


def source_of(answer, solution: str) -> str:
    if isinstance(answer, str):
        return answer
    before, after = answer
    assert before in solution, before
    return solution.replace(before, after)


@pytest.mark.parametrize("exercise", EXERCISES, ids=str)
def test_there_are_enough_answers(exercise):
    wrong, right = listed(exercise, "wrong"), listed(exercise, "right")
    assert len(set(map(str, wrong.values()))) >= 8
    assert len(set(map(str, right.values()))) >= 3


@pytest.fixture(scope="module")
def kernel():
    """One warm kernel for the whole file."""
    use_own_ports()
    manager = KernelManager(kernel_name="python3")
    manager.start_kernel()
    client = manager.blocking_client()
    client.start_channels()
    client.wait_for_ready(timeout=120)
    assert run(client, f"import sys; sys.path.insert(0, {str(HELPERS)!r}); import answers_in_kernel, json") == ""
    yield client
    client.stop_channels()
    manager.shutdown_kernel(now=True)


def run(client, code: str) -> str:
    """What a cell prints."""
    printed = []

    def keep(message):
        if message["msg_type"] == "stream":
            printed.append(message["content"]["text"])
        assert message["msg_type"] != "error", "\n".join(message["content"]["traceback"])

    client.execute_interactive(code, timeout=300, output_hook=keep)
    return "".join(printed)


@pytest.mark.parametrize("exercise", EXERCISES, ids=str)
def test_right_answers_pass_and_wrong_ones_do_not(exercise, kernel):
    tagged = cells(exercise)
    solution = tagged[f"exercise-{exercise.number}"]
    answers = [
        (kind, title, source_of(answer, solution))
        for kind in ("wrong", "right")
        for title, answer in listed(exercise, kind).items()
    ]
    # An exercise may build on those before it.
    before = [tagged[f"exercise-{number}"] for number in range(1, exercise.number)]
    arguments = "\n".join([tagged["setup"], *before]), solution, exercise.answer, exercise.check, answers
    judged = json.loads(run(kernel, f"print(json.dumps(answers_in_kernel.verdicts(*{arguments!r})))"))
    assert len(judged) >= len(answers) + 11
    failures = [f"{kind} {title}: {message}" for kind, title, passed, message in judged if passed != (kind == "right")]
    assert not failures, "\n".join(failures)
