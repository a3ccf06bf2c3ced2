"""What all explorers share: the picture and the words follow the sliders, and errors are shown and raised."""

import html
import json
import re

import pytest

from npslam_teach import plotting
from npslam_teach.course import explorers, frames
from npslam_teach.course.class_votes import explorer as class_votes
from npslam_teach.course.dirichlet_process import explorer as dirichlet_process
from npslam_teach.course.drift import explorer as drift
from npslam_teach.course.why_association import explorer as why_association


def line_explorer(update=None):
    figure, ax = plotting.new_figure()
    (line,) = ax.plot([0.0, 1.0], [0.0, 0.0])
    ax.set(xlabel="x (m)", ylabel="y (m)")

    def move(slope):
        line.set_ydata([0.0, slope])
        return f'the line climbs to {slope:.1f} m & is "straight"'

    return explorers.Explorer(figure, update or move, slope=explorers.slider("slope (m)", 0.5, 0.0, 2.0, 0.1))


def test_the_picture_and_the_words_follow_the_slider():
    explorer = line_explorer()
    before = explorer.shown["src"]
    assert explorer.move(slope=1.5) == 'the line climbs to 1.5 m & is "straight"'
    assert explorer.shown["src"] != before and explorer.shown["words"] == explorer.words
    explorer.sliders["slope"].value = 0.5
    assert explorer.shown["src"] == before and explorer.shown["words"] == explorer.words


def test_the_same_value_gives_the_same_picture_every_time():
    explorer = line_explorer()
    pictures = set()
    for _ in range(3):
        explorer.move(slope=2.0)
        pictures.add(explorer.shown["src"])
        explorer.move(slope=0.0)
    assert len(pictures) == 1


def test_without_a_kernel_the_words_remain():
    explorer = line_explorer()
    assert repr(explorer) == f"Explorer: {explorer.words}"
    assert explorer._repr_mimebundle_()[0]["text/plain"].startswith("Explorer: the line climbs")


def test_an_error_is_shown_and_raised():
    def fragile(slope):
        if slope > 1:
            raise RuntimeError("too steep <for me>")
        return "a line that is not too steep"

    explorer = line_explorer(fragile)
    with pytest.raises(RuntimeError, match="too steep"):
        explorer.move(slope=1.5)
    assert "too steep <for me>" in explorer.shown["error"]
    assert explorer.move(slope=0.3) == "a line that is not too steep"
    assert "error" not in explorer.shown and explorer.shown["src"].startswith("data:image/png")


