"""The measurements as text, as a table and as a figure."""

import platform
import sys
from importlib.metadata import PackageNotFoundError, version

import numpy as np
from matplotlib.figure import Figure

from npslam_teach.system import files

LABELS = {
    "ours-qdldl": "npslam_teach (qdldl)",
    "ours-superlu": "npslam_teach (SciPy alone)",
    "gtsam_python": "gtsam",
    "g2o_python": "g2o-python",
    "python_graphslam": "python-graphslam",
}
STYLES = {  # colours that people of any colour vision tell apart, and a marker each
    "ours-qdldl": ("#0072B2", "o"),
    "ours-superlu": ("#56B4E9", "s"),
    "gtsam_python": ("#D55E00", "^"),
    "g2o_python": ("#009E73", "D"),
    "python_graphslam": ("#CC79A7", "v"),
}


def milliseconds(row):
    """The median time of a row."""
    return 1e3 * float(np.median(row["seconds"]))


def ratio(row, rows, ours):
    """How many times longer than ours, the median over the rounds; None where ours was not measured."""
    of_ours = [other["seconds"] for other in rows if (other["problem"], other["solver"]) == (row["problem"], ours)]
    return float(np.median(np.divide(row["seconds"], of_ours[0]))) if of_ours else None


def problem_text(rows):
    """One problem for people, as it is measured."""
    lines = [f"{rows[0]['problem']}: {rows[0]['poses']} poses, {rows[0]['landmarks']} landmarks"]
    for row in rows:
        ratios = [ratio(row, rows, ours) for ours in ("ours-qdldl", "ours-superlu")]
        shown = ", ".join("-" if r is None else f"{r:.2f}" for r in ratios)
        lines.append(
            f"  {LABELS[row['solver']]:28} {milliseconds(row):10.1f} ms  ratios {shown:12}"
            f"  {row['iterations']:3d} iterations  chi2 {row['chi2']:.6f}"
        )
    return "\n".join(lines)


def method_text(run):
    """One size of the whole method for people."""
    counts = " -> ".join(map(str, run["counts"]))
    return (
        f"np_graph ({run['library']}), {run['rooms']} rooms: {run['seconds']:.3f} s, of it association "
        f"{run['association']:.3f}, solver {run['solver']:.3f}; {run['memory'] or float('nan'):.0f} MB; {counts}"
    )


def markdown(rows, runs, options, missing):
    """The whole table."""
    lines = [
        "# Speed of the solver and of the whole method",
        "",
        f"Written by `python3 -m npslam_teach bench`: medians of {options.repeat} rounds, in each all solvers in turn,",
        "one thread each; from plain arrays to plain arrays (build, optimise, read), Gauss-Newton until a step lowers",
        f"chi2 by less than {options.tolerance:g} of it. A ratio says how many times longer than ours it took in the",
        "same round. chi2 is evaluated on every solution with our residual, own chi2 is what the solver itself says:",
        "where the residuals differ, the minimum of one is not that of the other. `minimize` is timed, both starts",
        "included; the certificate of global optimality by itself, in the last column.",
        "",
        f"Python {platform.python_version()}, numpy {version('numpy')}, scipy {version('scipy')}, "
        f"gtsam {_version('gtsam')}, {platform.system()} {platform.machine()}.",
    ]
    lines += ["", f"Not installed and left out: {', '.join(LABELS[name] for name in missing)}."] if missing else []
    lines += ["", *_solver_table(rows), "", *_residual_list(rows), "", *_method_table(runs), ""]
    return "\n".join(lines)


def _version(package):
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed"


