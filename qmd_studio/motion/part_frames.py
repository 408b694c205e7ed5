"""Frames of body parts in a reference pose: what makes two bodies' joints comparable, however their files lay them out.

A part's frame has y against its bone (a hanging arm, a standing leg), z to the front and x to the body's left. Two
joints with one frame each are at the same pose when their frames are parallel in the world: so a T-pose, an A-pose and
hanging arms agree, and a second direction (the front of the body, the toes, the finger bases) settles the turn about
the bone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.motion.body_parts import FINGERS, BodyParts, parts_of
from qmd_studio.motion.kinematics import node_positions, world_from_joint
from qmd_studio.motion.limbs import node_tree
from qmd_studio.motion.skeleton import Skeleton

TRUNK = ("root", "pelvis", "spine", "neck", "head", "clavicle", "acromion")
"""Parts that have the body's own frame; those of the others go along their bones."""
_NEAR_AXIS = 0.906  # 25 degrees
_BENT_TRUNK = 0.77  # 40 degrees
_TWISTED_LEG = 0.64  # 50 degrees
_BENT_LIMB = 0.94  # 20 degrees
_STRAIGHT_DOWN = 0.978  # 12 degrees
_ALONG = 0.85
_SHORTEST_HAND = 0.15


@dataclass(frozen=True, slots=True, eq=False)
class PartFrames:
    """The frames of a body in one pose: `frame_of` (3, 3) by joint, for the joints that are parts, and `body` (3, 3).

    `sole_m` is how far the feet reach below the ankles when they stand, None where nothing is below them.
    """

    body: FloatArray
    frame_of: dict[int, FloatArray]
    sole_m: float | None


@dataclass(frozen=True, slots=True, eq=False)
class LocalFrames:
    """The same in the joints' own frames: (3, 3) from part to joint, wherever the joint then is.

    `body_in` (n_joints, 3, 3) holds the body's frame in that of every joint.
    """

    frame_in: dict[int, FloatArray]
    body_in: FloatArray
    sole_m: float | None


def local_frames(skeleton: Skeleton, X: FloatArray, *, aligned: bool = True) -> LocalFrames:
    """Return the frames that `skeleton` has in the pose `X` (n_columns,) radians and metres, by joint."""
    pose = world_from_joint(skeleton, X[None])[0, :, :3, :3]
    found = part_frames(skeleton, node_positions(skeleton, X[None])[0], aligned=aligned)
    local = {joint: pose[joint].T @ frame for joint, frame in found.frame_of.items()}
    return LocalFrames(local, np.swapaxes(pose, 1, 2) @ found.body, found.sole_m)


def is_bent(skeleton: Skeleton, X: FloatArray) -> bool:
    """Tell whether a figure is folded or turned in its middle in the pose `X` (n_columns,), as some files rest."""
    return straightness(skeleton, X) < _BENT_TRUNK


def straightness(skeleton: Skeleton, X: FloatArray) -> float:
    """Return how well the trunk goes on where the legs point and shoulders are over hips: 1 at best, down to -1."""
    figure = _Figure(skeleton, node_positions(skeleton, X[None])[0])
    legs, head = figure.down(), figure.rise()
    hips, shoulders = figure.between("r_hip", "l_hip"), figure.between("r_shoulder", "l_shoulder")
    folded = 1.0 if legs is None or head is None else -float(legs @ head)
    turned = 1.0 if hips is None or shoulders is None else float(hips @ shoulders)
    return min(folded, turned)


def part_frames(skeleton: Skeleton, nodes: FloatArray, *, aligned: bool = True) -> PartFrames:
    """Return the frames of `skeleton` in the pose whose node positions are `nodes` (n_nodes, 3) metres.

    Without `aligned` every part has the body's own frame: the pose then counts as the same as any other one, and
    turns away from it are taken as they are.
    """
    figure = _Figure(skeleton, nodes)
    lower, upper = figure.trunk()
    frames = figure.frames(lower, upper)
    sole = figure.sole(frames)
    if not aligned:
        frames = dict.fromkeys(frames, lower)
    return PartFrames(lower, frames, sole)


