"""How the picture is shared between two sides of one scene: one under the other by a wipe, or beside each other."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

from qmd_studio.render.scene import Scene


class Layout(StrEnum):
    """What of the picture shows what."""

    ONE = "one"
    """All actors in the whole picture."""
    WIPE = "wipe"
    """The first actor left of a line, the second right of it, as if one stood behind the other."""
    BESIDE = "beside"
    """The first actor in the left half, the second in the right, each half a picture of its own."""


@dataclass(frozen=True, slots=True)
class Pane:
    """A part of the picture: `scene` drawn over `window`, of which `shown` is seen.

    `window` and `shown` are from and to in shares of the picture's width, `first_actor` is the number that the pane's
    first actor has in the whole scene.
    """

    scene: Scene
    window: tuple[float, float] = (0.0, 1.0)
    shown: tuple[float, float] = (0.0, 1.0)
    first_actor: int = 0

    @property
    def width(self) -> float:
        """The share of the picture's width that the scene is drawn over."""
        return self.window[1] - self.window[0]


def panes_of(scene: Scene, layout: Layout, split: float = 0.5) -> tuple[Pane, ...]:
    """Return the panes that show `scene`, left to right; a wipe's line stands at `split`, 0 to 1, of the width.

    A scene of fewer than two actors has nothing to part: it fills the picture.
    """
    if layout is Layout.ONE or len(scene.actors) < 2:
        return (Pane(scene),)
    sides = (_with_only(scene, 0), _with_only(scene, 1))
    if layout is Layout.BESIDE:
        parts = ((0.0, 0.5), (0.5, 1.0))
        return tuple(
            Pane(s, window=p, shown=p, first_actor=k) for k, (s, p) in enumerate(zip(sides, parts, strict=True))
        )
    split = min(max(split, 0.0), 1.0)
    return (Pane(sides[0], shown=(0.0, split)), Pane(sides[1], shown=(split, 1.0), first_actor=1))


def pane_at(panes: tuple[Pane, ...], x: float) -> Pane:
    """Return the pane that is seen at `x`, a share of the picture's width."""
    return next((pane for pane in panes if x < pane.shown[1]), panes[-1])


def _with_only(scene: Scene, number: int) -> Scene:
    return replace(
        scene,
        actors=(scene.actors[number],),
        selected=_of_actor(scene.selected),
        hovered=_of_actor(scene.hovered),
    )


def _of_actor(mark: tuple[int, int] | None) -> tuple[int, int] | None:
    """Both sides are one body: a joint that is marked on one is marked on the other."""
    return None if mark is None else (0, mark[1])
