"""The architecture, enforced by reading the imports: who may know whom, and what it costs to import the package."""

import ast
import functools
import subprocess
import sys
from pathlib import Path

import pytest

import npslam_teach

PACKAGE = Path(npslam_teach.__file__).parent
SOURCES = {".".join(path.relative_to(PACKAGE).with_suffix("").parts): path for path in sorted(PACKAGE.rglob("*.py"))}
# Whoever stands further right may know those further left; groups that stand together do not know each other.
LAW = (
    "system se2 validation camera < factors < types < pose_graph association datasets simulate < methods evaluation < "
)
LAW += "experiments < plotting < course < cli < __main__"
RANK = {place: rank for rank, places in enumerate(LAW.split(" < ")) for place in places.split()}
EXTRA = {("simulate", "camera"), ("cli", "publishing"), ("publishing", "system")}
ESTIMATORS = ("pose_graph", "association", "methods")


@functools.cache
def tree_of(name):
    """The syntax of a file, which many tests look at."""
    return ast.parse(SOURCES[name].read_text(encoding="utf-8"))


@functools.cache
def nodes_of(name):
    """All nodes of it."""
    return list(ast.walk(tree_of(name)))


@functools.cache
def imported(name, top_level_only=False):
    """Modules that a file imports: our own by their name inside the package, others by their first word."""
    nodes = tree_of(name).body if top_level_only else nodes_of(name)
    found = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{name}: relative import; the package uses absolute ones throughout"
            for alias in node.names:
                submodule = f"{node.module}.{alias.name}".removeprefix("npslam_teach.")
                is_module = submodule in SOURCES or f"{submodule}.__init__" in SOURCES
                found.add(f"npslam_teach.{submodule}" if is_module else node.module)
    ours = {module.removeprefix("npslam_teach.") for module in found if module.startswith("npslam_teach.")}
    others = {module.split(".")[0] for module in found if not module.startswith("npslam_teach")}
    return {_with_init(module) for module in ours} & set(SOURCES), others


def _with_init(module):
    return module if module in SOURCES else f"{module}.__init__"


def test_the_graph_of_imports_is_acyclic():
    edges = {name: imported(name)[0] - {name} for name in SOURCES if name not in ("__init__", "__main__")}
    done, path = set(), []

    def visit(name):
        assert name not in path, f"a circle of imports: {' -> '.join([*path[path.index(name) :], name])}"
        if name in done:
            return
        path.append(name)
        for other in sorted(edges.get(name, ())):
            visit(other)
        path.pop()
        done.add(name)

    for name in sorted(edges):
        visit(name)


def place_of(name):
    return name.split(".")[0]


def test_imports_point_to_the_left():
    """The architecture in one line: see LAW."""
    for name in sorted(set(SOURCES) - {"__init__"}):
        for other in imported(name)[0]:
            place, its_place = place_of(name), place_of(other)
            if its_place not in (place, "__init__") and (place, its_place) not in EXTRA:
                assert RANK[its_place] < RANK[place], f"{name} imports {other}"


def test_matplotlib_and_widgets_stay_where_they_belong():
    for name in SOURCES:
        _, others = imported(name)
        if place_of(name) not in ("plotting", "course"):
            assert "matplotlib" not in others, name
        if name != "course.explorers":
            assert "ipywidgets" not in others, name
        if place_of(name) != "course":
            assert not others & {"anywidget", "traitlets"}, name


def test_scipy_is_imported_only_where_it_is_used():
    """`import scipy.sparse.linalg` costs a quarter of a second; whoever only reads a log must not pay it."""
    for name in SOURCES:
        _, others = imported(name, top_level_only=True)
        assert not others & {"scipy", "tqdm", "pooch"}, name


def test_no_estimator_knows_the_truth():
    """That none knows the simulator or the evaluation is part of the LAW."""
    for name in (name for name in SOURCES if place_of(name) in ESTIMATORS):
        nodes = nodes_of(name)
        assert "GroundTruth" not in {node.id for node in nodes if isinstance(node, ast.Name)}, name
        arguments = {argument.arg for node in nodes if isinstance(node, ast.arguments) for argument in node.args}
        told = {argument for argument in arguments if "truth" in argument or argument.startswith("true_")}
        assert not told, f"{name}: {told}"


def test_the_door_of_every_folder_is_a_table_of_contents():
    """One docstring, imports of public names, and nothing that has to be computed."""
    for name in (name for name in SOURCES if name.endswith(".__init__")):
        docstring, *rest = tree_of(name).body
        assert _is_docstring(docstring), name
        assert all(isinstance(node, ast.ImportFrom | ast.Assign) for node in rest), name


def test_nobody_unpickles_or_evaluates():
    for name in SOURCES:
        for node in nodes_of(name):
            if isinstance(node, ast.keyword) and node.arg == "allow_pickle":
                assert isinstance(node.value, ast.Constant) and node.value.value is False, name
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in ("eval", "exec"), name


def test_modules_and_functions_keep_their_promise_of_size():
    """250 lines a module, 25 lines of body a function."""
    longer = {"publishing.book_page.page": 30}  # one template of HTML
    for name, path in SOURCES.items():
        assert len(path.read_text(encoding="utf-8").splitlines()) <= 250, name
        for node in nodes_of(name):
            if isinstance(node, ast.FunctionDef):
                body = [entry for entry in node.body if not _is_docstring(entry)]
                lines = body[-1].end_lineno - body[0].lineno + 1 if body else 0
                most = 40 if name.endswith(("checks", "check_inputs")) else 25  # these may hold tables
                assert lines <= longer.get(f"{name}.{node.name}", most), f"{name}.{node.name} has {lines} lines"


def _is_docstring(node):
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def run_python(code):
    """What a fresh interpreter prints."""
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout


def test_importing_the_package_loads_nothing_heavy():
    """Its cost is the cost of what it drags along; names are loaded on first use."""
    code = "import sys, npslam_teach; print(*(set(sys.modules) & {'numpy', 'scipy', 'matplotlib', 'ipywidgets'}))"
    assert run_python(code).strip() == ""


def test_a_log_is_read_and_simulated_without_scipy_or_matplotlib():
    code = (
        "import sys, npslam_teach as nt; nt.fifteen_objects(); nt.datasets.load_log;"
        "print(*(set(sys.modules) & {'scipy', 'matplotlib', 'ipywidgets'}))"
    )
    assert run_python(code).strip() == ""


def test_every_public_name_is_there():
    for name in npslam_teach.__all__:
        assert getattr(npslam_teach, name) is not None
        assert name in dir(npslam_teach)
    with pytest.raises(AttributeError, match="no_such_thing"):
        npslam_teach.no_such_thing  # noqa: B018


def test_modules_are_reachable_from_the_package():
    assert npslam_teach.evaluation.evaluate is npslam_teach.evaluate
    assert npslam_teach.se2.wrap


def test_files_of_tests_have_names_of_their_own():
    """pytest imports them by these; two of one name are refused only when both are collected."""
    names = [path.name for path in Path(__file__).parent.rglob("test_*.py")]
    assert sorted(set(names)) == sorted(names)