class _Figure:
    """A posed skeleton while its frames are being read off."""

    def __init__(self, skeleton: Skeleton, nodes: FloatArray) -> None:
        self.nodes = nodes
        self.parts: BodyParts = parts_of(skeleton)
        self.parents, self.children = node_tree(skeleton)
        self.named = self.parts.named

    def trunk(self) -> tuple[FloatArray, FloatArray]:
        """The frames of pelvis and chest: one for both unless the file bends the trunk."""
        down, rise = self.down(), self.rise()
        up = -down if down is not None else rise if rise is not None else np.array([0.0, 1.0, 0.0])
        lower = _frame(_snapped(up), self._apart("hip", "shoulder"))
        upper = _frame(_snapped(rise if rise is not None else up), self._apart("shoulder", "hip"))
        if _cosine(lower, upper) > _BENT_TRUNK:
            upper = lower
        return lower, upper

    def down(self) -> FloatArray | None:
        """The way that the legs point, both together."""
        legs = [self.between(s + "hip", s + "ankle") for s in ("l_", "r_")]
        return _unit(sum((leg for leg in legs if leg is not None), np.zeros(3)))

    def rise(self) -> FloatArray | None:
        """The way from the chest to the head."""
        if self.parts.head is None:
            return None
        chest = (self.parts.spine or (self.parts.root,))[-1]
        return _unit(self.nodes[self.parts.head] - self.nodes[chest])

    def frames(self, lower: FloatArray, upper: FloatArray) -> dict[int, FloatArray]:
        """The frame of every part."""
        found = {self.parts.root: lower, self.parts.pelvis: lower}
        trunk = [*self.parts.spine, *self.parts.neck]
        for joint, after in zip(trunk, [*trunk[1:], self.parts.head], strict=False):
            bone = _unit(self.nodes[after] - self.nodes[joint]) if after is not None else None
            below = bone is not None and bone @ lower[:, 1] > bone @ upper[:, 1] and joint in self.parts.spine
            found[joint] = lower if below else upper
        if self.parts.spine:
            found[self.parts.spine[-1]] = upper
        if self.parts.head is not None:
            found[self.parts.head] = upper
        for side in ("l_", "r_"):
            for part in ("clavicle", "acromion"):
                if side + part in self.named:
                    found[self.named[side + part]] = upper
            self._leg(side, lower, found)
            self._arm(side, upper, found)
        return found

    def sole(self, frames: dict[int, FloatArray]) -> float | None:
        """How far the lowest node of a standing foot is below its ankle, the mean of both feet; metres."""
        drops = []
        for ankle in (self.named.get(s + "ankle") for s in ("l_", "r_")):
            if ankle is not None and (below := self._below(ankle)):
                drops.append(-float(((self.nodes[below] - self.nodes[ankle]) @ frames[ankle][:, 1]).min()))
        deepest = float(np.mean(drops)) if drops else 0.0
        return deepest if deepest > 1e-6 else None

    def _leg(self, side: str, body: FloatArray, found: dict[int, FloatArray]) -> None:
        ankle, line = self.named.get(side + "ankle"), self.between(side + "hip", side + "ankle")
        front = body[:, 2]
        foot = body if line is None or -line @ body[:, 1] > _STRAIGHT_DOWN else _towards(-line, front)
        toe = self._toe(side, foot[:, 1])
        if toe is not None:
            across = _unit(toe - (toe @ foot[:, 1]) * foot[:, 1])
            assert across is not None
            foot = _towards(foot[:, 1], across)
            if across @ front < _TWISTED_LEG:
                front = across  # the file's legs look another way than its hips
        for part, bone in (("hip", (side + "hip", side + "knee")), ("knee", (side + "knee", side + "ankle"))):
            if side + part in self.named:
                direction = self.between(*bone)
                found[self.named[side + part]] = _towards(-direction, front) if direction is not None else body
        if ankle is not None:
            found[ankle] = foot
        for part in ("subtalar", "midtarsal", "toe"):
            if side + part in self.named:
                found[self.named[side + part]] = foot

    def _toe(self, side: str, up: FloatArray) -> FloatArray | None:
        """The way from the ankle to the toes; None where the foot has none, or only straight down."""
        ankle = self.named.get(side + "ankle")
        if ankle is None:
            return None
        ends = [self.named[side + "toe"]] if side + "toe" in self.named else self._below(ankle)
        ways = [_unit(self.nodes[end] - self.nodes[ankle]) for end in ends]
        level = [way for way in ways if way is not None and abs(way @ up) < _ALONG]
        lengths = [np.linalg.norm(self.nodes[end] - self.nodes[ankle]) for end in ends]
        if not level or max(lengths) < 1e-6:
            return None
        farthest = _unit(self.nodes[ends[int(np.argmax(lengths))]] - self.nodes[ankle])
        return farthest if farthest is not None and abs(farthest @ up) < _ALONG else level[0]

    def _arm(self, side: str, body: FloatArray, found: dict[int, FloatArray]) -> None:
        outward = body[:, 0] if side == "l_" else -body[:, 0]
        upper, lower = self.between(side + "shoulder", side + "elbow"), self.between(side + "elbow", side + "wrist")
        if lower is None and side + "elbow" in self.named:
            lower = self._outermost(self.named[side + "elbow"])
        front = _arm_front(upper if upper is not None else lower, outward, body[:, 2])
        if upper is not None and lower is not None and upper @ lower < _BENT_LIMB:
            bend = _unit(lower - (lower @ upper) * upper)
            if bend is not None and bend @ front > 0.5:
                front = bend
        for part, direction in (("shoulder", upper), ("elbow", lower), ("forearm_twist", lower)):
            if side + part in self.named:
                found[self.named[side + part]] = _hinged(direction, upper, front) if direction is not None else body
        self._hand(side, front, found)

    def _hand(self, side: str, front: FloatArray, found: dict[int, FloatArray]) -> None:
        wrist = self.named.get(side + "wrist")
        if wrist is None:
            return
        forearm = found.get(self.named.get(side + "elbow", -1), np.eye(3))
        ahead = next((s for s in (side + "middle1", side + "index1", side + "fingers") if s in self.named), None)
        bone = self.between(side + "wrist", ahead) if ahead else None
        bone = bone if bone is not None else self._palm(side, wrist)
        hand = forearm if bone is None else _towards(-bone, self._knuckles(side, bone, _hinged(bone, None, front)))
        found[wrist] = hand
        for finger in (*FINGERS, "thumb"):
            before = hand
            for k in range(4):
                joint = self.named.get(f"{side}{finger}{k}")
                if joint is not None:
                    way = self._outermost(joint, near=True)
                    before = before if way is None else _finger_frame(way, hand, thumb=finger == "thumb")
                    found[joint] = before
        if side + "fingers" in self.named:
            way = self._outermost(self.named[side + "fingers"])
            found[self.named[side + "fingers"]] = hand if way is None else _finger_frame(way, hand, thumb=False)

    def _palm(self, side: str, wrist: int) -> FloatArray | None:
        """The way from a wrist to the end of its hand; None where it is too short, or too bent, to be one."""
        elbow, way = self.named.get(side + "elbow"), self._outermost(wrist)
        if elbow is None or way is None:
            return way
        forearm = self.nodes[wrist] - self.nodes[elbow]
        reach = max(float(np.linalg.norm(self.nodes[node] - self.nodes[wrist])) for node in self._below(wrist))
        length = float(np.linalg.norm(forearm))
        fits = reach > _SHORTEST_HAND * length and way @ forearm > 0.5 * length
        return way if fits or length < 1e-9 else None

    def _knuckles(self, side: str, bone: FloatArray, forward: FloatArray) -> FloatArray:
        """The second direction of a hand: to its thumb's side."""
        across = self.between(side + "pinky1", side + "index1")
        if across is not None and abs(across @ bone) < _ALONG:
            return across
        thumb = self.between(side + "wrist", side + "thumb1")
        if thumb is None and side + "thumb1" in self.named:
            thumb = self._outermost(self.named[side + "thumb1"])
        level = _unit(thumb - (thumb @ bone) * bone) if thumb is not None else None
        if level is not None and abs(thumb @ bone) < _ALONG and level @ forward[:, 2] < 0.7:  # type: ignore[operator]
            return level
        return np.asarray(forward[:, 2])

    def between(self, near: str, far: str) -> FloatArray | None:
        if near not in self.named or far not in self.named:
            return None
        return _unit(self.nodes[self.named[far]] - self.nodes[self.named[near]])

    def _apart(self, *pairs: str) -> FloatArray:
        for part in pairs:
            way = self.between("r_" + part, "l_" + part)
            if way is not None:
                return _snapped(way)
        return np.array([1.0, 0.0, 0.0])

    def _below(self, joint: int) -> list[int]:
        found = list(self.children[joint])
        for node in found:
            found += self.children[node] if node < len(self.children) else ()
        return found

    def _outermost(self, joint: int, *, near: bool = False) -> FloatArray | None:
        """The way from a joint to the farthest node below it, or with `near` to its farthest child."""
        nodes = list(self.children[joint]) if near else self._below(joint)
        ways = self.nodes[nodes] - self.nodes[joint]
        return _unit(ways[int(np.argmax(np.linalg.norm(ways, axis=1)))]) if nodes else None


