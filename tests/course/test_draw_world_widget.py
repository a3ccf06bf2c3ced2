"""The kernel's side of the drawing: it answers the page, refuses bad drawings in one sentence, saves and loads."""

import json
import re
import shlex
import tomllib
from pathlib import Path

import numpy as np
import pytest

import npslam_teach
from npslam_teach import datasets, np_graph
from npslam_teach.cli import parser
from npslam_teach.course.draw_your_own_world import explorer, messages
from npslam_teach.course.draw_your_own_world.explorer import DrawWorld
from npslam_teach.methods import METHODS
from npslam_teach.plotting.style import CLASS_COLORS, CLASS_MARKERS
from npslam_teach.simulate import GALLERY, fifteen_objects
from npslam_teach.simulate.hand_drawn import MAX_LENGTH

PACKAGE = Path(npslam_teach.__file__).parent
PAGE = (PACKAGE / "course" / "draw_your_own_world" / "draw_world.js").read_text(encoding="utf-8")
SHORT = {"stroke": [[2, 2], [6, 5], [10, 3]]}
# The posterior takes longer for a few observations, of which it tries every rival, than for a hundred.
LONGER = {"stroke": [[2, 2], [6, 5], [10, 3], [10, 8], [2, 8]]}


@pytest.fixture
def world():
    made = DrawWorld("empty")
    made.sent = []
    made.send = lambda content, buffers=None: made.sent.append(content)
    return made


def from_page(world, **changes):
    """What happens when the page sends a drawing."""
    world.drawing = world.drawing | changes | {"request": world.drawing["request"] + 1}
    return world.answer


def chair(x, y):
    return {"x": x, "y": y, "class": 0, "goal_x": x, "goal_y": y}


def test_what_the_page_sends_is_answered_as_the_library_answers(world):
    answer = from_page(world, **SHORT, objects=[chair(6, 6), chair(9, 5)])
    log, truth = messages.solve_drawing(messages.from_message(world.drawing)).log, world.truth
    assert [each["count"] for each in answer["rounds"]] == [each.num_objects for each in np_graph(log)]
    assert answer["request"] == world.drawing["request"] and answer["done"] is True
    assert answer["words"] == world.words
    np.testing.assert_array_equal(truth.world.object_xy, [(6, 6), (9, 5)])
    np.testing.assert_array_equal(world.log.obs_xy, log.obs_xy)


def test_an_answer_comes_at_once_and_again_when_all_is_done(world):
    answers = []
    world.observe(lambda change: answers.append(change.new), names="answer")
    from_page(world, **SHORT, objects=[chair(6, 6), chair(9, 5)])
    first, last = answers
    assert (first["done"], last["done"]) == (False, True)
    assert len(first["rounds"]) == 1 and first["rounds"][0] == last["rounds"][0]
    assert first["request"] == last["request"] and first["seconds"] <= last["seconds"]


def test_a_drawing_that_cannot_be_used_is_answered_with_a_sentence_and_the_last_world_is_kept(world):
    from_page(world, **SHORT)
    before = world.words
    answer = from_page(world, stroke=[[3, 3]])
    assert re.fullmatch(r"path: expected at least 1 m, got 0\.00 m; .* a click alone is no path", answer["error"])
    assert answer["done"] is True and "rounds" not in answer
    assert world.words == before
    assert "error" not in from_page(world, **SHORT, noise=2.0)


def test_python_is_told_by_an_exception(world):
    before = world.change(**SHORT)
    with pytest.raises(ValueError, match=rf"^path: expected at most {MAX_LENGTH:g} m"):
        world.change(stroke=[[0, 0], [12, 8]] * 8)
    assert world.words == before
    assert world.change(noise=1.0) == before, "it goes on from the last good world"


def test_an_error_of_the_program_reaches_the_student_and_is_not_swallowed(world, monkeypatch):
    def broken(log, truth, method):
        raise RuntimeError("out of order")

    monkeypatch.setattr(explorer, "solve", broken)
    with pytest.raises(RuntimeError, match="out of order"):
        from_page(world, **SHORT)
    assert world.answer["error"].startswith("The program failed") and world.answer["done"] is True


def test_choosing_a_world_by_name(world):
    words = world.choose("corridor")
    assert words == world.words == messages.words(messages.solve_drawing(GALLERY["corridor"].drawing))
    assert world.drawing["room"] == [0, 0, 36, 9]
    with pytest.raises(ValueError, match=r"^world: expected one of fifteen, empty, twins, .*, got 'nowhere'$"):
        world.choose("nowhere")


def test_another_method_answers_on_the_same_run(world):
    world.change(**LONGER, objects=[chair(6, 6), chair(9, 5)])
    words = {name: world.change(method=name) for name in messages.SHOWN_METHODS}
    log = world.log
    for name, text in words.items():
        counts = " → ".join(str(each.num_objects) for each in METHODS[name](log))
        assert text.startswith(f"Objects: {counts};")
    with pytest.raises(ValueError, match="^method: expected one of np-graph, ekf, posterior, got 'magic'$"):
        world.change(method="magic")


def test_changing_the_noise_drives_again(world):
    quiet, loud = (world.change(**SHORT, noise=noise) for noise in (0.0, 5.0))
    assert quiet != loud
    assert world.log.odometry_std[0] > 0.09


def test_the_words_stand_in_for_the_widget_where_no_kernel_runs(world):
    data, _ = world._repr_mimebundle_()
    assert data["text/plain"] == repr(world) == f"DrawWorld: {world.words}"
    assert "application/vnd.jupyter.widget-view+json" in data


