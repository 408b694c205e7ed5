"""How the fingers are held."""

import numpy as np
from legs import column

from qmd_studio.arrays import FloatArray

FINGERS = ("index", "middle", "ring", "pinky")


def relax_hand(X: FloatArray, side: str, *, amount: FloatArray | float = 1.0) -> None:
    """Curl the fingers in place as they are at ease, the little finger most; `amount` is 0 to 1, or (F,)."""
    for place, finger in enumerate(FINGERS):
        for k, degrees in ((1, 16 + 4 * place), (2, 26 + 3 * place), (3, 14 + 2 * place)):
            X[:, column(f"{side}_{finger}{k}_flexion")] -= np.radians(degrees) * amount
    for k, degrees in ((1, 34), (2, 16), (3, 14)):
        X[:, column(f"{side}_thumb{k}_flexion")] -= np.radians(degrees) * amount
    X[:, column(f"{side}_thumb1_pivot")] += np.radians(-26 if side == "l" else 26) * amount


def spread_fingers(X: FloatArray, side: str, *, amount: FloatArray | float = 1.0) -> None:
    """Stretch the hand and spread its fingers in place; `amount` is 0 to 1, or (F,)."""
    outward = 1.0 if side == "l" else -1.0  # a positive pivot is to the little finger's side on the left
    for finger, degrees in zip(FINGERS, (-9, -1, 7, 16), strict=True):
        X[:, column(f"{side}_{finger}1_pivot")] += outward * np.radians(degrees) * amount
        X[:, column(f"{side}_{finger}1_flexion")] += np.radians(4) * amount
    X[:, column(f"{side}_thumb1_flexion")] += np.radians(6) * amount