def _arm_front(direction: FloatArray | None, outward: FloatArray, front: FloatArray) -> FloatArray:
    """Where the front of an arm looks that was raised to `direction`: an arm that points ahead was raised sideways."""
    if direction is None or abs(direction @ front) < 0.7:
        return front
    return np.asarray(rotation_onto(outward, direction) @ front)


def _hinged(bone: FloatArray, upper: FloatArray | None, front: FloatArray) -> FloatArray:
    """The frame of a bone that bends to `front`: with the hinge of the bone above it where it is bent now."""
    if upper is not None and upper @ bone < _BENT_LIMB:
        hinge = _unit(np.cross(-upper, front))
        if hinge is not None and abs(hinge @ bone) < 0.5:
            return _frame(-bone, hinge)
    return _towards(-bone, front)


def _finger_frame(bone: FloatArray, hand: FloatArray, *, thumb: bool) -> FloatArray:
    return _frame(-bone, hand[:, 0]) if thumb else _towards(-bone, hand[:, 2])


def _towards(up: FloatArray, front: FloatArray) -> FloatArray:
    """The frame with y along `up` and z as near to `front` as can be."""
    left = _unit(np.cross(up, front))
    return _frame(up, left if left is not None else np.eye(3)[int(np.argmin(np.abs(up)))])