# ---- files


def test_a_saved_world_is_solved_on_the_command_line_with_the_same_counts(world, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    from_page(world, **SHORT, objects=[chair(6, 6), chair(9, 5)])
    world._handle_message(world, {"do": "save", "file": "mine.npz"}, [])
    ((note,),) = [each.values() for each in world.sent]
    to, course, and_, *command = shlex.split(note.removeprefix("Saved. In a terminal: "))
    assert (to, and_) == ("cd", "&&") and (Path(course) / "npslam_teach").is_dir()
    assert command == ["python3", "-m", "npslam_teach", "solve", str(tmp_path / "mine.npz")]
    monkeypatch.chdir(course)
    assert parser.main([*command[3:], "--json"]) == 0
    solved = json.loads(capsys.readouterr().out)
    assert solved["counts_per_iteration"] == [each["count"] for each in world.answer["rounds"]]
    assert solved["metrics"]["mean_pose_error"] == pytest.approx(messages.pose_error(world.solved, -1))


def test_a_loaded_log_is_solved_as_it_is(world, tmp_path):
    """Even a log that was not drawn: the measurements of the file are used, not those of a new drive."""
    log, truth = fifteen_objects(3)
    datasets.save_log(tmp_path / "room.npz", log, truth)
    world._handle_message(world, {"do": "load", "file": str(tmp_path / "room.npz")}, [])
    assert world.sent == [{"note": f"Loaded {tmp_path / 'room.npz'}."}]
    np.testing.assert_array_equal(world.log.obs_xy, log.obs_xy)
    assert [each["count"] for each in world.answer["rounds"]] == [each.num_objects for each in np_graph(log)]
    world.change(seed=5)
    assert world.log.num_observations != log.num_observations or not np.array_equal(world.log.odometry, log.odometry)


def test_saved_and_loaded_gives_the_same_words(world, tmp_path):
    words = world.choose("false-detector")
    world.save(tmp_path / "w.npz")
    world.choose("empty")
    assert world.load(tmp_path / "w.npz") == words


@pytest.mark.parametrize(
    ("content", "note"),
    [
        ({"do": "save", "file": "mine.txt"}, r"mine\.txt: expected a file name that ends in \.npz"),
        ({"do": "save", "file": ""}, r": expected a file name that ends in \.npz"),
        ({"do": "save", "file": "no/such/folder.npz"}, r"no/such/folder\.npz: expected a folder to write into"),
        ({"do": "load", "file": "absent.npz"}, r"absent\.npz: expected a file, found nothing of that name"),
        ({"do": "load", "file": "."}, r"\.: expected the files odometry\.csv"),
    ],
)
def test_a_file_that_cannot_be_used_is_a_sentence(world, tmp_path, monkeypatch, content, note):
    monkeypatch.chdir(tmp_path)
    before = world.words
    world._handle_message(world, content, [])
    assert re.match(note, world.sent[0]["note"]) and "\n" not in world.sent[0]["note"]
    assert world.words == before


def test_a_log_without_the_truth_cannot_be_drawn(world, tmp_path):
    datasets.save_log(tmp_path / "blind.npz", world.log)
    with pytest.raises(ValueError, match=r"blind\.npz: expected the truth to draw"):
        world.load(tmp_path / "blind.npz")


def test_a_file_that_was_refused_is_not_remembered(world, tmp_path):
    """Otherwise the next drawing would be answered with the run of the file."""
    log, truth = fifteen_objects(3)
    datasets.save_log(tmp_path / "room.npz", log, truth)
    world.load(tmp_path / "room.npz")
    from_page(world, **SHORT, room=[0, 0, 12, 8], objects=[])
    assert world.log.num_observations == 0


# ---- the page and what is shipped


def test_colours_and_markers_are_those_of_every_lesson(world):
    assert tuple(world.look["colors"]) == CLASS_COLORS and tuple(world.look["markers"]) == CLASS_MARKERS
    table = PAGE[PAGE.index("const MARKERS") : PAGE.index("/** The colour and the marker")]
    for marker in CLASS_MARKERS:
        assert re.search(rf'^  "?{re.escape(marker)}"?: ', table, re.MULTILINE), f"the page cannot draw {marker}"
    assert not set(CLASS_COLORS[1:]) & set(re.findall(r"#[0-9a-f]{6}", PAGE)), "colours of classes come from Python"


def test_the_page_loads_nothing_from_elsewhere():
    assert not re.search(r"https?://|\bimport\b|\beval\b|innerHTML", PAGE)


def test_wheels_contain_the_page():
    project = tomllib.loads((PACKAGE.parent / "pyproject.toml").read_text(encoding="utf-8"))
    patterns = project["tool"]["setuptools"]["package-data"]
    for path in PACKAGE.rglob("*"):
        if path.is_file() and path.suffix not in (".py", ".pyc"):
            folder = next(each for each in path.parents if (each / "__init__.py").exists())
            package = ".".join(("npslam_teach", *folder.relative_to(PACKAGE).parts))
            inside = path.relative_to(folder)
            assert any(inside.match(pattern) for pattern in patterns.get(package, [])), path


def test_presets_can_be_driven(world):
    for name, stroke in world.paths.items():
        assert "Objects: " in world.change(**world.worlds["fifteen"]["drawing"] | {"stroke": stroke}), name
