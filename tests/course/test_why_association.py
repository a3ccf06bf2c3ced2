"""Lesson 01: its figures contain what they should, its explorer tells the truth, its checks know the usual mistakes."""

import itertools
import math
import re

import numpy as np
import pytest
from exercises import assert_names_the_mistake, checks_and_solutions
from matplotlib.patches import Rectangle
from partitions import partitions
from readable import assert_readable
from rings import rings_of

from npslam_teach import plotting, simulate
from npslam_teach.course.why_association import checks, figures, pictures
from npslam_teach.course.why_association import explorer as why_association_explorer
from npslam_teach.evaluation import chi2_per_dof
from npslam_teach.methods.open_loop import join_earlier_observations
from npslam_teach.pose_graph import chi2, fit

# --- exercises -------------------------------------------------------------------------------------------------------

CHECKS, solution = checks_and_solutions("01_why_association")


def nearest(xy, obs_class, reach):
    """The front end through the library's own association: a threshold instead of a reach."""
    kernel_std = math.sqrt(1 / 8)  # the threshold as the library works it out, so that a tie is one
    return join_earlier_observations(xy, obs_class, np.exp(-(reach**2) / (2 * kernel_std**2)), kernel_std)


def first_within_reach(xy, obs_class, reach):
    labels = []
    for k in range(len(xy)):
        near = [j for j in range(k) if obs_class[j] == obs_class[k] and math.dist(xy[j], xy[k]) < reach]
        labels.append(labels[near[0]] if near else max(labels, default=-1) + 1)
    return labels


def degrees(m, k):
    return 2 * m - 2 * k


