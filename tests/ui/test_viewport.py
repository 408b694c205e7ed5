"""The viewport as a user meets it: what it draws, how the mouse and keys move it, and what a click picks."""

from __future__ import annotations

import numpy as np
import pytest
from PySide6.QtGui import QImage

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.motion.kinematics import rest_values, world_from_joint
from qmd_studio.motion.skeleton import EndSite, Joint, Skeleton, SkeletonKind
from qmd_studio.render.scene import Actor
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


@pytest.fixture
def viewport(qtbot):
    view = Viewport()
    view.animated = False
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
    before = pixels(viewport)
    viewport.set_actors([actor()])
    viewport.view_preset("front")
    changed = np.abs(pixels(viewport) - before).sum(axis=2) > 60
    assert changed[70:140, 150:170].mean() > 0.2
    assert changed[:, :40].mean() < 0.05
