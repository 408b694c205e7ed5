"""Which joints a vertex follows: hard borders first, then heat that spreads along the skin and nowhere else.

Each vertex is first given to joints by planes at the joints and by the limb it lies on. The shares then spread over
the mesh for a distance that is set for each joint (narrow at fingers, wide at hip and shoulder), so that neighbours on
different fingers, or arm and flank, never exchange any: what is near in space but far along the skin stays apart.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import splu

from avatars.make.figure import Figure, default_centres
from avatars.make.hand import FINGERS, finger_points

MOST = 4
LEAST = 0.012

_WIDTHS = {
    "trunk": 0.022,
    "neck": 0.016,
    "head": 0.010,
    "upperarm": 0.024,
    "forearm": 0.0125,
    "hand": 0.0075,
    "thigh": 0.034,
    "shank": 0.017,
    "foot": 0.010,
}
"""How far shares spread on either side of a joint, metres of the default body."""
_FINGER_WIDTH, _KNUCKLE_WIDTH, _THENAR_WIDTH, _SHOULDER_WIDTH = 0.0030, 0.0048, 0.0120, 0.022


def weights_of(points, faces, figure: Figure, limb: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Return joint names and weights (n, n_joints) of a whole mesh; `limb` (n,) is 0 trunk, 1 arm, 2 leg, 3 head."""
    names = list(default_centres())
    number = {name: i for i, name in enumerate(names)}
    hard = np.zeros((len(points), len(names)))
    left = points[:, 0] >= 0
    folded = np.abs(points) * (1, 0, 0) + points * (0, 1, 1)
    plain = Regions(folded, figure, limb)
    for joint, share in plain.shares().items():
        if joint.startswith("l_"):
            hard[:, number[joint]] = np.where(left, share, 0)
            hard[:, number["r_" + joint[2:]]] = np.where(left, 0, share)
        else:
            hard[:, number[joint]] = share
    middle = points[:, 0] == 0
    for joint in names:
        if joint.startswith("l_"):
            mean = (hard[middle, number[joint]] + hard[middle, number["r_" + joint[2:]]]) / 2
            hard[middle, number[joint]] = hard[middle, number["r_" + joint[2:]]] = mean
    soft = _spread(points, faces, hard, plain.width())
    return names, _strongest(soft)


