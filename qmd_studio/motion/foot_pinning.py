"""Feet that stand still where the source's do: contacts, and a leg of two bones that reaches a point in closed form."""

from __future__ import annotations

import numpy as np

from qmd_studio.arrays import BoolArray, FloatArray
from qmd_studio.motion.body_parts import parts_of
from qmd_studio.motion.part_frames import rotation_onto
from qmd_studio.motion.skeleton import Skeleton

SLOW_M_S = 0.25
LOW_M = 0.06
_BLEND_S = 0.08
_SHORTEST_S = 0.05


def pinned_legs(
    target: Skeleton, wanted: FloatArray, world: FloatArray, source: tuple[FloatArray, float, Skeleton]
) -> tuple[FloatArray, str]:
    """Return what the joints aim at, legs changed so that standing ankles stay in one place, and a note on it.

    `wanted` (n_frames, J, 3, 3) and `world` (n_frames, J, 4, 4) are the target's without pinning; `source` gives the
    places (n_frames, Js, 3) metres of its joints, y up, its frame rate and its skeleton.
    """
    places, fps, skeleton = source
    ours, theirs = parts_of(skeleton).named, parts_of(target).named
    wanted, n_contacts = wanted.copy(), 0
    for side in ("l_", "r_"):
        leg = [theirs[side + p] for p in ("hip", "knee", "ankle") if side + p in theirs]
        foot = [ours[side + p] for p in ("ankle", "toe") if side + p in ours]
        if len(leg) < 3 or not foot:
            continue
        stands = contacts(places[:, foot], fps)
        goal, n = _goals(world[:, leg[2], :3, 3], stands, fps)
        n_contacts += n
        joints = world[..., :3, 3][:, leg]
        thigh, shin = two_bone_turns(joints, goal)
        wanted[:, leg[0]] = thigh @ wanted[:, leg[0]]
        wanted[:, leg[1]] = shin @ wanted[:, leg[1]]
    return wanted, f"feet were pinned in {n_contacts} steps"


def contacts(foot: FloatArray, fps: float) -> BoolArray:
    """Return in which frames (n_frames,) a foot stands: low and slow; `foot` (n_frames, K, 3) metres, y up.

    Low is within 6 cm of the lowest tenth of the motion; slow is below 0.25 m/s at all of its K joints, so that a heel
    that rises ends it.
    """
    if len(foot) < 3:
        return np.zeros(len(foot), dtype=np.bool_)
    speed = np.linalg.norm(np.gradient(foot, axis=0), axis=2).max(axis=1) * fps
    height = foot[:, :, 1].min(axis=1)
    low = height < np.quantile(height, 0.1) + LOW_M
    return np.asarray(low & (speed < SLOW_M_S))


def two_bone_turns(joints: FloatArray, goal: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the turns (n_frames, 3, 3) of the upper and the lower bone, in the world, that bring the end to `goal`.

    `joints` (n_frames, 3, 3) are the places of hip, knee and ankle, `goal` (n_frames, 3) metres. The knee stays in its
    plane and bends by the law of cosines; a goal out of reach is pointed at with the leg 0.1 % short of straight.
    """
    upper, lower = np.eye(3)[None].repeat(len(goal), 0), np.eye(3)[None].repeat(len(goal), 0)
    for frame in np.flatnonzero(np.linalg.norm(joints[:, 2] - goal, axis=1) > 1e-9):
        hip, knee, ankle = joints[frame]
        a, b = float(np.linalg.norm(knee - hip)), float(np.linalg.norm(ankle - knee))
        way = goal[frame] - hip
        reach = float(np.clip(np.linalg.norm(way), abs(a - b) * 1.001 + 1e-6, (a + b) * 0.999))
        before, after = ankle - hip, way / max(float(np.linalg.norm(way)), 1e-9)
        if min(a, b, float(np.linalg.norm(before))) < 1e-9:
            continue
        swing = rotation_onto(before / np.linalg.norm(before), after)
        bent = swing @ (knee - hip)
        aside = bent - (bent @ after) * after
        if np.linalg.norm(aside) < 1e-6:
            continue
        aside /= np.linalg.norm(aside)
        along = (a * a + reach * reach - b * b) / (2.0 * reach)
        new_knee = along * after + np.sqrt(max(a * a - along * along, 0.0)) * aside
        new_shin = reach * after - new_knee
        upper[frame] = rotation_onto(bent / a, new_knee / np.linalg.norm(new_knee)) @ swing
        shin = swing @ (ankle - knee)
        lower[frame] = rotation_onto(shin / b, new_shin / np.linalg.norm(new_shin)) @ swing
    return upper, lower


def _goals(ankle: FloatArray, stands: BoolArray, fps: float) -> tuple[FloatArray, int]:
    """Where the ankle goes (n_frames, 3): its mean place in each contact, eased in and out; and how many there are."""
    goal = ankle.copy()
    edges = np.flatnonzero(np.diff(np.concatenate([[0], stands.astype(np.int64), [0]])))
    ease = max(1, round(_BLEND_S * fps))
    n_contacts = 0
    for start, stop in zip(edges[::2], edges[1::2], strict=True):
        if stop - start < max(2, _SHORTEST_S * fps):
            continue
        n_contacts += 1
        held = ankle[start:stop].mean(axis=0)
        first, last = max(0, start - ease), min(len(ankle), stop + ease)
        frames = np.arange(first, last)
        away = np.maximum(np.maximum(start - frames, frames - (stop - 1)), 0)
        weight = 0.5 + 0.5 * np.cos(np.pi * np.minimum(away / (ease + 1), 1.0))
        goal[first:last] += weight[:, None] * (held - ankle[first:last])
    return goal, n_contacts
