"""A walk round a circle, seven strides to the lap, so that it loops without a jump and no foot ever slides.

The feet are placed first: heel strike, foot flat, roll over the ball, toe off, swing. The pelvis moves over them as
pelvises do (its rise and fall, sway, rotation, list), the legs follow by solving, and trunk, head and arms swing
against the pelvis. Times are parts of a stride, which starts at a heel strike. Ranges follow common descriptions of
adult gait (stance 62 %, pelvic rotation 5 degrees each way, rise 4 cm, step width 10 cm).
"""

import numpy as np
from hands import relax_hand
from legs import SKELETON, column, round_root, solve_legs
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from qmd_studio.arrays import FloatArray
from qmd_studio.motion.rotation import axis_rotation

FPS = 30
FRAMES_PER_STRIDE = 32
STRIDES = 7
STRIDE_M = 1.22
RADIUS_M = STRIDES * STRIDE_M / (2 * np.pi)
LEAN = np.radians(1.2)
"""Into the curve."""

FLAT, HEEL_OFF, TOE_OFF = 0.11, 0.36, 0.62
HALF_WIDTH_M = 0.05
STEP_AHEAD_M = 0.276
"""From the body's place on the circle to the ankle of the foot that is put down."""

LEAVING_SPEED, LANDING_SPEED = 0.45, 0.30
"""Metres a stride by which the foot already moves forward as the toes leave, and still does as the heel strikes."""

TOE_OUT = np.radians(6.0)
HEEL = np.array([0.0, -0.0656, -0.036])
BALL = np.array([0.0, -0.0656, 0.1498])
"""Where the foot rests on the ground, from the ankle, in the foot's own frame."""

PITCH = PchipInterpolator(
    [0.0, 0.04, FLAT, HEEL_OFF, 0.45, 0.52, 0.58, TOE_OFF, 0.68, 0.76, 0.84, 0.92, 0.97, 1.0],
    np.radians([17, 10, 0, 0, -7, -20, -38, -50, -54, -36, -12, 10, 18, 17]),
)
"""The foot against the ground: positive with the toes up."""


def walk() -> FloatArray:
    """Return X (224, 186) of the walk, in radians and metres."""
    n_frames = STRIDES * FRAMES_PER_STRIDE
    stride = np.arange(n_frames) / FRAMES_PER_STRIDE
    X = np.zeros((n_frames, SKELETON.n_columns))
    _set_pelvis(X, stride)
    round_root(X)
    for side, late in (("l", 0.0), ("r", 0.5)):
        ankle, attitude, pitch = _foot(stride - late, side)
        X = solve_legs(X, side, ankle, attitude)
        X[:, column(f"{side}_metatarsal_flexion")] = _toes((stride - late) % 1.0, pitch)
    _set_trunk(X, stride)
    _set_arms(X, stride)
    return X


def _wave(stride: FloatArray, degrees: float, *, peak: float, times: int = 1) -> FloatArray:
    """Return a cosine in radians that is highest at `peak` of the stride."""
    return np.asarray(np.radians(degrees) * np.cos(2 * np.pi * times * (stride - peak)))


def _set_pelvis(X: FloatArray, stride: FloatArray) -> None:
    heading = 2 * np.pi * stride / STRIDES
    along = 0.008 * np.sin(4 * np.pi * (stride - 0.05))
    inward = 0.020 * np.cos(2 * np.pi * (stride - 0.31)) + 0.85 * np.sin(LEAN)
    height = -0.0197 + 0.019 * np.cos(4 * np.pi * (stride - 0.285))
    centre = _on_circle(heading + along / RADIUS_M, RADIUS_M - inward)
    X[:, column("HumanoidRoot_tr_lateral")] = centre[:, 0]
    X[:, column("HumanoidRoot_tr_vertical")] = height
    X[:, column("HumanoidRoot_tr_frontal")] = centre[:, 2] - 0.0277
    lean = axis_rotation(1, heading) @ axis_rotation(2, np.full_like(heading, -LEAN)) @ axis_rotation(0, _tilt(stride))
    _set_root_rotation(X, lean, heading)
    X[:, column("sacroiliac_torsion")] = -_wave(stride, 5.0, peak=0.0)
    X[:, column("sacroiliac_roll")] = _wave(stride, 4.0, peak=0.17)
    X[:, column("sacroiliac_tilt")] = -np.radians(2.0) - _wave(stride, 1.2, peak=0.1, times=2)


