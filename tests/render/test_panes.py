"""Which part of the picture shows which side."""

import itertools

import pytest

from qmd_studio.render.panes import Layout, pane_at, panes_of
from qmd_studio.render.scene import Scene


class Body:
    """Stands for an actor: panes only hand actors on."""


@pytest.fixture
def scene():
    return Scene(actors=(Body(), Body()), selected=(1, 5))


@pytest.mark.parametrize("split", [-1.0, 0.0, 0.3, 1.0, 2.0])
@pytest.mark.parametrize("layout", list(Layout))
def test_panes_cover_the_picture_once(scene, layout, split):
    panes = panes_of(scene, layout, split)
    edges = [edge for pane in panes for edge in pane.shown]
    assert (edges[0], edges[-1]) == (0.0, 1.0)
    assert all(before.shown[1] == after.shown[0] for before, after in itertools.pairwise(panes))


def test_a_wipe_draws_both_over_the_whole_and_beside_each_in_its_half(scene):
    for layout, windows in ((Layout.WIPE, [(0, 1), (0, 1)]), (Layout.BESIDE, [(0, 0.5), (0.5, 1)])):
        panes = panes_of(scene, layout)
        assert [pane.window for pane in panes] == windows
        assert [pane.scene.actors for pane in panes] == [(actor,) for actor in scene.actors]
        assert [pane.first_actor for pane in panes] == [0, 1]


def test_a_marked_joint_is_marked_on_both_sides(scene):
    assert [pane.scene.selected for pane in panes_of(scene, Layout.BESIDE)] == [(0, 5), (0, 5)]


def test_one_actor_fills_the_picture_however_it_is_shared():
    alone = Scene(actors=(Body(),))
    for layout in Layout:
        (pane,) = panes_of(alone, layout)
        assert pane.scene is alone
        assert (pane.window, pane.shown) == ((0.0, 1.0), (0.0, 1.0))


def test_the_pane_under_a_place_is_the_one_that_is_seen_there(scene):
    panes = panes_of(scene, Layout.WIPE, 0.3)
    assert [pane_at(panes, x).first_actor for x in (0.0, 0.29, 0.31, 1.0)] == [0, 0, 1, 1]