@pytest.mark.parametrize(
    ("lesson", "make", "broken", "change"),
    [
        (why_association, "explore_wrong_association", "in_words", {"to": 0}),
        (drift, "explore_noise", "in_words", {"noise": 2.0}),
        (dirichlet_process, "explore_association", "decide", {"alpha": 0.7}),
        (class_votes, "explore_triangle", "summaries_of", {"first": 1}),
    ],
)
def test_an_error_in_the_explorer_of_a_lesson_reaches_the_student(lesson, make, broken, change, monkeypatch):
    explorer = getattr(lesson, make)()
    monkeypatch.setattr(lesson, broken, lambda *a: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        explorer.move(**change)


def test_no_figure_is_left_open():
    import matplotlib.pyplot as plt

    before = plt.get_fignums()
    explorer = line_explorer()
    for k in range(20):
        explorer.move(slope=0.1 * k)
    assert plt.get_fignums() == before


def test_sliders_have_names_and_steps():
    whole, real = explorers.slider("votes", 1, 0, 9, 1), explorers.slider("alpha", 0.5, 0.0, 1.0, 0.05)
    assert (whole.description, whole.step, type(whole.value)) == ("votes", 1, int)
    assert (real.description, real.step, type(real.value)) == ("alpha", 0.05, float)


def test_a_page_that_counts_steps_from_elsewhere_gives_the_value_that_it_shows():
    received = []
    explorer = line_explorer(lambda slope: received.append(slope) or "a line")
    explorer.move(slope=0.02 + 18 * 0.01)  # 0.19999999999999998, just below a bound at 0.2
    assert received[-1] == 0.2


def test_none_is_a_choice_like_any_other():
    rule = explorers.choice("rule", {"one half": 0.5, "none": None, "one third": 1 / 3})
    assert (rule.value, rule.index, rule.description) == (0.5, 0, "rule")
    rule.value = None
    assert (rule.value, rule.index, rule.to_page()) == (None, 1, 1)
    rule.value = rule.from_page(2)  # what a page sends
    assert (rule.value, rule.index) == (1 / 3, 2)


def test_a_player_has_a_slider_with_buttons():
    position = explorers.player("rounds", 4, 700)
    assert (position.min, position.max, position.play, position.grid()) == (0, 4, 700, [0, 1, 2, 3, 4])


@pytest.mark.parametrize("wrong", [-0.1, 2.01, float("nan")])
def test_a_slider_refuses_what_lies_beyond_its_ends(wrong):
    with pytest.raises(ValueError, match=r"slope \(m\): expected a number from 0.0 to 2.0, got"):
        line_explorer().move(slope=wrong)


def test_a_choice_and_whole_numbers_refuse_what_they_do_not_have():
    with pytest.raises(ValueError, match="rule: expected one of"):
        explorers.choice("rule", {"one half": 0.5}).value = 0.6
    with pytest.raises(ValueError, match="votes: expected a whole number, got 1.5"):
        explorers.slider("votes", 1, 0, 9, 1).value = 1.5


# --- one owner of the state ------------------------------------------------------------------------------------------


def ask(explorer, number, view="a page", **values):
    """What a page sends."""
    explorer._handle_message(explorer, {"view": view, "number": number, "values": values}, [])


def test_every_message_is_answered_with_its_number_and_the_values_that_count():
    explorer = line_explorer()
    ask(explorer, 7, slope=1.2)
    assert explorer.shown["answers"] == {"view": "a page", "number": 7}
    assert explorer.shown["values"] == {"slope": 1.2} and explorer.sliders["slope"].value == 1.2
    explorer.move(slope=0.3)
    assert explorer.shown["answers"] is None and explorer.shown["values"] == {"slope": 0.3}


def test_equal_pictures_are_two_answers():
    explorer, told = line_explorer(), []
    explorer.observe(lambda change: told.append(change.new), names="shown")
    for number in (1, 2):
        ask(explorer, number, slope=1.2)
    assert [each["answers"]["number"] for each in told] == [1, 2]


def test_a_message_that_cannot_be_used_changes_nothing_and_is_answered():
    explorer = line_explorer()
    with pytest.raises(ValueError, match="expected a number"):
        ask(explorer, 3, slope=99)
    assert explorer.shown["values"] == {"slope": 0.5} and explorer.shown["answers"]["number"] == 3


def test_the_last_of_many_moves_counts():
    explorer = line_explorer()
    for k in range(20, -1, -1):
        explorer.move(slope=0.1 * k)
    explorer.sliders["slope"].value = 0.2
    assert explorer.shown["values"] == {"slope": 0.2} and "0.2 m" in explorer.shown["words"]


def test_a_value_beside_the_grid_is_kept_as_it_is():
    explorer = line_explorer(lambda slope: f"a line that climbs to {slope} m")
    assert "0.354 m" in explorer.move(slope=0.354)
    assert explorer.shown["values"] == {"slope": 0.354}


def test_the_page_may_write_to_nothing():
    """A state that comes late from a page would undo a move from code: none is ever sent."""
    script = (explorers._HERE / "explorer.js").read_text(encoding="utf-8")
    assert "model.set(" not in script and "save_changes" not in script


# --- without a kernel ------------------------------------------------------------------------------------------------


def framed_explorer():
    figure, ax = plotting.new_figure()
    (line,) = ax.plot([0.0, 1.0], [0.0, 0.0])

    def move(slope, up):
        line.set_ydata([0.0, slope if up else -slope])
        return f"a line that {'climbs' if up else 'falls'} by {slope} m </script>"

    choices = explorers.choice("up", {"up": True, "down": False})
    frames = {"slope": (0.0, 2.0), "up": (True, False)}
    return explorers.Explorer(figure, move, frames, slope=explorers.slider("slope", 0.5, 0.0, 2.0, 0.1), up=choices)


def frames_of(explorer):
    source = frames.html_of(explorer, with_frames=True)
    return json.loads(re.search(r"frozen\((.*)\), el: place", source).group(1)), source


def test_frames_are_what_the_explorer_shows():
    explorer = framed_explorer()
    data, source = frames_of(explorer)
    assert [each["grid"] for each in data["controls"] if "grid" in each] == [[0.0, 0.5, 2.0]]
    places = [(slope, up) for slope in (0.0, 0.5, 2.0) for up in (True, False)]
    assert len(data["frames"]) == 6 and len({each["src"] for each in data["frames"]}) == 5  # level twice
    for frame, (slope, up) in zip(data["frames"], places, strict=True):
        assert frame["words"] == explorer.move(slope=slope, up=up)
        assert frame["values"] == {"slope": slope, "up": int(not up)}
    assert [frame.get("first") for frame in data["frames"]] == [None, None, True, None, None, None]
    assert source.count("</script>") == 1, "words cannot end the script"


def test_frames_leave_the_explorer_where_it_was_and_come_out_the_same_again():
    explorer = framed_explorer()
    before = explorer.shown
    assert frames_of(explorer)[1] == frames_of(explorer)[1]
    assert explorer.shown == before and explorer.words == before["words"] and explorer.values()["slope"] == 0.5


def test_the_first_picture_and_the_words_stand_where_scripts_are_stripped():
    explorer = framed_explorer()
    for with_frames in (False, True):
        source = re.sub("(?s)<(script|style)>.*?</\\1>", "", frames.html_of(explorer, with_frames))
        (alt,) = re.findall('<img alt="([^"]*)"', source)
        assert html.unescape(alt) == explorer.words
        assert html.unescape(re.search("<p>(.*)</p>", source).group(1)) == explorer.words


def test_frames_are_made_only_where_they_are_asked_for(monkeypatch):
    explorer = framed_explorer()
    for setting, expected in (("", False), ("1", True)):
        monkeypatch.setenv("NPSLAM_TEACH_FRAMES", setting)
        assert ("<script>" in explorer._repr_mimebundle_()[0]["text/html"]) == expected
