"""The statements of a notebook that some of its cells depend on, without those that only print and draw."""

import ast


def needed_statements(sources: list[str], wanted: set[int]) -> list[str]:
    """What of each cell must run for the cells ``wanted``, which are whole; an empty text where nothing must.

    A statement is needed when it binds a name that is read later, or calls or assigns something of such a name, which
    may change it, or moves what a wanted cell has made. Nobody may change things behind the names, and a function
    finds the names of its cell's time: whoever uses this compares with a notebook that has run as a whole.
    """
    imported = {name for source in sources for name in _imported(ast.parse(source))}
    names, kept = set(), []
    for k in reversed(range(max(wanted, default=-1) + 1)):
        statements, made = [], set().union(*(_bound(ast.parse(sources[each])) for each in wanted if each < k))
        for statement in reversed(ast.parse(sources[k]).body):
            changed = _changed(statement) - imported
            if k in wanted or _bound(statement) & names or changed & (names | made):
                if isinstance(statement, ast.Assign | ast.Import | ast.ImportFrom):
                    names -= _bound(statement)
                names |= _read(statement)
                statements.append(ast.unparse(statement))
        kept.append("\n".join(reversed(statements)))
    return kept[::-1]


def _bound(node: ast.AST) -> set[str]:
    """Names that are bound: not within a function or a comprehension, whose names are its own."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        return {node.name}
    if isinstance(node, ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp | ast.Lambda):
        return set()
    own = {node.id} if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) else _imported(node)
    return own.union(*map(_bound, ast.iter_child_nodes(node)))


def _imported(node: ast.AST) -> set[str]:
    aliases = [each for each in ast.walk(node) if isinstance(each, ast.alias)]
    return {(each.asname or each.name).split(".")[0] for each in aliases}


def _changed(statement: ast.stmt) -> set[str]:
    """Names whose values a statement may change: ``a.b = 1``, ``a[0] = 1``, ``a.append(1)``."""
    found = set()
    for node in ast.walk(statement):
        if isinstance(node, ast.Attribute | ast.Subscript) and isinstance(node.ctx, ast.Store | ast.Del):
            found |= _read(node)
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute):
            found |= _read(node.func)
    return found


def _read(node: ast.AST) -> set[str]:
    """Names that are read from outside: not a function's or a comprehension's own, nor what is bound just before."""
    if isinstance(node, ast.Name):
        return {node.id} if isinstance(node.ctx, ast.Load) else set()
    if isinstance(node, ast.For):
        return _read(node.iter) | _read_by(node.body) - _stored(node.target) | _read_by(node.orelse)
    if isinstance(node, ast.With):
        own = set().union(*(_stored(each.optional_vars) for each in node.items if each.optional_vars))
        return set().union(*(_read(each.context_expr) for each in node.items)) | _read_by(node.body) - own
    found = set().union(*map(_read, ast.iter_child_nodes(node)))
    if isinstance(node, ast.FunctionDef):
        stored = {each.id for each in ast.walk(node) if isinstance(each, ast.Name) and isinstance(each.ctx, ast.Store)}
        return found - stored - {each.arg for each in ast.walk(node) if isinstance(each, ast.arg)}
    if isinstance(node, ast.ListComp | ast.SetComp | ast.DictComp | ast.GeneratorExp):
        return found - set().union(*(_stored(each.target) for each in node.generators))
    return found


def _read_by(statements: list[ast.stmt]) -> set[str]:
    """Names that a block reads before it binds them itself."""
    found, bound = set(), set()
    for statement in statements:
        found |= _read(statement) - bound
        if isinstance(statement, ast.Assign | ast.Import | ast.ImportFrom | ast.FunctionDef):
            bound |= _bound(statement)
    return found


def _stored(target: ast.AST) -> set[str]:
    return {each.id for each in ast.walk(target) if isinstance(each, ast.Name)}
