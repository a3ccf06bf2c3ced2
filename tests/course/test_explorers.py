"""What all explorers share: the picture and the words follow the sliders, and errors are shown and raised."""

import html
import re

import pytest

from npslam_teach import plotting
from npslam_teach.course import explorers
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
    before = explorer._picture.value
    assert explorer.move(slope=1.5) == 'the line climbs to 1.5 m & is "straight"'
    after = explorer._picture.value
    source = re.compile(r'src="([^"]+)"')
    assert source.search(before).group(1) != source.search(after).group(1)
    explorer.move(slope=0.5)
    assert explorer._picture.value == before


def test_the_words_are_the_alternative_text_and_the_caption():
    explorer = line_explorer()
    alt = re.search(r'alt="([^"]*)"', explorer._picture.value).group(1)
    assert html.unescape(alt) == explorer.words
    caption = re.search("<figcaption[^>]*>(.*)</figcaption>", explorer._picture.value).group(1)
    assert html.unescape(caption) == explorer.words


def test_the_same_value_gives_the_same_picture_every_time():
    explorer = line_explorer()
    pictures = set()
    for _ in range(3):
        explorer.move(slope=2.0)
        pictures.add(explorer._picture.value)
        explorer.move(slope=0.0)
    assert len(pictures) == 1


def test_without_a_kernel_the_words_remain():
    explorer = line_explorer()
    assert repr(explorer) == f"Explorer: {explorer.words}"
    assert explorer._repr_mimebundle_()["text/plain"].startswith("Explorer: the line climbs")


def test_an_error_is_shown_and_raised():
    def fragile(slope):
        if slope > 1:
            raise RuntimeError("too steep <for me>")
        return "a line that is not too steep"

    explorer = line_explorer(fragile)
    with pytest.raises(RuntimeError, match="too steep"):
        explorer.move(slope=1.5)
    assert "too steep &lt;for me&gt;" in explorer._picture.value
    assert explorer.move(slope=0.3) == "a line that is not too steep"
    assert "<img" in explorer._picture.value


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
    assert (rule.value, rule.label, rule.description) == (0.5, "one half", "rule")
    rule.value = None
    assert (rule.value, rule.index, rule.label) == (None, 1, "none")
    rule.index = 2
    assert (rule.value, rule.label) == (1 / 3, "one third")
    rule.index = 1  # what a page sends
    assert (rule.value, rule.index, rule.label) == (None, 1, "none")


def test_a_player_moves_with_its_button():
    position, button = explorers.player("rounds", 4)
    assert (position.min, position.max, button.min, button.max) == (0, 4, 0, 4)
