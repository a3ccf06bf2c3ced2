"""Cells of a lesson that give an exercise away: what they compute is most of its solution, under other names.

A cell that works with numbers or with parts of a log gives the formula away as well as one that has other names. So a
name of the solution may stand for any of these, as long as it stands for the same one throughout an expression.
"""

import ast

ENOUGH = 0.45  # of a solution's code in one other cell: half of it, or the line that matters
SMALL = 7  # nodes of the syntax tree: smaller expressions, such as one product, are found everywhere
SMALLEST = 5  # the same for a solution that has no larger ones


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
    known = [node for node in ast.walk(ast.parse(other)) if isinstance(node, ast.expr) and _size(node) >= SMALLEST]
    small = SMALL if _expressions(function, SMALL) else SMALLEST
    covered = _covered(function, known, _variables(function), small)
    return covered / max(sum(_size(each) for each in _expressions(function, small)), 1)


def _covered(node: ast.AST, known: list[ast.expr], variables: set[str], small: int) -> int:
    """The size of the largest expressions below a node that are known."""
    if isinstance(node, ast.expr):
        if _size(node) < small:
            return 0
        if any(_alike(node, each, variables, {}) for each in known):
            return _size(node)
    return sum(_covered(child, known, variables, small) for child in ast.iter_child_nodes(node))


def _expressions(function: ast.FunctionDef, small: int) -> list[ast.expr]:
    """What its statements compute, each the whole of an expression that is not small."""
    found = []
    for node in ast.walk(function):
        if isinstance(node, ast.stmt):
            children = ast.iter_child_nodes(node)
            found += [each for each in children if isinstance(each, ast.expr) and _size(each) >= small]
    return found


def _variables(function: ast.FunctionDef) -> set[str]:
    """Its arguments, and the names that it gives; the others are of functions and modules."""
    given = {each.id for each in ast.walk(function) if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)}
    return given | {each.arg for each in ast.walk(function) if isinstance(each, ast.arg)}


def _size(node: ast.AST) -> int:
    return sum(1 for each in ast.walk(node) if not isinstance(each, ast.expr_context))


def _alike(wanted, node, variables: set[str], bound: dict[str, str]) -> bool:
    """Whether code is the wanted one, where each variable stands for one name, number, or part of something."""
    if isinstance(wanted, ast.Name) and wanted.id in variables:
        return _stands_alone(node) and bound.setdefault(wanted.id, ast.unparse(node)) == ast.unparse(node)
    if isinstance(wanted, ast.BinOp) and isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        return _size(wanted) < SMALLEST  # as 1 - p, worked out
    if isinstance(wanted, list):
        pairs = zip(wanted, node, strict=False)
        return len(wanted) == len(node) and all(_alike(*pair, variables, bound) for pair in pairs)
    if not isinstance(wanted, ast.AST):
        return wanted == node
    fields = [name for name in wanted._fields if name != "ctx"]
    return type(wanted) is type(node) and all(
        _alike(getattr(wanted, name), getattr(node, name), variables, bound) for name in fields
    )


def _stands_alone(node) -> bool:
    """A name, a number, a part of something, or an expression of numbers alone."""
    if isinstance(node, ast.Name | ast.Constant | ast.Attribute | ast.Subscript):
        return True
    if not isinstance(node, ast.expr) or isinstance(node, ast.Slice):
        return False
    return {each.id for each in ast.walk(node) if isinstance(each, ast.Name)} <= {"np", "math"}
