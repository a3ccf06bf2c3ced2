"""Exercise cells as text: put a solution in place of the dots, and take it out again."""

import ast
import re

SOLUTION = ("### BEGIN SOLUTION", "### END SOLUTION")
HIDDEN_TESTS = ("### BEGIN HIDDEN TESTS", "### END HIDDEN TESTS")
STUB = "..."


def with_solution(exercise: str, solution: str, imports: dict[str, str]) -> str:
    """An exercise with its solution in place of the dots, between marks.

    Args:
        exercise: the lesson's cell: comments, and one function that ends in dots.
        solution: the same function, filled in.
        imports: what the solution may need and the lesson has not imported, as name and statement. What the solution
            uses is imported within the function, where it cannot hide a variable of the lesson.

    Raises:
        ValueError: the two are not the same function, or the exercise does not end in dots.
    """
    head = re.fullmatch(r"(.*?)(?:\n    (?:return )?\.\.\.| \.\.\.)\n?", exercise, re.DOTALL)
    (function,) = ast.parse(solution).body
    if head is None or _signature(ast.parse(exercise).body[-1]) != _signature(function):
        raise ValueError(f"expected the lesson to have {function.name} of its solutions, ending in dots")
    kept = head.group(1).splitlines()
    body = [line for line in solution.splitlines()[function.body[0].lineno - 1 :] if line not in kept]
    needed = [text for name, text in imports.items() if name in _free_names(function)]
    indented = [f"    {line}" for line in (SOLUTION[0], *needed)]
    return "\n".join([*kept, *indented, *body, f"    {SOLUTION[1]}"])


def cut(text: str, marks: tuple[str, str], instead: list[str]) -> str:
    """Text without the lines between two marks, with the replacements in their place, indented alike."""
    lines, cutting = [], False
    for line in text.split("\n"):
        if line.strip() == marks[0]:
            cutting = True
            lines += [line.replace(marks[0], new) for new in instead]
        elif line.strip() == marks[1]:
            cutting = False
        elif not cutting:
            lines.append(line)
    return "\n".join(lines)


def imports(source: str) -> dict[str, str]:
    """The imports at the top level of a cell as name and statement, one for each name."""
    found = {}
    for node in ast.parse(source).body:
        for alias in node.names if isinstance(node, ast.Import | ast.ImportFrom) else []:
            one = ast.Import([alias]) if isinstance(node, ast.Import) else ast.ImportFrom(node.module, [alias], 0)
            found[alias.asname or alias.name] = ast.unparse(one)
    return found


def _free_names(function: ast.FunctionDef) -> set[str]:
    """The names that a function uses and does not define itself."""
    names = [node for node in ast.walk(function) if isinstance(node, ast.Name)]
    used = {node.id for node in names if isinstance(node.ctx, ast.Load)}
    own = {node.id for node in names if isinstance(node.ctx, ast.Store)}
    return used - own - {node.arg for node in ast.walk(function) if isinstance(node, ast.arg)}


def _signature(function: ast.FunctionDef) -> str:
    return f"{function.name}({ast.unparse(function.args)})"