def _solver_table(rows):
    names = ["problem", "poses / landmarks / factors", "solver", "ms", "/ ours (qdldl)", "/ ours (SciPy)", "iterations"]
    lines = [f"| {' | '.join(names)} | chi2 | own chi2 | MB | certificate |"]
    lines += ["|---|---|---|--:|--:|--:|--:|--:|--:|--:|---|"]
    for row in rows:
        ratios = [ratio(row, rows, ours) for ours in ("ours-qdldl", "ours-superlu")]
        cells = [
            row["problem"],
            f"{row['poses']} / {row['landmarks']} / {row['factors']}",
            LABELS[row["solver"]],
            f"{milliseconds(row):.1f}",
            *("" if r is None else f"{r:.2f}" for r in ratios),
            str(row["iterations"]),
            f"{row['chi2']:.6f}",
            f"{row['own_chi2']:.6f}",
            "" if row["memory"] is None else f"{row['memory']:.0f}",
            _certificate(row),
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def _certificate(row):
    """What ours says of its minimum, and in how many milliseconds beside those of the solver."""
    if row["certificate"] is None:
        return ""
    return f"{row['certificate']}, {1e3 * float(np.median(row['certificate_seconds'])):.1f} ms"


def _residual_list(rows):
    residuals = {row["solver"]: row["residual"] for row in rows}
    text = [f"- {LABELS[solver]}: {residual}" for solver, residual in residuals.items()]
    return ["What each minimises (MB is what a solver's process grew by, ours with the certificate):", "", *text]


def _method_table(runs):
    lines = [
        "The whole method, `np_graph` with the paper's settings on houses of fifteen objects a room. It alternates",
        "until no label changes, at most five times; growth is against the next smaller house, of all seconds and of",
        "those of one alternation:",
        "",
        "| rooms | poses | observations | linear solver | s | association, s | solver, s | growth | per alternation |"
        " MB | objects |",
        "|--:|--:|--:|---|--:|--:|--:|--:|--:|--:|---|",
    ]
    for run in runs:
        smaller = [other for other in runs if other["library"] == run["library"] and other["rooms"] < run["rooms"]]
        growth = [f"x{number:.1f}" for number in _growth(smaller[-1], run)] if smaller else ["", ""]
        counts = " → ".join(map(str, run["counts"])) + f" (true: {run['objects']})"
        memory = "" if run["memory"] is None else f"{run['memory']:.0f}"
        numbers = " | ".join(f"{run[name]:.3f}" for name in ("seconds", "association", "solver"))
        start = f"{run['rooms']} | {run['poses']} | {run['observations']} | {run['library']}"
        lines.append(f"| {start} | {numbers} | {' | '.join(growth)} | {memory} | {counts} |")
    return lines


def _growth(smaller, run):
    """How many times longer a run took than a smaller one, in all and per alternation."""
    growth = run["seconds"] / smaller["seconds"]
    return growth, growth * (len(smaller["counts"]) - 1) / (len(run["counts"]) - 1)


def draw(rows, runs, path):
    """Time against the number of poses, both logarithmic: houses as lines, standard graphs as single markers."""
    figure = Figure(figsize=(8.0, 5.2), layout="constrained")
    ax = figure.subplots()
    for solver, (color, marker) in STYLES.items():
        for is_house in (True, False):
            chosen = [r for r in rows if r["solver"] == solver and r["problem"].startswith("house") == is_house]
            points = [(row["poses"], milliseconds(row) / 1e3) for row in chosen]
            if points:
                look = {"color": color, "marker": marker, "markerfacecolor": color if is_house else "none"}
                line = "-" if is_house else ""
                ax.plot(*np.transpose(points), linestyle=line, label=LABELS[solver] if is_house else None, **look)
    points = [(run["poses"], run["seconds"]) for run in runs if run["library"] == runs[0]["library"]]
    ax.plot(*np.transpose(points), "k--x", label=f"whole np_graph run ({runs[0]['library']})")
    ax.set(xscale="log", yscale="log", xlabel="poses", ylabel="time from arrays to solution (s)")
    ax.set_title("House of 1 to 100 rooms (lines), standard graphs (open markers)", fontsize=11)
    ax.grid(True, which="both", alpha=0.25)
    ax.legend(frameon=False)
    with files.atomic_write(path, "wb") as stream:
        figure.savefig(stream, format="png", dpi=150)


if __name__ == "__main__":
    sys.exit("run.py does the measuring")
