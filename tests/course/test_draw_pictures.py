"""The drawing page's pictures of a tremor and of alarms show what they are given, and their titles say it."""

import numpy as np
from readable import assert_readable

from npslam_teach.course.draw_your_own_world import pictures


def test_the_averaged_line_lies_in_the_middle_of_the_drawn_one():
    drawn = np.column_stack([np.linspace(0.0, 1.0, 51), np.tile([0.02, -0.02], 26)[:51]])
    smooth = np.linspace(-0.001, 0.001, 41)
    figure = pictures.tremor_figure(drawn, smooth)
    raw, averaged = figure.axes[0].lines
    np.testing.assert_array_equal(raw.get_xydata(), drawn)
    np.testing.assert_array_equal(averaged.get_xdata(), drawn[5:46, 0])
    np.testing.assert_array_equal(averaged.get_ydata(), smooth)
    assert figure.axes[0].get_title() == "a tremor of 2.0 cm becomes 0.1 cm"
    assert_readable(figure)


def test_what_raises_no_alarm_is_named():
    loud, quiet, lone = ([5.0, 2.0], [0, 0]), ([1.0, 2.5], [0, 0]), ([0.0, 1.0], [40, 50])
    alarms = {"twins": np.array(loud), "corridor": np.array(quiet), "ghosts": np.array(lone)}
    figure = pictures.alarms_figure(alarms)
    left, right = figure.axes
    assert left.get_title() == "silent: corridor"
    for line, (high, _) in zip(left.lines, alarms.values(), strict=False):
        np.testing.assert_array_equal(line.get_xdata(), high)
    for line, (_, seen_once) in zip(right.lines, alarms.values(), strict=True):
        np.testing.assert_array_equal(line.get_xdata(), seen_once)
    assert_readable(figure)
