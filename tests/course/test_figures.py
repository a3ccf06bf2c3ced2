"""The figure files: complete, described, and the same bytes every time."""

import io
import re

import numpy as np
import pytest
from PIL import Image, ImageSequence

from npslam_teach import simulate
from npslam_teach.cli import parser
from npslam_teach.course import all_figures
from npslam_teach.course.draw_your_own_world import film
from npslam_teach.course.fifteen_objects import figures
from npslam_teach.course.figure_file import draw_files
from npslam_teach.plotting.style import CLASS_COLORS

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """All figures, and every eighth figure drawn a second time: two dictionaries from file name to bytes."""
    folder = tmp_path_factory.mktemp("figures")
    assert parser.main(["figures", "--out", str(folder / "first")]) == 0
    (folder / "second").mkdir()
    draw_files(all_figures.FIGURES[::8], folder / "second")
    return [{p.name: p.read_bytes() for p in (folder / n).iterdir()} for n in ("first", "second")]


def every_file() -> set[str]:
    """The names of all files that the course's code draws into the folder of figures."""
    figures = {f"{entry.name}.{suffix}" for entry in all_figures.FIGURES for suffix in ("png", "svg")}
    return figures | {f"{entry.name}.gif" for entry in all_figures.FILMS} | {"README.md"}


def test_the_command_draws_everything_and_always_alike(drawn):
    first, second = drawn
    assert len(second) == 2 * len(all_figures.FIGURES[::8])
    assert second.items() <= first.items()
    assert set(first) == every_file()


def test_the_index_describes_every_figure(drawn):
    index = drawn[0]["README.md"].decode()
    for entry in all_figures.FIGURES:
        assert f"![{entry.alt}]({entry.name}.png)" in index
    for entry in all_figures.FILMS:
        assert f"![{entry.alt}]({entry.name}.gif)" in index


def test_the_film_of_the_drawing_page_ends_with_the_objects_that_are_there(drawn):
    """It is small enough for a first page, it moves, and each class has its colour at the true places at the end."""
    content = drawn[0]["draw_your_own_world.gif"]
    assert len(content) < 1_000_000
    assert film.world_film() == content, "the same bytes every time"
    frames = [frame.convert("RGB") for frame in ImageSequence.Iterator(Image.open(io.BytesIO(content)))]
    assert len(frames) > 25 and len({frame.tobytes() for frame in frames}) == len(frames)
    colors = [tuple(int(each[k : k + 2], 16) for k in (1, 3, 5)) for each in CLASS_COLORS[:5]]
    amounts = [[count_near(frame, color) for color in colors] for frame in (frames[0], frames[-1])]
    assert max(amounts[0]) == 0 and min(amounts[1]) > 100


def count_near(frame, color) -> int:
    """How many pixels have a colour, but for what a palette of 256 changes."""
    return int(np.all(np.abs(np.asarray(frame, dtype=int) - color) < 14, axis=2).sum())


def test_every_figure_of_the_deck_is_there():
    numbers = {int(re.match(r"fig(\d\d)", entry.name).group(1)) for entry in all_figures.FIGURES}
    assert numbers >= set(range(1, 20))


def test_the_committed_figures_are_those_of_the_code():
    """Names, not bytes: another version of matplotlib draws other bytes."""
    from npslam_teach.cli.commands import ROOT

    assert {path.name for path in (ROOT / "figures").iterdir()} == every_file()


def test_alternative_texts_say_something():
    entries = all_figures.FIGURES + all_figures.FILMS
    assert all(len(entry.alt) > 60 for entry in entries)
    assert len({entry.alt for entry in entries}) == len(entries)


def test_reproduce_draws_the_figures_of_its_own_run(tmp_path, capsys):
    arguments = ["reproduce", "--methods", "open-loop,frame-by-frame", "--figures", str(tmp_path / "new"), "--json"]
    assert parser.main(arguments) == 0
    names = {path.name for path in (tmp_path / "new").iterdir()}
    assert "fig17_simulation_methods.png" in names
    assert "fig16_simulation_iterations.png" not in names  # there is no NP-graph to draw


def test_numbers_in_the_alternative_texts_are_true():
    _, truth = simulate.fifteen_objects()
    assert len(truth.world.object_xy) == 15
    comparison = figures.compare(*simulate.fifteen_objects())
    assert comparison.last["np-graph"].num_objects == 15
    assert comparison.last["robust-slam"].num_objects == 5