def _frame(up: FloatArray, left: FloatArray) -> FloatArray:
    """The frame with y along `up` and x as near to `left` as can be."""
    x = _unit(left - (left @ up) * up)
    if x is None:
        spare = np.eye(3)[int(np.argmin(np.abs(up)))]
        x = np.cross(up, spare) / np.linalg.norm(np.cross(up, spare))
    return np.stack([x, up, np.cross(x, up)], axis=1)


def rotation_onto(start: FloatArray, end: FloatArray) -> FloatArray:
    """Return the least rotation (3, 3) that takes the unit vector `start` to `end`."""
    cosine, axis = float(start @ end), np.cross(start, end)
    if cosine < -0.9999:
        across = _frame(start, np.eye(3)[int(np.argmin(np.abs(start)))])[:, 0]
        return np.asarray(2.0 * np.outer(across, across) - np.eye(3))
    skew = np.array([[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]])
    return np.asarray(np.eye(3) + skew + skew @ skew / (1.0 + cosine))


def _snapped(vector: FloatArray) -> FloatArray:
    """The unit vector, or the world's axis where it is within 25 degrees of one."""
    k = int(np.argmax(np.abs(vector)))
    return np.eye(3)[k] * np.sign(vector[k]) if abs(vector[k]) > _NEAR_AXIS else vector


def _cosine(a: FloatArray, b: FloatArray) -> float:
    """The cosine of the angle between two frames."""
    return float((np.trace(a.T @ b) - 1.0) / 2.0)


def _unit(vector: FloatArray) -> FloatArray | None:
    length = float(np.linalg.norm(vector))
    return np.asarray(vector / length) if length > 1e-9 else None
