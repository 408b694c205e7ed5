"""Place the feet of the H-Anim body exactly: six leg parameters a side from the ankle and the attitude of the foot."""

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.motion.bap import bap_skeleton, bap_table, column_of
from qmd_studio.motion.rotation import axis_rotation

SKELETON = bap_skeleton()
ID = {parameter.name: parameter.id for parameter in bap_table()}
SOLVED = ("hip_flexion", "hip_abduct", "hip_twisting", "knee_flexion", "ankle_flexion", "subtalar_flexion")
CHAIN = ("HumanoidRoot", "sacroiliac", "hip", "knee", "ankle", "subtalar")


def column(name: str) -> int:
    """Return the column of the parameter called `name`."""
    return column_of(ID[name])


def solve_legs(X: FloatArray, side: str, ankle: FloatArray, attitude: FloatArray, *, rounds: int = 60) -> FloatArray:
    """Return X (F, 186) with the six parameters of a leg set so that its foot stands as asked.

    `ankle` (F, 3) metres and `attitude` (F, 3, 3) are those of the foot's frame in the world. Newton steps on all
    frames at once, short enough not to leap; raises `ValueError` where a foot is out of reach.
    """
    X = X.copy()
    columns = [column(f"{side}_{name}") for name in SOLVED]
    X[:, columns[3]] = np.minimum(X[:, columns[3]], -0.2)
    for _ in range(rounds):
        miss = _miss(X, side, ankle, attitude)
        slopes = np.empty((len(X), 6, 6))
        for k, c in enumerate(columns):
            nudged = X.copy()
            nudged[:, c] += 1e-6
            slopes[:, :, k] = (_miss(nudged, side, ankle, attitude) - miss) / 1e-6
        slopes = slopes + 1e-9 * np.eye(6)
        step = np.linalg.solve(slopes, -miss[..., None])[..., 0]
        X[:, columns] += np.clip(step, -0.15, 0.15)
    worst = np.abs(_miss(X, side, ankle, attitude)).max(axis=1)
    if worst.max() > 1e-6:
        raise ValueError(
            f"{side} foot out of reach in frames {np.flatnonzero(worst > 1e-6).tolist()}: {worst.max():.4f}"
        )
    return X


def round_root(X: FloatArray) -> None:
    """Round the root's moves in place to the file's millimetre, so that legs solved after it need no rounding."""
    columns = [column(f"HumanoidRoot_tr_{way}") for way in ("lateral", "vertical", "frontal")]
    X[:, columns] = np.round(X[:, columns], 3)


def leg_frames(X: FloatArray, side: str) -> tuple[FloatArray, FloatArray]:
    """Return the foot's frame: attitudes (F, 3, 3) after the subtalar joint, and where (F, 3) its ankle stands at rest.

    The joint itself is a millimetre aside when the foot rolls; what has to stand still is the sole.
    """
    position, rotation = np.zeros((len(X), 3)), np.broadcast_to(np.eye(3), (len(X), 3, 3))
    for name in CHAIN:
        full = name if name in CHAIN[:2] else f"{side}_{name}"
        index = SKELETON.joint_index(full)
        joint = SKELETON.joints[index]
        offset = np.broadcast_to(np.array(joint.offset), (len(X), 3)).copy()
        if index == 0:
            for c in range(3):
                offset[:, SKELETON.columns[c].axis] += X[:, c]
        position = position + np.einsum("fij,fj->fi", rotation, offset)
        for c in joint.product:
            part = SKELETON.columns[c]
            rotation = rotation @ axis_rotation(part.axis, part.sign * X[:, c])
    return position - np.einsum("fij,j->fi", rotation, np.array(joint.offset)), rotation


def _miss(X: FloatArray, side: str, ankle: FloatArray, attitude: FloatArray) -> FloatArray:
    position, rotation = leg_frames(X, side)
    off = rotation @ np.swapaxes(attitude, 1, 2)
    turn = np.stack([off[:, 2, 1] - off[:, 1, 2], off[:, 0, 2] - off[:, 2, 0], off[:, 1, 0] - off[:, 0, 1]], axis=1) / 2
    return np.concatenate([position - ankle, turn], axis=1)