def _tilt(stride: FloatArray) -> FloatArray:
    return np.asarray(np.radians(2.0) + _wave(stride, 0.8, peak=0.12, times=2))


def _set_root_rotation(X: FloatArray, rotation: FloatArray, heading: FloatArray) -> None:
    """Set turn, roll and tilt so that Rx(tilt) Rz(roll) Ry(turn) is `rotation`; the turn goes on past a full circle."""
    roll = np.arcsin(np.clip(-rotation[:, 0, 1], -1, 1))
    turn = np.arctan2(rotation[:, 0, 2], rotation[:, 0, 0])
    tilt = np.arctan2(rotation[:, 2, 1], rotation[:, 1, 1])
    X[:, column("HumanoidRoot_rt_body_turn")] = turn + 2 * np.pi * np.round((heading - turn) / (2 * np.pi))
    X[:, column("HumanoidRoot_rt_body_roll")] = roll
    X[:, column("HumanoidRoot_rt_body_tilt")] = tilt


def _on_circle(angle: FloatArray, radius: FloatArray | float) -> FloatArray:
    return np.stack([-radius * np.cos(angle), np.zeros_like(angle), radius * np.sin(angle)], axis=-1)


def _foot(stride: FloatArray, side: str) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the ankle (F, 3), the attitude (F, 3, 3) and the pitch (F,) of a foot whose strides start at 0, 1, 2..."""
    number, phase = np.floor(stride), stride % 1.0
    pitch = PITCH(phase)
    ankle, attitude = _planted(number, phase, side)
    swing = phase > TOE_OFF
    ankle[swing], attitude[swing] = _swung(number[swing], phase[swing], side)
    return ankle, attitude, pitch


def _print(number: FloatArray, side: str) -> tuple[FloatArray, FloatArray]:
    """Return where the ankle of footprint `number` is with the foot flat (F, 3), and the foot's heading (F,)."""
    sign = 1.0 if side == "l" else -1.0
    radius = RADIUS_M - sign * HALF_WIDTH_M
    ahead = STEP_AHEAD_M / radius  # as far before the body on the outer side as on the inner
    angle = 2 * np.pi * (number + (0.0 if side == "l" else 0.5)) / STRIDES + ahead
    flat = _on_circle(angle, radius)
    flat[..., 1] = -HEEL[1]
    return flat, angle + sign * TOE_OUT


def _planted(number: FloatArray, phase: FloatArray, side: str) -> tuple[FloatArray, FloatArray]:
    flat, heading = _print(number, side)
    pitch = PITCH(phase)
    foot = axis_rotation(1, heading)
    pivot = np.where((phase < FLAT)[:, None], HEEL, BALL)
    attitude = foot @ axis_rotation(0, -pitch)
    rolled = np.einsum("fij,fj->fi", foot, pivot) - np.einsum("fij,fj->fi", attitude, pivot)
    return flat + rolled, attitude


def _swung(number: FloatArray, phase: FloatArray, side: str) -> tuple[FloatArray, FloatArray]:
    """Carry the foot from toe-off to the next heel strike, along the circle, both ends met in place and speed."""
    ends: list[tuple[FloatArray, FloatArray]] = []
    for step, at in ((number, TOE_OFF), (number + 1, 0.0)):
        here, near = (
            _polar(_planted(step, np.full_like(phase, at + d), side)[0]) for d in (0.0, -1e-4 if at else 1e-4)
        )
        speed = (near - here) / (-1e-4 if at else 1e-4)
        speed[:, 0] += (LEAVING_SPEED if at else LANDING_SPEED) / RADIUS_M
        ends.append((_unwrapped(here, step), speed))
    (start, leaving), (end, landing) = ends
    path = _hermite(phase, start=start, end=end, leaving=leaving, landing=landing)
    path[:, 2] += _lift(phase)
    ankle = _on_circle(path[:, 0], path[:, 1])
    ankle[:, 1] = path[:, 2]
    _, from_heading = _print(number, side)
    _, to_heading = _print(number + 1, side)
    part = _ease((phase - TOE_OFF) / (1 - TOE_OFF))
    return ankle, axis_rotation(1, from_heading + part * (to_heading - from_heading)) @ axis_rotation(0, -PITCH(phase))


