"""Cells of a lesson that give an exercise away: what they compute is most of its solution, under other names."""

import ast
import copy

ENOUGH = 0.45  # of a solution's code in one other cell: half of it, or the line that matters
SMALL = 9  # nodes of the syntax tree: smaller expressions are found everywhere


def overlaps(lesson, solutions) -> list[tuple[int, str, float]]:
    """Where a lesson shows what it asks for.

    Args:
        lesson: the notebook.
        solutions: the notebook of its solutions, whose cells have the same tags.

    Returns:
        the exercise, the id of the other cell, and which share of the solution stands there.
    """
    found = []
    for exercise in solutions.cells:
        numbers = [tag for tag in exercise.metadata.get("tags", []) if tag.startswith("exercise-")]
        for number in numbers:
            for cell in lesson.cells:
                own = number in cell.metadata.get("tags", []) or cell.cell_type != "code"
                part = 0.0 if own else share(exercise.source, cell.source)
                if part > ENOUGH:
                    found.append((int(number.removeprefix("exercise-")), cell.id, part))
    return found


def share(solution: str, other: str) -> float:
    """Which part of a solution's expressions, by their size, occurs in other code under any names."""
    (function,) = (node for node in ast.parse(solution).body if isinstance(node, ast.FunctionDef))
    known = {_nameless(node) for node in ast.walk(ast.parse(other)) if isinstance(node, ast.expr)}
    return _covered(function, known) / max(sum(_size(each) for each in _expressions(function)), 1)


def _covered(node: ast.AST, known: set[str]) -> int:
    """The size of the largest expressions below a node that are known."""
    if isinstance(node, ast.expr):
        if _size(node) < SMALL:
            return 0
        if _nameless(node) in known:
            return _size(node)
    return sum(_covered(child, known) for child in ast.iter_child_nodes(node))


def _expressions(function: ast.FunctionDef) -> list[ast.expr]:
    """What its statements compute, each the whole of an expression, without its arguments and targets."""
    found = []
    for node in ast.walk(function):
        if isinstance(node, ast.stmt):
            children = ast.iter_child_nodes(node)
            found += [each for each in children if isinstance(each, ast.expr) and _size(each) >= SMALL]
    return found


def _size(node: ast.AST) -> int:
    return sum(1 for each in ast.walk(node) if not isinstance(each, ast.expr_context))


def _nameless(node: ast.expr) -> str:
    """An expression whose variables are numbered in the order in which they appear."""
    node, names = copy.deepcopy(node), {}
    for each in ast.walk(node):
        if isinstance(each, ast.Name):
            each.id, each.ctx = names.setdefault(each.id, f"v{len(names)}"), ast.Load()
    return ast.dump(node)
