"""Draw bap-poses.png, the picture in bap.md: `python resources/help/make_bap_pictures.py` from the project's root.

It needs a display, a virtual one will do.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from PySide6.QtGui import (
    QColor,
    QFont,
    QGuiApplication,
    QImage,
    QOffscreenSurface,
    QOpenGLContext,
    QPainter,
    QSurfaceFormat,
)
from PySide6.QtOpenGL import QOpenGLFramebufferObject

from qmd_studio.arrays import FloatArray
from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.motion.bap import bap_skeleton, column_of
from qmd_studio.motion.bap_mirror import mirrored
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.render.camera import Camera
from qmd_studio.render.quality import STILL
from qmd_studio.render.renderer import Renderer
from qmd_studio.render.scene import Actor, Scene

HERE = Path(__file__).parent
PANEL = (270, 340)
COLUMNS = 4
SKELETON = bap_skeleton()
WHOLE = Camera(target=(0, 0.93, 0), distance=3.75)
HANDS = Camera(target=(0, 1.13, 0.30), distance=1.25, yaw=0.0, pitch=0.75)


@dataclass(frozen=True)
class Panel:
    """A pose (186,) in radians and metres, the camera that shows it, and what is said about it."""

    title: str
    pose: FloatArray
    camera: Camera = WHOLE


def pose(degrees: dict[int, float]) -> FloatArray:
    """Return the pose (186,) with these degrees by parameter number."""
    row = np.zeros(SKELETON.n_columns)
    for bap_id, angle in degrees.items():
        row[column_of(bap_id)] = np.radians(angle)
    return row


def panels() -> list[Panel]:
    """Return what is shown, in rows of four."""
    fist = dict.fromkeys((126, 138, 150, 162), -55) | dict.fromkeys((132, 144, 156, 168), -65)
    fist |= dict.fromkeys((134, 146, 158, 170), -35) | {172: -14, 174: 30, 178: -30, 180: -35}
    step = pose({4: 50, 10: -70, 35: -60, 39: 80, 36: 20, 49: 25, 185: 4, 32: -25, 38: 15})
    front, side = WHOLE.preset("front"), WHOLE.preset("side")
    return [
        Panel("all 0", pose({})),
        Panel("34 = 80°: coronal plane", pose({34: 80}), replace(front, target=(0.24, 0.93, 0.0))),
        Panel("33 = 80°: sagittal plane", pose({33: 80}), replace(side, target=(0.0, 0.93, 0.2))),
        Panel("38, 39 = 90°: elbows", pose({38: 90, 39: 90}), side),
        Panel("4 = 35°, 10 = −80°: knee", pose({4: 35, 10: -80}), side),
        Panel("right fingers below 0", pose({38: 90, 39: 90} | fist), HANDS),
        Panel("a pose …", step, front),
        Panel("… and its mirror image", mirrored(step), front),
    ]


def draw(renderer: Renderer, panel: Panel, actor: Actor) -> QImage:
    """Return the picture of one panel."""
    target = QOpenGLFramebufferObject(*PANEL)
    scene = Scene(actors=(actor,), show_axes=False)
    renderer.draw(scene, panel.camera, PANEL, framebuffer=target.handle(), quality=STILL)
    return target.toImage()


def main() -> None:
    """Draw all panels beside this file."""
    app = QGuiApplication([])
    wanted = QSurfaceFormat()
    wanted.setVersion(3, 3)
    wanted.setProfile(QSurfaceFormat.OpenGLContextProfile.CoreProfile)
    context, surface = QOpenGLContext(), QOffscreenSurface()
    context.setFormat(wanted)
    surface.setFormat(wanted)
    surface.create()
    if not context.create() or not context.makeCurrent(surface):
        raise SystemExit("no OpenGL 3.3 here")
    body, renderer, shown = bone_body(SKELETON), Renderer(), panels()
    sheet = QImage(COLUMNS * PANEL[0], -(-len(shown) // COLUMNS) * PANEL[1], QImage.Format.Format_RGB32)
    painter = QPainter(sheet)
    painter.setFont(QFont("DejaVu Sans", 9))
    painter.setPen(QColor("#2a3040"))
    for number, panel in enumerate(shown):
        x, y = number % COLUMNS * PANEL[0], number // COLUMNS * PANEL[1]
        actor = Actor(body, world_from_joint(SKELETON, panel.pose[None])[0])
        painter.drawImage(x, y, draw(renderer, panel, actor))
        painter.drawText(x + 10, y + 20, panel.title)
    painter.end()
    sheet.save(str(HERE / "bap-poses.png"))
    del app


if __name__ == "__main__":
    main()