def _polar(place: FloatArray) -> FloatArray:
    return np.stack([np.arctan2(place[:, 2], -place[:, 0]), np.hypot(place[:, 0], place[:, 2]), place[:, 1]], axis=1)


def _unwrapped(place: FloatArray, number: FloatArray) -> FloatArray:
    place = place.copy()
    near = 2 * np.pi * number / STRIDES
    place[:, 0] += 2 * np.pi * np.round((near - place[:, 0]) / (2 * np.pi))
    return place


def _hermite(
    phase: FloatArray, *, start: FloatArray, end: FloatArray, leaving: FloatArray, landing: FloatArray
) -> FloatArray:
    """Return the cubic through two places (F, 3) with the speeds at them (F, 3), a stride's part being the time."""
    t, span = (phase - TOE_OFF) / (1 - TOE_OFF), 1 - TOE_OFF
    h00, h01, h10, h11 = CubicHermiteSpline([0, 1], np.eye(4)[:2], np.eye(4)[2:])(t).T[..., None]
    return np.asarray(h00 * start + h01 * end + span * (h10 * leaving + h11 * landing))


def _lift(phase: FloatArray) -> FloatArray:
    """Return what is added to the ankle's height in mid swing, so that the toes clear the ground."""
    t = (phase - TOE_OFF) / (1 - TOE_OFF)
    return np.asarray(0.03 * np.sin(np.pi * np.clip(t, 0, 1) ** 0.6) ** 2)


def _ease(t: FloatArray) -> FloatArray:
    return t * t * t * (t * (6 * t - 15) + 10)


def _toes(phase: FloatArray, pitch: FloatArray) -> FloatArray:
    """Return the toes' angle: flat on the ground while the heel rises, nearly straight in the air."""
    air = PchipInterpolator([0.0, TOE_OFF, 0.70, 0.78, 0.88, 1.0], [0.0, 1.0, 0.75, 0.35, 0.0, 0.0])(phase)
    on_ground = np.where(phase <= TOE_OFF, 1.0, air)
    return np.where(phase < HEEL_OFF, 0.0, np.maximum(-pitch, 0.0) * on_ground) + np.radians(6) * _ease(
        np.clip((phase - 0.8) / 0.15, 0, 1)
    ) * _ease(np.clip((1.0 - phase) / 0.05, 0, 1))


def _set_trunk(X: FloatArray, stride: FloatArray) -> None:
    twist = _wave(stride, 4.5, peak=0.0)
    for name, share in (("vt10", 0.25), ("vt6", 0.5), ("vt1", 0.25)):
        X[:, column(f"{name}_torsion")] = share * twist
    lists = -_wave(stride, 2.5, peak=0.20)
    for name, share in (("vl3", 0.5), ("vt10", 0.5)):
        X[:, column(f"{name}_roll")] = share * lists + share * np.radians(1.5)
    X[:, column("vl3_tilt")] = -np.radians(1.0) + _wave(stride, 1.0, peak=0.12, times=2)
    X[:, column("vc4_torsion")] = -0.6 * twist + np.radians(4)
    X[:, column("skullbase_torsion")] = -0.4 * twist + np.radians(3)
    X[:, column("vc4_roll")] = -0.5 * lists + np.radians(0.8)
    X[:, column("vc4_tilt")] = -np.radians(1.0) - _wave(stride, 0.8, peak=0.16, times=2)


def _set_arms(X: FloatArray, stride: FloatArray) -> None:
    for side, late, sign in (("l", 0.0, 1.0), ("r", 0.5, -1.0)):
        own = stride - late
        X[:, column(f"{side}_shoulder_flexion")] = np.radians(1.0) - _wave(own, 19.0, peak=0.02)
        X[:, column(f"{side}_shoulder_abduct")] = sign * (np.radians(6.5) + _wave(own, 1.5, peak=0.1))
        X[:, column(f"{side}_shoulder_twisting")] = sign * (np.radians(6.0) - _wave(own, 4.0, peak=0.05))
        X[:, column(f"{side}_elbow_flexion")] = np.radians(22.0) - _wave(own, 11.0, peak=0.08)
        X[:, column(f"{side}_wrist_flexion")] = sign * (np.radians(6.0) - _wave(own, 5.0, peak=0.16))
        relax_hand(X, side)
