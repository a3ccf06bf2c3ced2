"""The classroom around the lessons: the image of a hub, updates while notebooks are edited, and the teaching guide."""

import html
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import nbformat
import pytest
from measure_lessons import measure_lesson, sizing
from packaging.specifiers import SpecifierSet

ROOT = Path(__file__).parents[2]
NOTEBOOKS = ROOT / "notebooks"
GUIDE = NOTEBOOKS / "teaching_guide.md"
LESSONS = sorted(NOTEBOOKS.glob("[0-9][0-9]_*.ipynb"))
NOT_OURS = (".git", ".venv*", ".tmp-*", "build", "dist", "work", "__pycache__", ".*_cache", ".hypothesis", "*.egg-info")

needs_git = pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")


def requirements():
    text = (ROOT / ".binder" / "requirements.txt").read_text(encoding="utf-8")
    return [line for line in text.splitlines() if line and not line.startswith("#")]


def test_the_image_has_a_python_of_the_course():
    """Without the file repo2docker takes 3.10, on which the course does not run."""
    runtime = (ROOT / ".binder" / "runtime.txt").read_text(encoding="utf-8").strip()
    version = re.fullmatch(r"python-(3\.\d+)", runtime).group(1)
    allowed = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["requires-python"]
    assert SpecifierSet(allowed).contains(version)
    assert f"names the Python, {version}, with" in " ".join(GUIDE.read_text(encoding="utf-8").split())
    assert version in ("3.11", "3.12", "3.13"), "for which environment.txt is meant"


def test_the_image_installs_the_environment_and_the_package():
    included = [line.split()[1] for line in requirements() if line.startswith("-r ")]
    assert [(ROOT / ".binder" / name).resolve() for name in included] == [ROOT / "environment.txt"]
    assert "-e ." in requirements(), "kernels start in the notebook's folder and must find the package from there"
    assert not (ROOT / "binder").exists() and not (ROOT / "postBuild").exists(), "repo2docker reads one folder alone"


def test_repo2docker_honours_both_files():
    """The image that it would build; building needs a Docker engine."""
    pytest.importorskip("repo2docker", reason="not installed: pip install -r tests/requirements-classroom.txt")
    runtime = (ROOT / ".binder" / "runtime.txt").read_text(encoding="utf-8").strip().removeprefix("python-")
    options = ["--no-build", "--debug", "--user-id=1000", "--user-name=student", str(ROOT)]
    done = subprocess.run([sys.executable, "-m", "repo2docker", *options], capture_output=True, text=True)
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert f"Building conda environment for python={runtime}\n" in said
    copied, installs = said.index(" src/ ${REPO_DIR}/"), said.index('-r ".binder/requirements.txt"')
    assert copied < installs, "environment.txt is there before pip reads it"


@pytest.fixture
def upstream(tmp_path):
    """The course as a repository of one commit, made of the files as they are now."""
    folder = tmp_path / "upstream"
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*NOT_OURS))
    git(folder, "init", "--quiet", "--initial-branch=main")
    commit(folder)
    return folder


def git(folder, *arguments, check=True):
    """The output of git, independent of the user's settings."""
    who = {f"GIT_{role}_{key}": "a@b.c" for role in ("AUTHOR", "COMMITTER") for key in ("NAME", "EMAIL")}
    own = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}
    command = ["git", "-c", "core.autocrlf=false", *arguments]
    done = subprocess.run(command, cwd=folder, env=os.environ | who | own, capture_output=True, text=True)
    assert done.returncode == 0 or not check, done.stderr
    return done.stdout


def commit(folder):
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", "As it is")


def changed(folder):
    return git(folder, "status", "--porcelain", "--untracked-files=all").splitlines()


def run_in_place(folder, lesson):
    """Run a lesson as students do, in the copy of the course that it is part of, and save it."""
    options = ["--to=notebook", "--execute", "--inplace", str(lesson)]
    environment = os.environ | {"PYTHONPATH": str(folder)}
    subprocess.run([sys.executable, "-m", "nbconvert", *options], cwd=folder, env=environment, check=True)


def without_results(path):
    """A notebook without outputs and execution counts."""
    notebook = nbformat.read(path, as_version=4)
    return [(cell.id, cell.cell_type, cell.source, cell.metadata.get("tags", [])) for cell in notebook.cells]


@pytest.mark.slow
@needs_git
def test_running_a_lesson_changes_nothing_but_its_outputs(upstream):
    lesson = upstream / "notebooks" / "02_drift.ipynb"
    written = without_results(lesson)
    run_in_place(upstream, lesson)
    assert changed(upstream) == [" M notebooks/02_drift.ipynb"]
    assert without_results(lesson) == written


