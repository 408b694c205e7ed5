"""Pictures of a scene without a window: for the command line, for contact sheets and for tests."""

from __future__ import annotations

from types import TracebackType

import numpy as np
from numpy.typing import NDArray
from OpenGL import GL

from qmd_studio.render.camera import Camera
from qmd_studio.render.egl import EglContext
from qmd_studio.render.gl import GraphicsError
from qmd_studio.render.panes import Pane
from qmd_studio.render.picking import Hit
from qmd_studio.render.quality import FINE, Quality
from qmd_studio.render.renderer import Renderer
from qmd_studio.render.scene import Scene
from qmd_studio.render.target import Target

Picture = NDArray[np.uint8]
MAX_SIDE = 16_384
"""No picture has a longer side, whatever the driver could do."""


def render_picture(scene: Scene, camera: Camera, size: tuple[int, int], *, quality: Quality = FINE) -> Picture:
    """Return a picture of `scene`: (height, width, 3) sRGB 0 to 255, top row first, for `size` (width, height).

    Without a backdrop (`Scene.backdrop`) it is (height, width, 4), its alpha straight. Raises `GraphicsError` where the
    machine has nothing to draw with. For many pictures, keep an `OffscreenRenderer`.
    """
    with OffscreenRenderer() as renderer:
        return renderer.picture(scene, camera, size, quality=quality)


class OffscreenRenderer:
    """A renderer in a hidden context of its own, to be used and closed on one thread, best by `with`."""

    def __init__(self) -> None:
        self._context = EglContext()
        try:
            self.renderer = Renderer()
        except BaseException:
            self._context.close()
            raise

    def picture(
        self, scene: Scene, camera: Camera, size: tuple[int, int], *, quality: Quality = FINE, pixel_ratio: float = 1.0
    ) -> Picture:
        """Return a picture of `scene`; see `render_picture`. Marks of joints are `pixel_ratio` times as large."""
        self._context.make_current()
        width, height = size
        widest = min(MAX_SIDE, int(GL.glGetIntegerv(GL.GL_MAX_RENDERBUFFER_SIZE)))
        if not (1 <= width <= widest and 1 <= height <= widest):
            raise GraphicsError(
                "the picture has a size that cannot be drawn",
                wanted=f"1 to {widest} pixels a side",
                got=f"{width} × {height}",
            )
        target = Target(size, 0)
        try:
            self.renderer.draw(scene, camera, size, framebuffer=target.number, quality=quality, pixel_ratio=pixel_ratio)
            pixels = target.read()
        finally:
            target.release()
        return pixels[:, :, :3] if scene.backdrop else straight(pixels)

    def pick(self, scene: Scene, camera: Camera, size: tuple[int, int], at: tuple[float, float]) -> Hit | None:
        """Return what a picture of `scene` shows at a pixel `at`, from the left and from the top, or None."""
        self._context.make_current()
        return self.renderer.pick((Pane(scene),), camera, size, at)

    def close(self) -> None:
        """Give everything back to the driver."""
        self._context.make_current()
        self.renderer.release()
        self._context.close()

    def __enter__(self) -> OffscreenRenderer:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def straight(pixels: Picture) -> Picture:
    """Return (h, w, 4) with colours that were multiplied by their alpha as files want them: not so."""
    alpha = pixels[:, :, 3:].astype(np.float32)
    colour = np.where(alpha > 0, pixels[:, :, :3] * 255.0 / np.maximum(alpha, 1.0), 0.0)
    return np.concatenate([np.minimum(np.rint(colour), 255.0), alpha], axis=2).astype(np.uint8)
