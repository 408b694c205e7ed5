"""Contact sheets of retargeted motions: start, quarter, half and end, the source's own bones above, an avatar below.

    retarget_sheet.py OUT_DIR [--body NAME] [FILE …]

Without files, all BVHs and AMCs of the corpus are taken; without a body, the default avatar. A PNG per file is written,
and a line with its angle error printed: that of the motion in body animation parameters.
"""

import argparse
from pathlib import Path

import bench_motion
import numpy as np

from qmd_studio.avatar.dressed import dress
from qmd_studio.avatar.upright import upright
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.bap_body import bap_skeleton_like
from qmd_studio.motion.reference_pose import choose_reference
from qmd_studio.motion.retarget import retargeting
from qmd_studio.registry import DEFAULT_AVATAR, open_body, open_file
from qmd_studio.render.camera import Camera
from qmd_studio.render.offscreen import OffscreenRenderer
from qmd_studio.render.png import png
from qmd_studio.render.quality import LADDER
from qmd_studio.render.scene import Actor, Scene

SIZE = (300, 330)
PATTERNS = ("bvh/*.bvh", "cmu_asfamc/*.amc", "cmu_derived/*.amc", "other_asfamc/*.amc")


def frames_of(motion):
    """Start, quarter, half and end."""
    return [round(share * (motion.n_frames - 1)) for share in (0, 0.25, 0.5, 1)]


def sheet(renderer, motion, body):
    """Return the picture (height, width, 3): a row for the source and one for the avatar."""
    rows = []
    for worn in (dress(motion, None), dress(motion, body)):
        pictures = []
        for pose in worn.poses(frames_of(motion)):
            scene = Scene((Actor(worn.body, pose),), show_axes=False, ground_y=float(pose[:, 1, 3].min()))
            camera = Camera(yaw=0.6, pitch=0.15).frame(scene.points(), SIZE[0] / SIZE[1])
            pictures.append(renderer.picture(scene, camera, SIZE, quality=LADDER[1])[..., :3])
        rows.append(np.concatenate(pictures, axis=1))
    return np.concatenate(rows)


def words(motion, body):
    """Return how well the motion goes into the body animation parameters of `body`."""
    target = bap_skeleton_like(body.skeleton)
    way = retargeting(motion.skeleton, target, reference=choose_reference(motion), upright=upright(motion))
    result = way.motion(motion)
    return (
        f"{result.mean_angle_error_deg:.2f}° mean angle error, {len(result.mapped)} joints driven, "
        f"{100 * result.clamped_share:.1f} % outside the limits; {'; '.join(result.notes)}"
    )


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out", type=Path)
    parser.add_argument("files", type=Path, nargs="*")
    parser.add_argument("--body", default=DEFAULT_AVATAR)
    arguments = parser.parse_args()
    files = arguments.files or [f for p in PATTERNS for f in sorted(bench_motion.CORPUS.glob(p))]
    body = open_body(arguments.body).body
    arguments.out.mkdir(parents=True, exist_ok=True)
    with OffscreenRenderer() as renderer:
        for file in files:
            skeleton = file.parents[1] / "cmu_asfamc" / "02.asf" if file.parent.name == "cmu_derived" else None
            motion = open_file(file, ReadOptions(skeleton=skeleton)).motion
            (arguments.out / f"{file.stem}.png").write_bytes(png(sheet(renderer, motion, body)))
            print(f"{file.name}: {words(motion, body)}", flush=True)


if __name__ == "__main__":
    main()