WRONG = [
    (1, lambda p: (p.argmax(axis=1), p.max(axis=1)), "what is kept"),
    (1, lambda p: (1 - p.max(axis=1), p.argmax(axis=1)), "swapped"),
    (1, lambda p: (p.argsort(axis=1)[:, 1], 1 - p.max(axis=1)), "these are not the classes"),
    (1, lambda p: (p.argmax(axis=0), 1 - p.max(axis=0)), "axis 1"),
    (1, lambda p: (p.argmax(axis=1) + 1, 1 - p.max(axis=1)), "from 0"),
    (1, lambda p: (p.argmin(axis=1), 1 - p.max(axis=1)), "least likely"),
    (1, lambda p: (p.argmax(axis=1), np.sort(p, axis=1)[:, -2]), "runner-up"),
    (1, lambda p: p.argmax(axis=1), "return two things"),
    (2, lambda xy, c, r: nearest(xy, np.zeros_like(c), r), "different classes"),
    (2, lambda xy, c, r: nearest(xy, c, 100.0 if len(xy) else r), "everything joins"),
    (2, lambda xy, c, r: np.arange(len(xy)), "nothing joins"),
    (2, first_within_reach, "not the nearest"),
    (2, lambda xy, c, r: checks._nearest_index(xy, c, r), "place in the list"),
    (2, lambda xy, c, r: checks.join(xy, c, r, firsts=True), "first of an object only"),
    (2, lambda xy, c, r: c, "everything joins"),
    (2, lambda xy, c, r: np.arange(len(xy)) // 2, "objects, not"),
    (3, lambda n: 2 ** (n - 1), "where a row can be cut"),
    (3, lambda n: 2**n, "subsets"),
    (3, math.factorial, "orders"),
    (3, lambda n: math.comb(2 * n, n) // (n + 1), "cross"),
    (3, lambda n: checks.bell_numbers(n + 1)[n + 1], "one off"),
    (3, lambda n: n**2, "that many sightings can be grouped"),
    (4, lambda c, m, k: m > k and c <= degrees(m, k) + 3 * math.sqrt(2 * degrees(m, k)), "wrong way round"),
    (4, lambda c, m, k: m > k and c > degrees(m, k), "every second right result"),
    (4, lambda c, m, k: m > k and c / degrees(m, k) > 1, "every second right result"),
    (4, lambda c, m, k: m > k and c > (m - k) + 3 * math.sqrt(2 * (m - k)), "two numbers"),
    (4, lambda c, m, k: m > k and c > 2 * m + 3 * math.sqrt(4 * m), "unknowns too"),
    (4, lambda c, m, k: m > k and c > 5 * degrees(m, k), "another chi2"),
    (4, lambda c, m, k: (c - degrees(m, k)) / math.sqrt(2 * degrees(m, k)) > 3, "0 degrees of freedom"),
    (4, lambda c, m, k: c > degrees(m, k) + 3 * math.sqrt(2 * degrees(m, k)), "must not ring, or stop"),
    (4, lambda c, m, k: m > k and c > degrees(m, k) + 6 * degrees(m, k), "root"),
    (4, lambda c, m, k: False, "never rings"),
]


@pytest.mark.parametrize(("number", "mistake", "message"), WRONG)
def test_usual_mistakes_are_named(number, mistake, message):
    assert_names_the_mistake(CHECKS[number], mistake, message)


def test_labels_may_have_any_names():
    assert checks.check_front_end(lambda *a: 100 - 7 * nearest(*a)).passed


def test_bell_numbers_count_partitions():
    assert checks.bell_numbers(7) == [1] + [len(list(partitions(n))) for n in range(1, 8)]
    assert checks.bell_numbers(25)[25] == 4638590332229999353  # OEIS A000110


# --- figures ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("entry", figures.FIGURES, ids=lambda entry: entry.name)
def test_figures_are_readable_and_have_units(entry):
    figure = entry.draw()
    figure.draw_without_rendering()
    assert_readable(figure)
    for ax in figure.axes:
        if ax.axison:
            labels = [label for label in (ax.get_xlabel(), ax.get_ylabel()) if label]
            assert labels and all(re.search(r"\(.+\)$", label) for label in labels)


def test_the_timeline_has_every_event_at_its_year():
    (ax,) = figures.timeline_figure().axes
    years = [line.get_xdata()[0] for line in ax.lines]
    assert years == [year for year, _, _ in pictures.EVENTS] == sorted(years)
    for name in "Moravec Galindo Vasudevan PTAM g2o iSAM Cadena R-CNN Mu Bowman".split():
        assert any(name in text.get_text() for text in ax.texts), name
    assert len(pictures.EVENTS) == 12


def test_the_detector_shows_the_argmax_of_each_row():
    image, bars = figures.detector_figure().axes
    boxes = [patch for patch in image.patches if isinstance(patch, Rectangle) and not patch.get_fill()]
    assert [box.get_bbox().bounds for box in boxes] == [tuple(map(float, box)) for box in pictures.BOXES]
    assert [t.get_text() for t in image.texts] == ["1: chair 0.86", "2: screen 0.88", "3: cup 0.47"]
    heights = np.reshape([patch.get_height() for patch in bars.patches], (3, 3)).T
    np.testing.assert_allclose(heights, figures.POSTERIORS)
    np.testing.assert_allclose(figures.POSTERIORS.sum(axis=1), 1.0)
    assert sum(text.get_fontweight() == "bold" for text in bars.texts) == 3


def test_only_semantic_factors_tie_one_sighting_to_two_chairs():
    left, right = figures.semantic_figure().axes
    orange = [
        [line for line in ax.lines if line.get_color() == plotting.class_style(1)[0] and len(line.get_xdata()) == 2]
        for ax in (left, right)
    ]
    assert [len(lines) for lines in orange] == [1, 2]
    assert {text.get_text() for text in right.texts} >= {"0.3", "0.7"}
    assert left.get_aspect() == right.get_aspect() == 1.0


def test_the_split_has_one_arrow_back_and_only_where_it_takes_turns():
    (ax,) = figures.split_figure().axes
    arrows = [text for text in ax.texts if getattr(text, "arrow_patch", None)]
    backward = [arrow for arrow in arrows if arrow.xy[0] < arrow.xyann[0]]
    assert len(arrows) == 7 and len(backward) == 1
    assert backward[0].xy[1] < 2  # in the lower row


# --- the explorer ----------------------------------------------------------------------------------------------------

room = why_association_explorer.ROOM
ALL = list(itertools.product(range(8), range(len(why_association_explorer.OBJECTS))))


@pytest.fixture(scope="module")
def explorer():
    return why_association_explorer.explore_wrong_association()


@pytest.mark.parametrize(("sighting", "to"), ALL)
def test_the_explorer_shows_what_the_solver_says(explorer, sighting, to):
    words, scene = explorer._update(sighting=sighting, to=to)  # what the drop-downs call
    log, truth = simulate.toy_objects()
    given = why_association_explorer.BELONGS_TO.copy()
    given[sighting] = to
    _, labels = np.unique(given, return_inverse=True)
    graph = fit(log, labels, truth.poses)  # from another start
    assert f"{chi2_per_dof(graph):.2f} per degree of freedom" in words
    belongs = to == why_association_explorer.BELONGS_TO[sighting]
    assert (f"chi2 is {chi2(graph):.1f}," if belongs else f"chi2 goes from 1.8 to {chi2(graph):.1f},") in words
    assert chi2_per_dof(graph) < 0.5 if belongs or to == 5 else chi2_per_dof(graph) > 2.5  # a split is silent
    path = np.array([each.split(",") for each in scene.parts["path"][1]["points"].split()], dtype=float)
    np.testing.assert_allclose(path, room.to_page(graph.poses[:, :2]), atol=0.05)
    assert ("pull" in scene.parts) == (not belongs)
    if not belongs:
        end = scene.parts["pull"][1]["points"].split()[1].split(",")
        np.testing.assert_allclose(np.array(end, float), room.to_page(graph.landmarks[labels[sighting]])[0], atol=0.05)
    numbers = [scene.parts[f"name {j}"][2].split(": ")[1] for j in range(len(graph.landmarks))]
    assert numbers == ["+".join(str(k + 1) for k in np.flatnonzero(labels == j)) for j in range(len(graph.landmarks))]
    (x, y), (low, high) = (graph.poses[:, 0], graph.poses[:, 1]), zip(room.x, room.y, strict=True)
    assert (x.min() > low[0]) and (x.max() < high[0]) and (y.min() > low[1]) and (y.max() < high[1])
    assert (graph.landmarks > low).all() and (graph.landmarks < high).all()
    assert scene.parts["ratio title"][2] == f"chi2 per dof: {chi2_per_dof(graph):.1f}"


def boxes_of(scene):
    """Of each name on the map: its middle and its size, px, at 8.6 px a letter."""
    boxes = []
    for name, (_, named, *text) in scene.parts.items():
        if name.startswith("name "):
            size = np.array([8.6 * len(text[0]), 16.0])
            shift = size[0] / 2 * (-1 if "end" in named["class"] else 0 if "middle" in named["class"] else 1)
            boxes.append((np.array([float(named["x"]) + shift, float(named["y"]) - 5.0]), size))
    return boxes


@pytest.mark.parametrize(("sighting", "to"), ALL)
def test_no_name_on_the_map_covers_another_or_a_ring(explorer, sighting, to):
    scene = explorer._update(sighting=sighting, to=to)[1]
    boxes = boxes_of(scene)
    taken = [*boxes, *((ring.xy, np.array([16.0, 16.0])) for ring in rings_of(scene).values())]
    for k, (middle, size) in enumerate(boxes):
        for other, its_size in taken[k + 1 :]:
            assert (np.abs(middle - other) > (size + its_size) / 2).any()
        assert (middle > size / 2).all() and (middle < np.array(why_association_explorer.SIZE) - size / 2).all()


@pytest.mark.parametrize(("sighting", "to"), [(4, 1), (4, 0), (6, 5), (7, 2)])
def test_every_ring_leads_to_every_object_and_to_a_new_one(explorer, sighting, to):
    scene = explorer._update(sighting=sighting, to=to)[1]
    belongs, num_objects = why_association_explorer.BELONGS_TO, len(why_association_explorer.OBJECTS)
    log, _ = simulate.toy_objects()
    outcome = why_association_explorer.reassign(log, sighting, to)
    rings = rings_of(scene)
    assert len(rings) == log.num_observations
    for k, ring in enumerate(rings.values()):
        assert ring.moves == ("sighting", "to") and not ring.follows
        led_to = {int(float(j)): (x, y) for x, y, m, j in ring.stops if int(float(m)) == k}
        present = set(outcome.objects.tolist()) - {num_objects - 1}
        new = int(belongs[k]) if belongs[k] not in present else num_objects - 1
        assert set(led_to) == present | {new} and len(led_to) == len(ring.stops)
        for thing, xy in zip(outcome.objects, outcome.graph.landmarks, strict=True):
            if thing < num_objects - 1:
                np.testing.assert_allclose(led_to[int(thing)], room.to_page(xy)[0], atol=0.06)
        np.testing.assert_allclose(led_to[new], room.to_page(why_association_explorer.NEW)[0], atol=0.06)


def test_the_drop_downs_move_the_picture():
    explorer = why_association_explorer.explore_wrong_association()
    before = explorer.shown["scene"]
    assert "Obj_5 belongs to chair B" in explorer.words
    assert "Obj_5 of chair B is given to chair A" in explorer.move(to=0)
    assert explorer.shown["scene"] != before
    explorer.move(to=1)
    assert explorer.shown["scene"] == before