@needs_git
def test_students_work_survives_an_update(upstream, tmp_path):
    """The commands of the guide, with an edited lesson in the way and work in the student's own folder."""
    git(tmp_path, "clone", "--quiet", str(upstream), "mine")
    mine, name = tmp_path / "mine", "notebooks/02_drift.ipynb"
    arguments = ["assignment", "02", "--student", "--out", "work"]
    command = [sys.executable, "-m", "npslam_teach", *arguments]
    subprocess.run(command, cwd=mine, env=os.environ | {"PYTHONPATH": str(mine)}, check=True, capture_output=True)
    (work,) = (mine / "work").rglob("*.ipynb")
    assert changed(mine) == [], "git does not see the student's folder"
    work.write_text(work.read_text(encoding="utf-8").replace("    ...", "    my answer"), encoding="utf-8")
    kept = work.read_bytes()
    for folder, words in ((upstream, "a better question"), (mine, "a note of mine")):
        cells = json.loads((folder / name).read_text(encoding="utf-8"))
        cells["cells"][0]["source"] = [words]
        (folder / name).write_text(json.dumps(cells), encoding="utf-8")
    commit(upstream)
    git(mine, "pull", "--ff-only", check=False)
    assert "a note of mine" in (mine / name).read_text(encoding="utf-8"), "git alone refuses, and changes nothing"
    section = GUIDE.read_text(encoding="utf-8").split("## A new version")[1].split("\n## ")[0]
    commands = re.findall(r"^git (.+)$", section, re.MULTILINE)
    assert len(commands) == 2
    for line in commands:
        git(mine, *line.split())
    assert "a better question" in (mine / name).read_text(encoding="utf-8")
    assert work.read_bytes() == kept and changed(mine) == []


@pytest.fixture(scope="module")
def guide():
    return GUIDE.read_text(encoding="utf-8")


def shown_by(lesson):
    """All words of a lesson and its solutions: what was written and what was printed."""
    (solutions,) = [*NOTEBOOKS.glob(f"solutions/{lesson.stem[:2]}_*.ipynb")] or [lesson]
    texts = []
    for path in (lesson, solutions):
        for cell in nbformat.read(path, as_version=4).cells:
            texts.append(cell.source)
            for output in cell.get("outputs", []):
                folded = re.findall(r"<pre>(.*?)</pre>", output.get("data", {}).get("text/html", ""), re.DOTALL)
                texts += [output.get("text", ""), *map(html.unescape, folded)]
    return "\n".join(texts)


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda path: path.stem)
def test_the_guides_answers_are_the_lessons_own(guide, lesson):
    """Every number of two digits or more in the answers to a lesson stands in that lesson or was printed by it."""
    number = lesson.stem[:2]
    section = re.split(r"\n### ", guide.split(f"\n### {number} ")[1])[0].split("\n## ")[0]
    text = shown_by(lesson)
    assert f"({lesson.name})" in section
    numbers = re.findall(r"(?<![\w.])\d+\.\d+|(?<![\w.])\d{2,}(?![\w.]*\.ipynb)", re.sub(r"\]\([^)]+\)", "]", section))
    assert len(numbers) >= 3
    for each in set(numbers) - {number}:
        assert re.search(rf"(?<![\d.]){re.escape(each)}(?!\d)", text), each
    if number == "00":
        return
    assert f"solutions/{number}_solutions.ipynb" in section
    tags = [tag for cell in nbformat.read(lesson, as_version=4).cells for tag in cell.metadata.get("tags", [])]
    answered = re.findall(r"^(\d)\. ", section.split("**Exercises**")[1], re.MULTILINE)
    assert answered == [tag.removeprefix("exercise-") for tag in tags if tag.startswith("exercise-")]


def test_the_guide_answers_every_prediction(guide):
    """A lesson asks in bold; the guide has a line for each."""
    for lesson in LESSONS:
        section = guide.split(f"\n### {lesson.stem[:2]} ")[1].split("\n### ")[0]
        answers = section.split("**Predictions**")[1].split("**Exercises**")[0].count("\n- ")
        text = "\n".join(cell.source for cell in nbformat.read(lesson, as_version=4).cells)
        # "- **Predict:**" is a half of a filter, not a question.
        assert answers == len(re.findall(r"(?<!- )\*\*Predict", text)), lesson.stem


def test_links_of_the_guide_lead_somewhere(guide):
    for target in re.findall(r"\]\(([^)#]+)[^)]*\)", guide):
        assert target.startswith("https://") or (NOTEBOOKS / target).exists(), target


def test_the_guides_table_is_the_scripts(guide):
    """One row for each lesson, in the form that the script prints; the numbers are those of its machine."""
    rows = re.findall(r"^\| (\d\d_\w+) \| \d+ \| \d+ \| \d+ \| \d+ \|$", guide, re.MULTILINE)
    assert rows == [path.stem for path in LESSONS]
    assert "python tests/measure_lessons.py" in guide


def test_the_guides_plan_counts_the_lessons_own_minutes(guide):
    total = 0
    for path in LESSONS:
        text = path.read_text(encoding="utf-8")
        total += int(re.search(r"\*\*Time:\*\* (\d+)\sminutes", text).group(1))
    assert f"{total} minutes" in guide


def test_a_lesson_can_be_measured():
    row = measure_lesson(NOTEBOOKS / "solutions" / "07_solutions.ipynb")
    assert row["lesson"] == "07_solutions"
    assert 0 < row["cpu"] < 60 and 30 < row["end"] <= row["peak"] < 2000
    assert not row["pss"] > row["end"]  # NaN where the system does not say


def test_sizing_adds_up():
    rows = [{"peak": 300, "cpu": 5, "pss": 150}, {"peak": 200, "cpu": 16, "pss": 120}]
    told = sizing(rows, lab=(100, 50), students=200, cores=32)
    assert told.startswith(
        "200 students, one lesson open each: at most 80 GB where nothing is shared, about 40 GB where"
    )
    assert "3200 CPU seconds, 100 s on 32 cores" in told
