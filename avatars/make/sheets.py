"""Draw an avatar's faces, hands and poses, to look at: python -m avatars.make.sheets OUT [NAME …]."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from avatars.make.poses import BODIES, HANDS, world_of
from qmd_studio.avatar.humanoid import Body
from qmd_studio.registry import open_file
from qmd_studio.render.camera import Camera
from qmd_studio.render.contact_sheet import contact_sheet
from qmd_studio.render.offscreen import OffscreenRenderer
from qmd_studio.render.png import png
from qmd_studio.render.scene import Actor, Scene, posed_vertices

ROOT = Path(__file__).resolve().parents[2]
NAMES = ("ada", "tim")
_HAND_VIEWS = {"palm": (-90.0, 0.0), "thumb": (-20.0, 5.0), "back": (90.0, 0.0), "slant": (-50.0, 25.0)}
_CHEST_VIEWS = {"front": (0.0, 5.0), "slant": (40.0, 20.0), "behind": (205.0, 15.0), "below": (30.0, -20.0)}
_BODY_VIEWS = {"front": (0.0, 3.0), "slant": (40.0, 12.0), "behind": (205.0, 10.0)}
_HEAD_VIEWS = {"front": (0.0, 0.0), "slant": (38.0, 6.0), "left": (90.0, 0.0), "behind": (150.0, 10.0)}
"""Yaw and pitch of the cameras, degrees."""
_AIMS = {"skullbase": (0.0, 0.045, 0.02), "l_middle1": (-0.015, 0.0, 0.015), "vt6": (0.0, 0.05, 0.0)}
"""Where a camera looks, metres from the joint that it looks at, of an adult."""


def main(out: Path, names: tuple[str, ...] = NAMES, kinds: tuple[str, ...] = ("head", "hand", "chest", "body")) -> None:
    """Write OUT/NAME-KIND-VIEW-light.png and -dark.png: every hand shape, every pose, and the head, from all views."""
    out.mkdir(parents=True, exist_ok=True)
    with OffscreenRenderer() as renderer:
        for name in names:
            body = open_file(ROOT / "avatars" / name / "avatar.x3d").body
            for kind in kinds:
                for view, pictures, captions in _shots(renderer, body, kind):
                    for theme, shots in pictures.items():
                        sheet = contact_sheet(shots, captions, f"{name}: {kind}, {view}", dark=theme == "dark")
                        (out / f"{name}-{kind}-{view}-{theme}.png").write_bytes(png(sheet))


def _shots(renderer: OffscreenRenderer, body: Body, kind: str):
    """Yield a view's name, its pictures by theme, and their captions."""
    if kind == "head":
        part = _with_skin_of(body, ("skullbase", "vc", "sterno", "acromio", "vt1", "vt2", "vt3", "l_eye", "r_eye"))
        yield "all", _pictures(renderer, part, {"": {}}, _HEAD_VIEWS, 640, 0.17, centre="skullbase"), [*_HEAD_VIEWS]
        return
    arms = {name: pose for name, pose in BODIES.items() if name.startswith(("rest", "arms", "hand"))}
    poses, views, half, centre = {
        "hand": (HANDS, _HAND_VIEWS, 0.115, "l_middle1"),
        "chest": (arms, _CHEST_VIEWS, 0.36, "vt6"),
        "body": (BODIES, _BODY_VIEWS, None, None),
    }[kind]
    hand = ("l_wrist", "l_thumb", "l_index", "l_middle", "l_ring", "l_pinky", "l_elbow")
    part = _with_skin_of(body, hand) if kind == "hand" else body
    for view, angles in views.items():
        yield view, _pictures(renderer, part, poses, {view: angles}, 400, half, centre=centre), [*poses]


def _pictures(renderer, body: Body, poses, views, side: int, half: float | None, *, centre: str | None):
    """Return pictures by theme of every pose from every view; `half` is how much of an adult they show, metres."""
    result: dict[str, list] = {"light": [], "dark": []}
    stature = 1.0 if centre == "skullbase" else float(body.bind[:, 1, 3].max()) / 1.66  # heads are much alike
    for pose in poses.values():
        actor = Actor(body, world_of(body, pose))
        for yaw, pitch in views.values():
            camera = Camera(yaw=np.radians(yaw), pitch=np.radians(pitch), fov=np.radians(18.0))
            if centre is None:
                camera = camera.frame(posed_vertices(actor, 7), 1.0)
            else:
                at = actor.joint_positions()[body.skeleton.joint_index(centre)]
                at = at + stature * np.array(_AIMS[centre])
                distance = half * stature / np.tan(camera.fov / 2)
                camera = replace(camera, target=tuple(at), distance=distance)
            for theme, shots in result.items():
                ground = float(posed_vertices(actor)[:, 1].min()) if centre is None else 0.0
                scene = Scene(
                    (actor,), dark=theme == "dark", show_axes=False, show_ground=centre is None, ground_y=ground
                )
                shots.append(renderer.picture(scene, camera, (side, side)))
    return result


def _with_skin_of(body: Body, joints: tuple[str, ...]) -> Body:
    """Return the body with the triangles alone that follow joints whose names begin so."""
    wanted = [number for number, joint in enumerate(body.skeleton.joints) if joint.name.startswith(joints)]
    surface = body.surface
    share = np.where(np.isin(surface.joints, wanted), surface.weights, 0).sum(axis=1)
    return replace(body, surface=replace(surface, faces=surface.faces[(share > 0.3)[surface.faces].all(axis=1)]))


if __name__ == "__main__":
    main(Path(sys.argv[1]), tuple(sys.argv[2:]) or NAMES)
