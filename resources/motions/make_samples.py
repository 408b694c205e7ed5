"""Make the sample motions that ship: `python resources/motions/make_samples.py [FOLDER]`, from the root of the project.

The motions are the work of this program alone; no recording stands behind them.
"""

import sys
from pathlib import Path

import gait
import greeting
import numpy as np
from legs import SKELETON

from qmd_studio.arrays import BoolArray, FloatArray
from qmd_studio.motion.motion import Motion
from qmd_studio.registry import save_motion

HERE = Path(__file__).parent


def main(folder: Path | str = HERE) -> None:
    """Write walk.bap and wave.bap into `folder`."""
    for name, X, fps in (("walk", gait.walk(), gait.FPS), ("wave", greeting.wave(), greeting.FPS)):
        save_motion(Path(folder) / f"{name}.bap", Motion(SKELETON, X, fps, name=name, mask=_mask(X)))


def _mask(X: FloatArray) -> BoolArray:
    """Give the whole pose once, and after that only what changes in the file's units."""
    in_file_units = np.rint(X * 1e5)
    mask = np.asarray(np.diff(in_file_units, axis=0, prepend=in_file_units[:1]) != 0)
    mask[0] = True
    return mask


if __name__ == "__main__":
    main(*sys.argv[1:])
