"""The colour map tells more from less by lightness alone, so that every eye can read it."""

import numpy as np

from qmd_studio.render.heat import heat_colours, linear


def test_lightness_rises_all_the_way():
    light = linear(heat_colours(np.linspace(0, 1, 64))) @ (0.2126, 0.7152, 0.0722)
    assert (np.diff(light) > 0).all()
    assert light[-1] > 20 * light[0]


def test_values_outside_take_the_ends_colours():
    np.testing.assert_array_equal(heat_colours([-3.0, 9.0]), heat_colours([0.0, 1.0]))


def test_colours_are_colours():
    colours = heat_colours(np.linspace(0, 1, 33))
    assert colours.min() >= 0
    assert colours.max() <= 1
