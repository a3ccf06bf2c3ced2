"""Runs in a kernel: every answer to an exercise as a cell of its own, judged by the lesson's check.

Beside the answers that are listed for the exercise there are some of each kind for every one, made of its solution.
"""

import ast

import numpy as np

USUAL_WRONG = ("text", "complex", "constant", "a little off", "arguments changed", "not finite", "nothing", "exit")
USUAL_RIGHT = ("lists", "single precision", "a callable object")


def verdicts(setup: str, solution: str, name: str, check: str, answers: list[tuple[str, str, str]]) -> list[tuple]:
    """(kind, title, whether the check passes, its message) of every answer.

    Args:
        setup: the first cell of the lesson's solutions, which imports its checks.
        solution: the cell that solves the exercise.
        name: of the function that it defines.
        check: name of the check.
        answers: kind, title and source of each, a cell that defines the function or an expression for it.
    """
    made = []
    for kind, title, source in answers:
        scope = _run(setup)
        exec(_cell(name, source), scope)  # the answers are our own
        made.append((kind, title, scope[name], scope))
    scope = _run(f"{setup}\n{solution}")
    made += [("wrong", f"usual: {title}", wrong(title, scope[name]), scope) for title in USUAL_WRONG]
    made += [("right", f"usual: {title}", right(title, scope[name]), scope) for title in USUAL_RIGHT]
    judged = [(kind, title, getattr(scope["checks"], check)(function)) for kind, title, function, scope in made]
    return [(kind, title, verdict.passed, verdict.message) for kind, title, verdict in judged]


def _run(source: str) -> dict:
    scope = {}
    exec(source, scope)
    return scope


def _cell(name: str, source: str) -> str:
    """A cell; the last line of an answer may be an expression, which is then the function."""
    *_, last = ast.parse(source.strip()).body
    if isinstance(last, ast.Expr):
        lines = source.strip().splitlines()
        return "\n".join([*lines[: last.lineno - 1], f"{name} = (", *lines[last.lineno - 1 :], ")"])
    return source


def wrong(title: str, solution):
    """A wrong answer that there is to every exercise."""
    first = []

    def constant(*arguments):
        first.append(solution(*arguments))
        return first[0]

    def changed(*arguments):
        answer = solution(*arguments)
        for each in arguments:
            if isinstance(each, np.ndarray) and each.size:
                each.flat[0] = each.flat[0] + 1
                return answer
        return "there was nothing to change"

    return {
        "text": lambda *a: _each(solution(*a), lambda x: np.asarray(x).astype(str).tolist()),
        "complex": lambda *a: _each(solution(*a), lambda x: np.asarray(x) + 1e-9j),
        "constant": constant,
        "a little off": lambda *a: _each(solution(*a), _last_off),
        "arguments changed": changed,
        "not finite": lambda *a: _each(solution(*a), lambda x: np.asarray(x) * np.nan),
        "nothing": lambda *a: None,
        "exit": lambda *a: exit(),
    }[title]


def right(title: str, solution):
    """A right answer of an unusual type; where the type is wrong for an exercise, the solution as it is."""
    if title == "lists":
        return lambda *a: _each(solution(*a), lambda x: np.asarray(x).tolist())
    if title == "single precision":
        return lambda *a: _each(solution(*a), _single)

    class Answer:
        def __call__(self, *arguments):
            return solution(*arguments)

    return Answer()


def _last_off(x):
    """The last number is another one."""
    array = np.array(x, dtype=float)
    if array.size:
        array.flat[-1] += 0.003 * (1 + abs(array.flat[-1]))
    return array


def _single(x):
    """Where all numbers are whole they count something, and stay what they are."""
    array = np.asarray(x)
    return array.astype(np.float32) if array.dtype.kind == "f" else x


def _each(answer, change):
    """Change an answer, or each part of a pair; graphs stay."""
    if isinstance(answer, tuple):
        return tuple(part if hasattr(part, "poses") else change(part) for part in answer)
    return change(answer)
