"""The viewport as a user meets it: what it draws, how the mouse and keys move it, and what a click picks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from OpenGL import GL
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtGui import QImage, QMouseEvent, QWheelEvent
from PySide6.QtWidgets import QApplication, QWidget

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.motion.kinematics import rest_values, world_from_joint
from qmd_studio.motion.skeleton import EndSite, Joint, Skeleton, SkeletonKind
from qmd_studio.render.camera import PRESETS, Camera
from qmd_studio.render.gl import GraphicsError
from qmd_studio.render.overlay import TRIAD_INSET, TRIAD_RADIUS
from qmd_studio.render.quality import LADDER
from qmd_studio.render.scene import Actor, Look
from qmd_studio.ui.viewport import Viewport


def figure() -> Skeleton:
    joints = (
        Joint("Hips", -1, (0.0, 0.95, 0.0)),
        Joint("Spine", 0, (0.0, 0.12, 0.0)),
        Joint("Head", 1, (0.0, 0.50, 0.0)),
        Joint("LeftArm", 1, (0.2, 0.38, 0.0)),
        Joint("LeftHand", 3, (0.5, 0.0, 0.0)),
        Joint("RightArm", 1, (-0.2, 0.38, 0.0)),
        Joint("RightHand", 5, (-0.5, 0.0, 0.0)),
        Joint("LeftUpLeg", 0, (0.1, -0.05, 0.0)),
        Joint("LeftFoot", 7, (0.0, -0.82, 0.0)),
        Joint("RightUpLeg", 0, (-0.1, -0.05, 0.0)),
        Joint("RightFoot", 9, (0.0, -0.82, 0.0)),
    )
    sites = (EndSite("top", 2, (0.0, 0.2, 0.0)),)
    return Skeleton("figure", SkeletonKind.BVH, joints, sites, (), tuple(range(len(joints))))


def actor(**options) -> Actor:
    skeleton = figure()
    return Actor(bone_body(skeleton), world_from_joint(skeleton, rest_values(skeleton)[None])[0], **options)


def pixels(viewport: Viewport) -> np.ndarray:
    image = viewport.grabFramebuffer().convertToFormat(QImage.Format.Format_RGB888)
    data = np.frombuffer(image.constBits(), np.uint8).reshape(image.height(), image.bytesPerLine())
    return data[:, : 3 * image.width()].reshape(image.height(), image.width(), 3).astype(int)


def place_of(viewport: Viewport, point) -> tuple[float, float]:
    """Where a place of the world is in the widget."""
    x, y = viewport.camera.project(point, viewport.width() / viewport.height())[0]
    return (x + 1) / 2 * viewport.width(), (1 - y) / 2 * viewport.height()


def drag(viewport, start, end, button, modifiers=Qt.KeyboardModifier.NoModifier):
    """Press, move and release as a user does."""
    none = Qt.MouseButton.NoButton
    for kind, at, changed, held in (
        (QEvent.Type.MouseButtonPress, start, button, button),
        (QEvent.Type.MouseMove, (start + end) / 2, none, button),
        (QEvent.Type.MouseMove, end, none, button),
        (QEvent.Type.MouseButtonRelease, end, button, none),
    ):
        event = QMouseEvent(kind, at, viewport.mapToGlobal(at), changed, held, modifiers)
        QApplication.sendEvent(viewport, event)


@pytest.fixture
def viewport(qtbot):
    view = Viewport()
    view.animated = False
    view.fixed_quality = LADDER[3]
    view.resize(320, 240)
    qtbot.addWidget(view)
    view.show()
    qtbot.waitExposed(view)
    return view


def test_empty_stage_invites_to_drop_a_file(viewport):
    empty = pixels(viewport)
    viewport.set_message(" ")
    assert np.abs(empty - pixels(viewport))[90:150].sum() > 3_000


def test_actor_appears_in_the_middle(viewport):
    viewport.set_message("")
    viewport.set_overlays(ground=False, axes=False)
    before = pixels(viewport)
    viewport.set_actors([actor()])
    viewport.view_preset("front")
    changed = np.abs(pixels(viewport) - before).sum(axis=2) > 20
    assert changed[80:130, 154:166].mean() > 0.9
    assert changed[:, :40].mean() < 0.05


def test_decoded_ghost_stands_beside_the_original(viewport):
    viewport.view_preset("front")
    moved = actor().world_from_joint.copy()
    moved[:, 0, 3] += 0.8
    viewport.set_actors([actor(), replace(actor(), world_from_joint=moved, ghost=True)])
    viewport.frame_all()
    image = pixels(viewport)
    assert len(np.unique((image[:, :, 2] - image[:, :, 0] > 40).any(axis=0))) == 2


def test_first_actors_are_framed_and_later_ones_leave_the_camera(viewport):
    viewport.set_actors([actor()])
    before = viewport.camera
    assert before != Camera()
    viewport.set_actors([actor()])
    assert viewport.camera == before


@pytest.mark.parametrize(
    ("button", "modifiers", "turns", "moves"),
    [
        (Qt.MouseButton.MiddleButton, Qt.KeyboardModifier.NoModifier, True, False),
        (Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, True, False),
        (Qt.MouseButton.LeftButton, Qt.KeyboardModifier.AltModifier, True, False),
        (Qt.MouseButton.MiddleButton, Qt.KeyboardModifier.ShiftModifier, False, True),
        (Qt.MouseButton.MiddleButton, Qt.KeyboardModifier.AltModifier, False, True),
        (Qt.MouseButton.RightButton, Qt.KeyboardModifier.NoModifier, False, False),
    ],
)
def test_drag_turns_or_moves_the_camera(viewport, button, modifiers, turns, moves):
    before = viewport.camera
    drag(viewport, QPointF(100, 100), QPointF(160, 120), button, modifiers)
    after = viewport.camera
    assert ((after.yaw, after.pitch) != (before.yaw, before.pitch)) is turns
    assert (after.target != before.target) is moves
    assert after.distance == before.distance


def test_orbit_to_the_right_shows_the_figures_right(viewport):
    viewport.view_preset("front")
    drag(viewport, QPointF(100, 100), QPointF(150, 100), Qt.MouseButton.MiddleButton)
    assert viewport.camera.yaw < 0


def test_wheel_zooms_towards_the_mouse(viewport):
    viewport.set_actors([actor()])
    viewport.view_preset("front")
    hand = QPointF(*place_of(viewport, viewport.scene.actors[0].joint_positions()[4]))
    before = viewport.camera.distance
    wheel = QWheelEvent(
        hand,
        viewport.mapToGlobal(hand),
        QPoint(),
        QPoint(0, 360),
        Qt.MouseButton.NoButton,
        Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    QApplication.sendEvent(viewport, wheel)
    assert viewport.camera.distance < before / 1.4
    moved = place_of(viewport, viewport.scene.actors[0].joint_positions()[4])
    assert np.hypot(moved[0] - hand.x(), moved[1] - hand.y()) < 3


@pytest.mark.parametrize(
    ("key", "modifiers", "preset"),
    [
        (Qt.Key.Key_1, Qt.KeyboardModifier.KeypadModifier, "front"),
        (Qt.Key.Key_3, Qt.KeyboardModifier.KeypadModifier, "side"),
        (Qt.Key.Key_7, Qt.KeyboardModifier.NoModifier, "top"),
        (Qt.Key.Key_1, Qt.KeyboardModifier.ControlModifier, "back"),
    ],
)
def test_number_keys_turn_to_presets(qtbot, viewport, key, modifiers, preset):
    qtbot.keyClick(viewport, key, modifiers)
    assert (viewport.camera.yaw, viewport.camera.pitch) == PRESETS[preset]


def test_five_changes_the_projection_and_back(qtbot, viewport):
    qtbot.keyClick(viewport, Qt.Key.Key_5, Qt.KeyboardModifier.KeypadModifier)
    assert viewport.camera.orthographic
    qtbot.keyClick(viewport, Qt.Key.Key_5, Qt.KeyboardModifier.KeypadModifier)
    assert not viewport.camera.orthographic


def test_f_frames_the_selected_hand_and_shift_f_everything(qtbot, viewport):
    viewport.set_actors([actor()])
    everything = viewport.camera
    viewport.select_joint(4)
    qtbot.keyClick(viewport, Qt.Key.Key_F)
    assert viewport.camera.distance < everything.distance / 3
    np.testing.assert_allclose(viewport.camera.target, viewport.scene.actors[0].joint_positions()[4], atol=0.2)
    qtbot.keyClick(viewport, Qt.Key.Key_F, Qt.KeyboardModifier.ShiftModifier)
    assert viewport.camera.distance == pytest.approx(everything.distance, rel=0.01)


def test_click_on_the_head_picks_it_and_lights_it_up(qtbot, viewport):
    viewport.set_actors([actor()])
    viewport.view_preset("front")
    viewport.set_overlays(ground=False, axes=False)
    before = pixels(viewport)
    head = viewport.scene.actors[0].joint_positions()[2] + (0.03, 0.08, 0)
    x, y = place_of(viewport, head)
    with qtbot.waitSignal(viewport.joint_picked) as picked:
        qtbot.mouseClick(viewport, Qt.MouseButton.LeftButton, pos=QPoint(round(x), round(y)))
    assert picked.args == [2]
    assert viewport.scene.selected == (0, 2)
    red, _, blue = (pixels(viewport) - before)[round(y), round(x)]
    assert blue < red - 30


def test_click_beside_the_body_picks_nothing(qtbot, viewport):
    viewport.set_actors([actor()])
    viewport.select_joint(2)
    with qtbot.waitSignal(viewport.joint_picked) as picked:
        qtbot.mouseClick(viewport, Qt.MouseButton.LeftButton, pos=QPoint(6, 6))
    assert picked.args == [-1]
    assert viewport.scene.selected is None


def test_drag_over_the_body_picks_nothing(viewport):
    viewport.set_actors([actor()])
    picked = []
    viewport.joint_picked.connect(picked.append)
    drag(viewport, QPointF(160, 100), QPointF(200, 100), Qt.MouseButton.LeftButton)
    assert picked == []


@pytest.mark.parametrize("look", list(Look))
def test_what_is_picked_is_what_the_rays_meet(viewport, look):
    viewport.set_actors([actor()])
    viewport.set_look(look)
    viewport.view_preset("front")
    pixels(viewport)
    for joint, (x, y, z) in ((2, (0.02, 0.1, 0)), (4, (0.03, 0, 0)), (7, (0.0, -0.4, 0))):
        at = QPointF(*place_of(viewport, viewport.scene.actors[0].joint_positions()[joint] + (x, y, z)))
        assert viewport.hit(at).joint == joint
        renderer, viewport._renderer = viewport._renderer, None  # as where there is no OpenGL
        assert viewport.hit(at).joint == joint
        viewport._renderer = renderer
    assert viewport.hit(QPointF(3, 3)) is None


def test_resting_mouse_names_the_joint_and_its_segment_beside_the_pointer(qtbot, viewport):
    body = replace(actor().body, segments=("", "", "skull", "", "", "", "", "", "", "", ""))
    viewport.set_actors([replace(actor(), body=body)])
    viewport.view_preset("front")
    x, y = place_of(viewport, viewport.scene.actors[0].joint_positions()[2] + (0.03, 0.08, 0))
    before = pixels(viewport)
    qtbot.mouseMove(viewport, QPoint(round(x), round(y)))
    qtbot.waitUntil(lambda: viewport.hover.lines == ("Head", "skull"))
    assert viewport.scene.hovered == (0, 2)
    beside = np.s_[round(y) + 14 : round(y) + 30, round(x) + 16 : round(x) + 40]
    assert np.abs(pixels(viewport) - before)[beside].sum(axis=2).mean() > 20
    viewport.hover.names = False
    assert viewport.hover.lines == ()
    viewport.hover.names = True
    qtbot.mouseMove(viewport, QPoint(3, 3))
    qtbot.waitUntil(lambda: viewport.hover.lines == ())
    assert viewport.scene.hovered is None


def test_actors_that_come_later_are_shown_in_the_chosen_look(viewport):
    viewport.set_look(Look.XRAY)
    viewport.set_actors([actor(), actor(ghost=True)])
    assert {shown.look for shown in viewport.scene.actors} == {Look.XRAY}
    viewport.set_look(Look.SOLID)
    assert {shown.look for shown in viewport.scene.actors} == {Look.SOLID}


def test_click_on_an_axis_of_the_triad_turns_the_view(qtbot, viewport):
    viewport.view_preset("front")
    tip = QPoint(round(320 - TRIAD_INSET + TRIAD_RADIUS), round(TRIAD_INSET))
    qtbot.mouseClick(viewport, Qt.MouseButton.LeftButton, pos=tip)
    assert (viewport.camera.yaw, viewport.camera.pitch) == PRESETS["left"]


def test_dark_theme_darkens_the_stage(viewport):
    light = pixels(viewport).mean()
    viewport.set_theme(True)
    assert pixels(viewport).mean() < light - 80


def test_picture_at_rest_is_repeatable(viewport):
    viewport.set_actors([actor()])
    viewport.finish()
    first = pixels(viewport)
    viewport.finish()
    np.testing.assert_array_equal(first, pixels(viewport))


def test_new_context_after_a_loss_draws_the_same(qtbot, viewport):
    viewport.set_actors([actor()])
    viewport.finish()
    before = pixels(viewport)
    viewport.hide()
    window = QWidget()
    qtbot.addWidget(window)
    window.resize(320, 240)
    viewport.setParent(window)  # another top-level window: Qt makes another context
    viewport.setGeometry(0, 0, 320, 240)
    window.show()
    viewport.show()
    qtbot.waitExposed(window)
    viewport.finish()
    np.testing.assert_allclose(pixels(viewport), before, atol=3)
    viewport.setParent(None)


def test_old_driver_gets_a_message_and_no_crash(qtbot, monkeypatch):
    def too_old():
        raise GraphicsError("the 3-D view cannot start", wanted="OpenGL 3.3", got="2.1 Mesa")

    monkeypatch.setattr("qmd_studio.ui.viewport.Renderer", too_old)
    view = Viewport()
    qtbot.addWidget(view)
    view.resize(320, 240)
    with qtbot.waitSignal(view.failed) as failed:
        view.show()
        qtbot.waitExposed(view)
        pixels(view)
    assert "OpenGL 3.3" in failed.args[0]
    assert view.failure == failed.args[0]
    assert pixels(view).std() > 2


def test_ghost_leaves_the_picture_opaque(viewport):
    """Else what lies behind the window shows through, and bright colours come out beyond their range."""
    viewport.set_actors([actor(), actor(ghost=True)])
    viewport.view_preset("front")
    viewport.grabFramebuffer()
    viewport.makeCurrent()
    GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, viewport.defaultFramebufferObject())
    opacity = GL.glReadPixels(0, 0, viewport.width(), viewport.height(), GL.GL_ALPHA, GL.GL_UNSIGNED_BYTE)
    viewport.doneCurrent()
    assert set(opacity) == {255}