class Regions:
    """The hard shares of one side's joints at points (n, 3), in the order from the trunk outwards."""

    def __init__(self, points: np.ndarray, figure: Figure, limb: np.ndarray) -> None:
        self.points, self.figure, self.limb = points, figure, limb
        self.centre = figure.centres()
        self.result: dict[str, np.ndarray] = {}

    def shares(self) -> dict[str, np.ndarray]:
        """Return the share (n,) of each joint that has any; they sum to 1."""
        self._trunk()
        self._shoulder()
        self._arm()
        self._hand()
        self._leg()
        return self.result

    def width(self) -> np.ndarray:
        """Return how far shares spread at each point (n,), metres."""
        p, place, scale = self.points, self.figure.place, lambda part: self.figure.scale(part).mean()
        y = p[:, 1]
        result = np.full(len(p), _WIDTHS["trunk"] * scale("trunk"))
        near = lambda part, at, reach: np.clip(1.5 - np.linalg.norm(p - place(part, at), axis=1) / reach, 0, 1)  # noqa: E731
        spots = [
            ("neck", (0.0, 1.555, -0.01), 0.075, _WIDTHS["neck"]),
            ("head", (0.0, 1.640, 0.01), 0.100, _WIDTHS["head"]),
            ("upperarm", (0.190, 1.440, -0.039), 0.100, _SHOULDER_WIDTH),
            ("upperarm", (0.168, 1.362, -0.040), 0.055, 0.0210),
            ("upperarm", (0.2014, 1.1357, -0.07), 0.120, _WIDTHS["forearm"]),
            ("thigh", (0.080, 0.890, 0.0), 0.130, _WIDTHS["thigh"]),
            ("thigh", (0.104, 0.4867, 0.01), 0.160, _WIDTHS["shank"]),
            ("foot", (0.110, 0.040, 0.0), 0.130, _WIDTHS["foot"]),
        ]
        for part, at, reach, width in spots:
            share = near(part, at, reach * scale(part))
            result = result + share * (width * scale(part) - result)
        hand = self.limb == 1
        wrist = self.centre["l_wrist"][1]
        share = np.clip((wrist + 0.05 * scale("forearm") - y) / (0.04 * scale("hand")), 0, 1) * hand
        result += share * (_WIDTHS["hand"] * scale("hand") - result)
        size = scale("hand")
        share = near("hand", (0.1930, 0.8400, -0.0260), 0.030 * size) * hand
        result += share * (_THENAR_WIDTH * size - result)
        knuckle = self.centre["l_middle1"][1]
        share = np.clip((knuckle + 0.020 * size - y) / (0.014 * size), 0, 1) * hand
        result += share * (_KNUCKLE_WIDTH * size - result)
        share = np.clip((knuckle - 0.012 * size - y) / (0.014 * size), 0, 1) * hand
        share = np.maximum(share, np.clip((p[:, 2] - self.centre["l_thumb2"][2]) / (0.02 * size) + 0.6, 0, 1) * hand)
        result += share * (_FINGER_WIDTH * size - result)
        return result

    def _give(self, joint: str, share: np.ndarray, giver: str) -> None:
        """Move a share (n,) 0 to 1 of what `giver` has to `joint`."""
        moved = self.result[giver] * share
        self.result[giver] = self.result[giver] - moved
        self.result[joint] = self.result.get(joint, 0) + moved

    def _trunk(self) -> None:
        """Pelvis, then one vertebra after another: shares fall linearly between the levels of two."""
        p = self.points
        chain = [name for name in self.centre if name[:2] in ("vl", "vt", "vc")]
        low = self.centre["vl5"][1]
        level = p[:, 1]
        neck = self.neck_level()
        height = np.array([self.centre[name][1] for name in chain])
        trunk = np.array([name[:2] != "vc" for name in chain])
        top = height[trunk][-1]
        along = np.where(neck > 0, top + neck * (self.centre["vc1"][1] + 0.02 - top), np.minimum(level, top))
        places = np.concatenate([[low - 0.055 * self.figure.scale("trunk")[1]], height, [self.centre["vc1"][1] + 0.02]])
        owners = ["sacroiliac", *chain, "skullbase"]
        at = np.clip(np.searchsorted(places, along, side="right") - 1, 0, len(places) - 2)
        share = np.clip((along - places[at]) / (places[at + 1] - places[at]), 0, 1)
        for i, owner in enumerate(owners):
            self.result[owner] = np.where(at == i, 1 - share, 0) + np.where(at == i - 1, share, 0)
        head = (self.limb == 3) | (neck >= 1)
        for owner in owners:
            self.result[owner] = np.where(head, float(owner == "skullbase"), self.result[owner])

    def neck_level(self) -> np.ndarray:
        """Return how far up the neck points are (n,): 0 at its base, 1 at the skull, by planes that lean forward."""
        p, place = self.points, self.figure.place
        back_low, front_low = place("neck", [0, 1.512, -0.0815]), place("neck", [0, 1.478, 0.045])
        back_high, front_high = place("head", [0, 1.590, -0.0750]), place("head", [0, 1.537, 0.030])
        low = np.interp(p[:, 2], [back_low[2], front_low[2]], [back_low[1], front_low[1]])
        high = np.interp(p[:, 2], [back_high[2], front_high[2]], [back_high[1], front_high[1]])
        return (p[:, 1] - low) / (high - low)

    def _shoulder(self) -> None:
        p, place, size = self.points, self.figure.place, self.figure.scale("trunk")[0]
        givers = [name for name in self.result if name[:2] in ("vt", "vl", "vc") or name == "sacroiliac"]
        shoulder = self.centre["l_shoulder"]
        rise = _ramp(p[:, 1], place("trunk", [0, 1.300, 0])[1], place("trunk", [0, 1.405, 0])[1])
        torso = np.isin(self.limb, (0, 1))
        out = _ramp(p[:, 0], 0.045 * size, 0.105 * size) * rise * torso
        outer = _ramp(p[:, 0], 0.095 * size, 0.150 * size) * rise * torso
        arm = (self.limb == 1).astype(float)
        normal = np.array([0.870, -0.493, 0.0])
        away = (p - shoulder - np.array([-0.004 * size, 0, 0])) @ normal
        upper = p[:, 1] > place("trunk", [0, 1.375, 0])[1]
        arm = np.where(upper & torso, (away > 0).astype(float), arm)
        for giver in givers:
            self._give("l_sternoclavicular", 0.85 * out, giver)
        self._give("l_acromioclavicular", outer, "l_sternoclavicular")
        for giver in [*givers, "l_sternoclavicular", "l_acromioclavicular"]:
            self._give("l_shoulder", arm, giver)

    def _arm(self) -> None:
        p = self.points
        elbow, shoulder, wrist = (self.centre[f"l_{n}"] for n in ("elbow", "shoulder", "wrist"))
        normal = _unit(_unit(elbow - shoulder) + _unit(wrist - elbow))
        self._give("l_elbow", ((p - elbow) @ normal > 0).astype(float), "l_shoulder")
        cut = wrist[1] + 0.004 * self.figure.scale("hand")[1]
        self._give("l_wrist", (p[:, 1] < cut).astype(float), "l_elbow")

    def _hand(self) -> None:
        p, size = self.points, self.figure.scale("hand")
        bones = {f: self.figure.place("hand", finger_points(f)) for f in FINGERS}
        borders = [(bones[a][0, 2] + bones[b][0, 2]) / 2 for a, b in pairwise(FINGERS)]
        which = np.searchsorted(-np.array(borders), -p[:, 2])
        away = np.stack([_to_chain(p, bones[f]) for f in FINGERS], axis=1)
        beyond = p[:, 1] < self.centre["l_middle1"][1] - 0.010 * size[1]
        which = np.where(beyond, away.argmin(axis=1), which)
        thumb_bones = self.figure.place("hand", finger_points("thumb"))
        thumb = self._thumb_share()
        self._give("l_thumb1", thumb, "l_wrist")
        self._joint_after("l_thumb2", "l_thumb1", thumb_bones[0], thumb_bones[1], thumb_bones[2])
        self._joint_after("l_thumb3", "l_thumb2", thumb_bones[1], thumb_bones[2], thumb_bones[3])
        for i, finger in enumerate(FINGERS):
            mine, base = (which == i).astype(float), self.centre[f"l_{finger}0"]
            self._give(f"l_{finger}0", mine * (p[:, 1] < base[1] + 0.006 * size[1]), "l_wrist")
            bone = bones[finger]
            up = bone[0] + (bone[0] - bone[1])
            self._joint_after(f"l_{finger}1", f"l_{finger}0", up, bone[0], bone[1], late=0.004 * size[1])
            self._joint_after(f"l_{finger}2", f"l_{finger}1", bone[0], bone[1], bone[2])
            self._joint_after(f"l_{finger}3", f"l_{finger}2", bone[1], bone[2], bone[3])

    def _thumb_share(self) -> np.ndarray:
        """Return how much of each point (n,) follows the thumb: all beyond the web, little in the thenar's root."""
        p = self.points
        start, end = self.centre["l_thumb1"], self.centre["l_thumb2"]
        along = (p - start) @ (end - start) / ((end - start) @ (end - start))
        low = self.centre["l_index1"][1] + 0.012 * self.figure.scale("hand")[1]
        web = _ramp(p[:, 1], low, low + 0.022 * self.figure.scale("hand")[1])
        thumb, index = (_to_chain(p, self.figure.place("hand", finger_points(f))) for f in ("thumb", "index"))
        mine = (thumb < index) & (along > 0.55)
        return np.where(mine, 1.0, _ramp(along, 0.22, 0.66) * web * (thumb < index)) * (self.limb == 1)

    def _joint_after(self, joint, giver, before, at, after, late: float = 0.0) -> None:
        """Give what lies beyond the plane that halves the angle at a joint."""
        normal = _unit(_unit(at - before) + _unit(after - at))
        self._give(joint, ((self.points - at) @ normal > late).astype(float), giver)

    def _leg(self) -> None:
        p, place, size = self.points, self.figure.place, self.figure.scale("thigh")[0]
        hip, knee, ankle = (self.centre[f"l_{n}"] for n in ("hip", "knee", "ankle"))
        under = (p - hip - (0, 0.002 * size, 0)) @ _unit(np.array([0.42, -0.90, 0.0])) > 0
        crotch = (p[:, 0] < 0.022 * size) & (p[:, 1] > place("thigh", [0, 0.800, 0])[1])
        below = p[:, 1] < place("thigh", [0, 0.95, 0])[1]
        self._give("l_hip", (under & ~crotch & below & np.isin(self.limb, (0, 2, 4))).astype(float), "sacroiliac")
        normal = _unit(_unit(knee - hip) + _unit(ankle - knee))
        self._give("l_knee", ((p - knee) @ normal > 0).astype(float), "l_hip")
        foot = (self.limb == 4) | (p[:, 1] < ankle[1])
        self._give("l_ankle", foot.astype(float), "l_knee")
        for joint, giver in (("subtalar", "ankle"), ("midtarsal", "subtalar"), ("metatarsal", "midtarsal")):
            late = 0.018 * self.figure.scale("foot")[2] if joint == "subtalar" else 0.0
            beyond = p[:, 2] > self.centre[f"l_{joint}"][2] + late
            self._give(f"l_{joint}", beyond.astype(float), f"l_{giver}")


