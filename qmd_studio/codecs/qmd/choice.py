"""The two closed loops, each column by itself or all of a frame together, behind one way to call them.

Compiled code is loaded where a loop is about to run.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TypeAlias

from qmd_studio.arrays import Float32Array
from qmd_studio.codecs.qmd.payload import IndexArray
from qmd_studio.motion.skeleton import Skeleton

Choose: TypeAlias = Callable[
    [Float32Array, Float32Array, Float32Array, Float32Array, Float32Array, IndexArray, Float32Array], None
]
"""Poses, table, middles and the decoder's pose in; exact differences, indices and decoded columns out."""


def chooser(skeleton: Skeleton, fdf: int, refresh: int | None) -> Choose:
    """Return the loop that chooses the indices of motions on `skeleton`, the first `fdf` columns kept as numbers.

    `refresh` says after how many rows it works out anew what the columns do to the joints (1: the exact choice); None
    leaves the joints out of it. What is returned serves one thread at a time.
    """
    if refresh is None:
        from qmd_studio.codecs.qmd.kernels import closed_loop

        plain: Choose = closed_loop
        return plain
    from qmd_studio.codecs.qmd.joint_choice import closed_loop_by_joints, desk_for
    from qmd_studio.motion.sensitivity import body_of, workspace_of

    desk = desk_for(skeleton.n_columns, fdf)
    return partial(closed_loop_by_joints, body_of(skeleton), workspace_of(skeleton), desk, refresh)
