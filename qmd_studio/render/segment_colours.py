"""A colour for each joint's segment, so that no two that touch look alike, to the colour-blind either."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from qmd_studio.arrays import FloatArray, IntArray
from qmd_studio.avatar.humanoid import Body
from qmd_studio.render.heat import linear

_PALETTE = np.array(  # sRGB 0 to 255 after Okabe and Ito, black left out, with a lighter and a darker stone
    [
        (230, 159, 0),
        (86, 180, 233),
        (0, 158, 115),
        (240, 228, 66),
        (0, 114, 178),
        (213, 94, 0),
        (204, 121, 167),
        (222, 220, 214),
        (104, 100, 112),
    ]
)
_RED_BLIND = np.array([[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]])
_GREEN_BLIND = np.array([[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]])
"""What is left of linear colours to the two common kinds of colour-blindness (Machado, Oliveira, Fernandes 2009)."""


@lru_cache(maxsize=16)
def segment_colours(body: Body) -> FloatArray:
    """Return the colours of the segments (n_joints + 1, 3), linear 0 to 1, the figure's own last.

    Segments whose skins touch, and those of a joint and its parent, differ as much as the palette allows.
    """
    n_joints = len(body.skeleton.joints)
    neighbours = _neighbours(body, n_joints)
    apart = _distances()
    chosen = np.full(n_joints + 1, -1)
    used = np.zeros(len(_PALETTE), dtype=int)
    for joint in range(n_joints):
        around = [chosen[other] for other in neighbours[joint] if chosen[other] >= 0]
        nearest = apart[:, around].min(axis=1) if around else np.full(len(_PALETTE), apart.max())
        fit = np.minimum(nearest, 0.5 * apart.max()) - 0.004 * used
        fit[np.isin(np.arange(len(_PALETTE)), around)] = -1.0
        chosen[joint] = int(np.argmax(fit))
        used[chosen[joint]] += 1
    chosen[n_joints] = 7
    return np.asarray(linear(_PALETTE / 255.0)[chosen])


def carriers(joints: IntArray, weights: FloatArray) -> IntArray:
    """Return the joint that each vertex follows most, (V,)."""
    strongest = np.argmax(np.abs(weights), axis=1)
    return np.take_along_axis(joints, strongest[:, None], axis=1)[:, 0]


def _neighbours(body: Body, n_joints: int) -> list[set[int]]:
    carrier = carriers(body.surface.joints, np.asarray(body.surface.weights, dtype=np.float64))
    pairs = [carrier[body.surface.faces[:, [a, b]]] for a, b in ((0, 1), (1, 2), (2, 0))]
    pairs += [np.array([(i, max(joint.parent, 0)) for i, joint in enumerate(body.skeleton.joints)]).reshape(-1, 2)]
    result: list[set[int]] = [set() for _ in range(n_joints + 1)]
    for a, b in np.unique(np.concatenate(pairs), axis=0):
        if a != b:
            result[a].add(int(b))
            result[b].add(int(a))
    return result


def _distances() -> FloatArray:
    """How far apart two colours of the palette look to whom they look least so, (n, n)."""
    light = linear(_PALETTE / 255.0)
    seen = [np.cbrt(np.clip(light @ eye.T, 0.0, 1.0)) for eye in (np.eye(3), _RED_BLIND, _GREEN_BLIND)]
    return np.asarray(np.min([np.linalg.norm(s[:, None] - s[None], axis=2) for s in seen], axis=0))
