"""The figure files: complete, described, and the same bytes every time."""

import re

import pytest

from npslam_teach import simulate
from npslam_teach.cli import parser
from npslam_teach.course import all_figures
from npslam_teach.course.fifteen_objects import figures
from npslam_teach.course.figure_file import draw_files

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    """All figures, and every fourth figure drawn a second time: two dictionaries from file name to bytes."""
    folder = tmp_path_factory.mktemp("figures")
    assert parser.main(["figures", "--out", str(folder / "first")]) == 0
    (folder / "second").mkdir()
    draw_files(all_figures.FIGURES[::4], folder / "second")
    return [{p.name: p.read_bytes() for p in (folder / n).iterdir()} for n in ("first", "second")]


def test_the_command_draws_everything_and_always_alike(drawn):
    first, second = drawn
    assert len(second) == 2 * len(all_figures.FIGURES[::4])
    assert second.items() <= first.items()
    expected = {f"{entry.name}.{suffix}" for entry in all_figures.FIGURES for suffix in ("png", "svg")}
    assert set(first) == expected | {"README.md"}


def test_the_index_describes_every_figure(drawn):
    index = drawn[0]["README.md"].decode()
    for entry in all_figures.FIGURES:
        assert f"![{entry.alt}]({entry.name}.png)" in index


def test_every_figure_of_the_deck_is_there():
    numbers = {int(re.match(r"fig(\d\d)", entry.name).group(1)) for entry in all_figures.FIGURES}
    assert numbers >= set(range(1, 20))


def test_the_committed_figures_are_those_of_the_code():
    """Names, not bytes: another version of matplotlib draws other bytes."""
    from npslam_teach.cli.commands import ROOT

    committed = {path.name for path in (ROOT / "figures").iterdir()}
    assert committed == {f"{e.name}.{suffix}" for e in all_figures.FIGURES for suffix in ("png", "svg")} | {"README.md"}


def test_alternative_texts_say_something():
    assert all(len(entry.alt) > 60 for entry in all_figures.FIGURES)
    assert len({entry.alt for entry in all_figures.FIGURES}) == len(all_figures.FIGURES)


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
