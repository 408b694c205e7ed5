"""Contact sheets of retargeted motions: start, quarter, half and end, the source body above, the BAP body below.

Run it on a screen or under xvfb-run: `retarget_sheet.py OUT_DIR [FILE …]`. Without files, all BVHs and AMCs of the
corpus are taken. A PNG per file is written, and a line with its angle error printed.
"""

import os
import sys
from pathlib import Path

import bench_motion
import numpy as np

if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
    sys.exit("retarget_sheet needs a screen: xvfb-run -a python tests/benchmarks/retarget_sheet.py OUT_DIR")

from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication

from qmd_studio.avatar.bone_body import bone_body
from qmd_studio.avatar.upright import upright
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.bap import bap_skeleton
from qmd_studio.motion.kinematics import world_from_joint
from qmd_studio.motion.reference_pose import choose_reference
from qmd_studio.motion.retarget import retargeting
from qmd_studio.registry import open_file
from qmd_studio.render.camera import Camera
from qmd_studio.render.quality import LADDER
from qmd_studio.render.scene import Actor, Scene

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "render"))
from gl_picture import HiddenContext

SIZE = (300, 300)
PATTERNS = ("bvh/*.bvh", "cmu_asfamc/*.amc", "cmu_derived/*.amc", "other_asfamc/*.amc")


def frames_of(motion):
    """Start, quarter, half and end."""
    return sorted({round(share * (motion.n_frames - 1)) for share in (0, 0.25, 0.5, 1)})


def retargeted(motion):
    """Return the retargeting, its result, the source's and the target's worlds in the frames of the sheet."""
    way = retargeting(motion.skeleton, bap_skeleton(), reference=choose_reference(motion), upright=upright(motion))
    result = way.motion(motion)
    chosen = frames_of(motion)
    worlds = [
        upright(motion) @ world_from_joint(motion.skeleton, motion.X[chosen]),
        world_from_joint(way.target, result.motion.X[chosen]),
    ]
    return result, worlds


def sheet(context, renderer, motion, worlds):
    """Return the picture (height, width, 3): a row for the source and one for the target."""
    rows = []
    for skeleton, world in zip((motion.skeleton, bap_skeleton()), worlds, strict=True):
        body = bone_body(skeleton)
        pictures = []
        for pose in world:
            scene = Scene((Actor(body, pose),), show_axes=False)
            camera = Camera(yaw=0.6, pitch=0.15).frame(scene.points(), 1.0)
            pictures.append(context.picture(renderer, scene, camera, quality=LADDER[3], size=SIZE))
        rows.append(np.concatenate(pictures, axis=1))
    return np.concatenate(rows)


def save(picture, path):
    data = np.ascontiguousarray(picture, dtype=np.uint8)
    QImage(data.data, data.shape[1], data.shape[0], 3 * data.shape[1], QImage.Format.Format_RGB888).save(str(path))


def main():
    out, *names = sys.argv[1:] or ["out"]
    files = [Path(name) for name in names] or [f for p in PATTERNS for f in sorted(bench_motion.CORPUS.glob(p))]
    Path(out).mkdir(parents=True, exist_ok=True)
    application = QApplication(sys.argv)
    context = HiddenContext()
    from qmd_studio.render.renderer import Renderer

    renderer = Renderer()
    for file in files:
        skeleton = file.parents[1] / "cmu_asfamc" / "02.asf" if file.parent.name == "cmu_derived" else None
        motion = open_file(file, ReadOptions(skeleton=skeleton)).motion
        result, worlds = retargeted(motion)
        save(sheet(context, renderer, motion, worlds), Path(out) / f"{file.stem}.png")
        print(
            f"{file.name}: {result.mean_angle_error_deg:.2f}° mean angle error, {len(result.mapped)} joints driven, "
            f"{100 * result.clamped_share:.1f} % outside the limits; {'; '.join(result.notes)}",
            flush=True,
        )
    renderer.release()
    context.close()
    application.quit()


if __name__ == "__main__":
    main()
