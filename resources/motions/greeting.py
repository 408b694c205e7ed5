"""A wave: from standing at ease the right arm goes up, the open hand greets four times, the arm comes down again.

It begins and ends in the same pose. The feet stand still; the weight shifts a little to the left leg while the arm is
up, and the legs are solved for that.
"""

import numpy as np
from hands import relax_hand, spread_fingers
from legs import SKELETON, column, leg_frames, round_root, solve_legs

from qmd_studio.arrays import FloatArray

FPS = 30
DURATION_S = 4.6
GREETINGS_PER_S = 1.9
UP, DOWN = (0.35, 1.15), (3.25, 4.15)
"""When the arm goes up and when it comes down, seconds."""


def wave() -> FloatArray:
    """Return X (138, 186) of the greeting, in radians and metres."""
    t = np.arange(round(DURATION_S * FPS)) / FPS
    X = np.zeros((len(t), SKELETON.n_columns))
    _stand(X, t)
    _set_left_arm(X, t)
    _set_right_arm(X, t)
    _set_trunk(X, t)
    return X


def _ease(t: FloatArray, start: float, end: float) -> FloatArray:
    """Return 0 before `start`, 1 after `end`, and no jolt between."""
    part = np.clip((t - start) / (end - start), 0, 1)
    return part**3 * (part * (6 * part - 15) + 10)


def _raised(t: FloatArray, late: float = 0.0) -> FloatArray:
    """Return how far the arm is up, 0 to 1, for a part of it that follows `late` seconds after the shoulder."""
    return _ease(t, UP[0] + late, UP[1] + late) - _ease(t, DOWN[0] + late, DOWN[1] + late)


def _stand(X: FloatArray, t: FloatArray) -> None:
    """Stand with straight legs and the feet a little apart, shifting the weight to the left while the arm is up."""
    feet = {}
    for side, sign in (("l", 1.0), ("r", -1.0)):
        X[:, column(f"{side}_knee_flexion")] = np.radians(5)
        X[:, column(f"{side}_hip_abduct")] = sign * np.radians(1.5)
        ankle, attitude = leg_frames(np.zeros((1, SKELETON.n_columns)), side)
        turn = sign * np.radians(7)
        toes_out = np.array([[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]])
        feet[side] = ankle + np.array([sign * 0.012, 0.0, 0.030]), toes_out @ attitude
    shift = _raised(t, -0.1)
    X[:, column("HumanoidRoot_tr_lateral")] = 0.016 * shift
    X[:, column("HumanoidRoot_tr_vertical")] = 0.004 - 0.003 * shift + 0.0015 * np.sin(2 * np.pi * t / DURATION_S)
    round_root(X)
    for side, (ankle, attitude) in feet.items():
        X[:] = solve_legs(X, side, np.repeat(ankle, len(t), 0), np.repeat(attitude, len(t), 0))


def _set_left_arm(X: FloatArray, t: FloatArray) -> None:
    X[:, column("l_shoulder_abduct")] = np.radians(7) - np.radians(1.0) * _raised(t)
    X[:, column("l_shoulder_flexion")] = np.radians(2) - np.radians(4) * _raised(t, 0.1)
    X[:, column("l_shoulder_twisting")] = np.radians(5)
    X[:, column("l_elbow_flexion")] = np.radians(14) + np.radians(3) * _raised(t, 0.15)
    relax_hand(X, "l")


def _set_right_arm(X: FloatArray, t: FloatArray) -> None:
    up = _raised(t)
    greeting = _raised(t, 0.25) * _ease(t, 0.9, 1.4) * (1 - _ease(t, 3.0, 3.4))
    swing = 2 * np.pi * GREETINGS_PER_S * (t - 1.0)
    X[:, column("r_sternoclavicular_abduct")] = -np.radians(9) * _raised(t, 0.05)
    X[:, column("r_shoulder_flexion")] = np.radians(2) + np.radians(66) * up
    X[:, column("r_shoulder_twisting")] = -np.radians(5) + np.radians(69) * _raised(t, 0.08)
    X[:, column("r_shoulder_abduct")] = -np.radians(7) - np.radians(3) * np.sin(np.pi * up)
    X[:, column("r_elbow_flexion")] = np.radians(14) + np.radians(88) * _raised(t, 0.06)
    X[:, column("r_elbow_flexion")] += np.radians(17) * greeting * np.sin(swing)
    X[:, column("r_shoulder_flexion")] += np.radians(2.5) * greeting * np.sin(swing - 0.4)
    X[:, column("r_wrist_pivot")] = np.radians(11) * greeting * np.sin(swing - 0.9)
    X[:, column("r_wrist_flexion")] = -np.radians(8) * _raised(t, 0.2)
    open_hand = _raised(t, 0.18)
    relax_hand(X, "r", amount=1 - open_hand)
    spread_fingers(X, "r", amount=open_hand)


def _set_trunk(X: FloatArray, t: FloatArray) -> None:
    lean, breath = _raised(t, 0.05), np.sin(2 * np.pi * t / DURATION_S * 2)
    for name, share in (("vl3", 0.4), ("vt10", 0.35), ("vt6", 0.25)):
        X[:, column(f"{name}_roll")] = -np.radians(5) * share * lean
    X[:, column("vt6_torsion")] = -np.radians(3) * lean
    X[:, column("vt6_tilt")] = np.radians(0.5) * breath
    X[:, column("vc4_torsion")] = np.radians(2) * lean
    X[:, column("vc4_roll")] = np.radians(4) * _raised(t, 0.15)
    X[:, column("skullbase_roll")] = np.radians(4) * _raised(t, 0.25)
    X[:, column("vc4_tilt")] = -np.radians(2) + np.radians(3) * np.sin(np.pi * np.clip((t - 1.0) / 0.8, 0, 1)) ** 2