def _spread(points, faces, hard, width):
    """Return shares (n, j) after heat has run along the mesh for a time of width² (two steps, each backward Euler)."""
    n = len(points)
    rows, columns, values = [], [], []
    for i in range(3):
        a, b, c = faces[:, i], faces[:, (i + 1) % 3], faces[:, (i + 2) % 3]
        u, v = points[a] - points[c], points[b] - points[c]
        area = np.linalg.norm(np.cross(u, v), axis=1)
        half = np.clip((u * v).sum(axis=1) / np.maximum(area, 1e-12) / 2, 0.01, 10)
        half = half * ((width[a] + width[b]) / 2) ** 2 / 2
        rows += [a, b]
        columns += [b, a]
        values += [half, half]
    flow = coo_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(n, n)).tocsr()
    area = np.linalg.norm(
        np.cross(points[faces[:, 1]] - points[faces[:, 0]], points[faces[:, 2]] - points[faces[:, 0]]), axis=1
    )
    mass = np.bincount(faces.ravel(), np.repeat(area / 6, 3), minlength=n)
    solver = splu((diags(mass) + diags(np.asarray(flow.sum(axis=1)).ravel()) - flow).tocsc())
    soft = hard
    for _ in range(2):
        soft = solver.solve(mass[:, None] * soft)
    return soft


def _strongest(soft: np.ndarray) -> np.ndarray:
    """Return weights (n, j) with at most four a row, none under `LEAST`, that sum to 1."""
    result = np.where(soft >= LEAST, soft, 0.0)
    rank = np.argsort(np.argsort(-result, axis=1, kind="stable"), axis=1, kind="stable")
    result[rank >= MOST] = 0.0
    result = np.round(result / result.sum(axis=1, keepdims=True), 4)  # as they are written
    result[np.arange(len(result)), result.argmax(axis=1)] += 1 - result.sum(axis=1)
    return result


def _to_chain(points, chain) -> np.ndarray:
    """Return the distances (n,) of points to a line through the places of a chain."""
    best = np.full(len(points), np.inf)
    for a, b in pairwise(chain):
        t = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        best = np.minimum(best, np.linalg.norm(points - a - t[:, None] * (b - a), axis=1))
    return best


def _ramp(values, low, high):
    t = np.clip((values - low) / (high - low), 0, 1)
    return t * t * (3 - 2 * t)


def _unit(vector):
    return vector / np.linalg.norm(vector)
