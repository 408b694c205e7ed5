"""Makes a figure stand that its file lays out otherwise: some have every bone along one axis where they rest."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.motion.joint_names import Limb

_BENT_COSINE = 0.87
_FOOT_COSINE = 0.55
_FOOT_DROP = 0.38


def straighten_trunk(
    nodes: FloatArray,
    bind: FloatArray,
    children: tuple[tuple[int, ...], ...],
    trunk: tuple[int, tuple[int, ...], int | None],
    legs: tuple[Limb, ...],
) -> None:
    """Turn the upper body in `nodes` and `bind` to go on where the legs point, if it is bent by more than 30 degrees.

    `trunk` is the pelvis, the spine and the head.
    """
    pelvis, spine, head = trunk
    if len(legs) != 2 or head is None:
        return
    hips = np.mean([nodes[leg.upper[0]] for leg in legs], axis=0)
    ankles = np.mean([nodes[leg.end] for leg in legs], axis=0)
    above, below = _unit(nodes[head] - hips), _unit(hips - ankles)
    if above is None or below is None or float(above @ below) > _BENT_COSINE:
        return
    path = [j for j in (*spine, head) if j != pelvis]
    for joint, following in pairwise(path):  # a joint stays where its parent holds it; what hangs from it turns
        bone = _unit(nodes[following] - nodes[joint])
        if bone is not None and float(bone @ below) < _BENT_COSINE:
            _turn(nodes, bind, _with_below(joint, children), (rotation_between(bone, below), nodes[joint].copy()))


def straighten_feet(
    nodes: FloatArray,
    bind: FloatArray,
    children: tuple[tuple[int, ...], ...],
    legs: tuple[Limb, ...],
    axes: tuple[FloatArray, FloatArray],
) -> None:
    """Turn feet in `nodes` and `bind` that point anywhere but forward; `axes` are the figure's up and forward."""
    up, forward = axes
    wanted = _unit(forward - _FOOT_DROP * up)
    for leg in legs:
        below = _with_below(leg.end, children)
        tip = max(below, key=lambda n: float(np.linalg.norm(nodes[n] - nodes[leg.end])))
        toe = _unit(nodes[tip] - nodes[leg.end])
        if toe is None or wanted is None or float(toe @ wanted) > _FOOT_COSINE:
            continue
        if float(np.linalg.norm(nodes[tip] - nodes[leg.end])) < 0.1 * float(
            np.linalg.norm(nodes[leg.end] - nodes[leg.upper[0]])
        ):
            continue
        _turn(nodes, bind, below, (rotation_between(toe, wanted), nodes[leg.end].copy()))


def rotation_between(start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the least rotation (3, 3) that takes the unit vector `start` to `end`."""
    axis = np.cross(start, end)
    cosine = float(start @ end)
    if cosine < -0.9999:
        spare = np.eye(3)[int(np.argmin(np.abs(start)))]
        across = np.cross(start, spare)
        across /= np.linalg.norm(across)
        return np.asarray(2.0 * np.outer(across, across) - np.eye(3))
    skew = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.asarray(np.eye(3) + skew + skew @ skew / (1.0 + cosine))


def _turn(nodes: FloatArray, bind: FloatArray, turned: list[int], about: tuple[FloatArray, FloatArray]) -> None:
    rotation, centre = about
    nodes[turned] = (nodes[turned] - centre) @ rotation.T + centre
    joints = [n for n in turned if n < len(bind)]
    bind[joints, :3, :3] = rotation @ bind[joints, :3, :3]
    bind[joints, :3, 3] = nodes[joints]


def _with_below(joint: int, children: tuple[tuple[int, ...], ...]) -> list[int]:
    found = [joint]
    for node in found:
        found += children[node] if node < len(children) else ()
    return found


def _unit(vector: FloatArray) -> FloatArray | None:
    length = float(np.linalg.norm(vector))
    return vector / length if length > 1e-9 else None
