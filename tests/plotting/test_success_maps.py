"""Pictures of sweeps: counts and intervals as counted by hand, on tables that are written here."""

import itertools

import numpy as np
import pytest

from npslam_teach import plotting
from npslam_teach.evaluation import wilson_interval
from npslam_teach.experiments import sweep


def row(right, **axes):
    empty = dict.fromkeys(sweep.COLUMNS)
    point = {"scene": "fifteen_objects", "method": "np-graph", "scale": "paper", "noise": 1.0, "seed": 0}
    return empty | point | axes | {"objects": 15 if right else 16, "objects_true": 15, "ari": 1.0 if right else 0.9}


@pytest.fixture
def rows():
    """Of ten seeds, at noise k and alpha number a, the first ten - 3 k - a are right."""
    product = itertools.product(range(10), (1.0, 2.0), enumerate((None, 0.1, 0.5)))
    return [row(s < 10 - 3 * noise - a, noise=noise, alpha=alpha, seed=s) for s, noise, (a, alpha) in product]


def test_what_is_right():
    assert sweep.is_right(row(True)) and not sweep.is_right(row(False))
    for wrong in ({"objects": 14}, {"ari": 0.98}, {"ari": None}, {"error": "MemoryError"}):
        assert not sweep.is_right(row(True) | wrong)


def test_a_map_holds_the_counts_and_wilsons_interval(rows):
    figures = plotting.success_figures(rows)
    assert list(figures) == ["success_fifteen-objects_paper", "success_fifteen-objects_paper_np-graph_alpha"]
    (ax,) = figures["success_fifteen-objects_paper_np-graph_alpha"].axes
    assert [text.get_text() for text in ax.get_yticklabels()] == ["own", "0.1", "0.5"]
    assert [text.get_text() for text in ax.get_xticklabels()] == ["1", "2"]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("noise (times the paper's)", "alpha (votes)")
    expected = np.array([[7, 4], [6, 3], [5, 2]])
    np.testing.assert_allclose(ax.images[0].get_array(), expected / 10)
    low, high = wilson_interval(expected, 10)
    words = {(text.get_position()): text.get_text() for text in ax.texts}
    for (y, x), count in np.ndenumerate(expected):
        assert words[x, y] == f"{count} of 10\n{100 * low[y, x]:.0f} to {100 * high[y, x]:.0f} %"


def test_curves_of_methods_over_noise(rows):
    others = [row(seed < 5, noise=noise, method="ekf", seed=seed) for seed in range(10) for noise in (1.0, 2.0)]
    (ax,) = plotting.success_figures(rows + others)["success_fifteen-objects_paper"].axes
    found = {line.get_label(): line.get_ydata() for line in ax.lines}
    np.testing.assert_allclose(found["np-graph"], [0.7, 0.4])
    np.testing.assert_allclose(found["ekf"], [0.5, 0.5])
    low, high = wilson_interval(np.array([7, 4]), 10)
    band = ax.collections[0].get_paths()[0].vertices
    for k, noise in enumerate((1.0, 2.0)):
        heights = band[band[:, 0] == noise, 1]
        np.testing.assert_allclose([heights.min(), heights.max()], [low[k], high[k]])


def test_what_was_not_run_is_left_empty(rows):
    some = [one for one in rows if one["noise"] == 1.0 or one["alpha"] is None]
    (ax,) = plotting.success_figures(some)["success_fifteen-objects_paper_np-graph_alpha"].axes
    assert len(ax.texts) == 4 and np.isnan(np.ma.filled(ax.images[0].get_array(), np.nan)).sum() == 2


def test_two_settings_give_a_map_for_each_value_of_the_other(rows):
    more = [one | {"threshold": threshold} for one in rows for threshold in (None, 0.1)]
    figures = plotting.success_figures(more)
    assert len(figures["success_fifteen-objects_paper_np-graph_alpha"].axes) == 2
    assert len(figures["success_fifteen-objects_paper_np-graph_threshold"].axes) == 3


def test_no_rows():
    with pytest.raises(ValueError, match="rows: expected at least one"):
        plotting.success_figures([])
