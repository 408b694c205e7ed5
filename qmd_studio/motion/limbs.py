"""Head, spine, arms and legs of any skeleton: by name where known, by the shape of its tree otherwise."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from qmd_studio.arrays import FloatArray
from qmd_studio.motion.joint_names import Limb, plain_names
from qmd_studio.motion.skeleton import Skeleton

_HEAD = re.compile(r"^(head|skull)(?!.*(top|end|nub|tip))")
_HAND = re.compile(r"^(hand|wrist|radiocarpal)(?!.*(thumb|index|mid|ring|pinky|finger|little|end|nub))")
_FOOT = re.compile(r"^(foot|ankle|talocrural)(?!.*(heel|end|nub))")
_KNEE = re.compile(r"knee|shin|tibia|calf|low(er)?_?leg|loleg|^leg")
_ELBOW = re.compile(r"elbow|fore_?arm|radius|ulna|low(er)?_?arm|loarm")
_ARM_GIRDLE = re.compile(r"clav|collar|scapula|shoulder|thorax")
_LEG_GIRDLE = re.compile(r"hipjoint|buttock|pelvis|hip$|dum|^_")


@dataclass(frozen=True, slots=True)
class Limbs:
    """The joints of a figure. `spine` runs from the pelvis to below the head; what is not found is left out."""

    pelvis: int
    spine: tuple[int, ...]
    head: int | None
    arms: tuple[Limb, ...]
    legs: tuple[Limb, ...]


def node_tree(skeleton: Skeleton) -> tuple[tuple[int, ...], tuple[tuple[int, ...], ...]]:
    """Return the parent of each node, -1 for a root, and the child nodes of each joint.

    End sites that are not measured are landmarks on the skin rather than ends of bones: a joint that has anything else
    below it does not count them.
    """
    parents = tuple(j.parent for j in skeleton.joints) + tuple(s.joint for s in skeleton.end_sites)
    children: list[list[int]] = [[] for _ in skeleton.joints]
    bones = set(range(len(skeleton.joints))) | set(skeleton.points)
    for nodes in (sorted(bones), sorted(set(range(len(parents))) - bones)):
        bare = {joint for joint, below in enumerate(children) if not below}
        for node in nodes:
            if parents[node] in bare:
                children[parents[node]].append(node)
    return parents, tuple(tuple(c) for c in children)


def find_limbs(skeleton: Skeleton, nodes: FloatArray) -> Limbs:
    """Return the limbs of `skeleton`, whose `nodes` (n_nodes, 3) metres are at rest. Nothing is refused."""
    parents, children = node_tree(skeleton)
    names = plain_names(skeleton)
    head = _first(names, _HEAD)
    hands = _pair(names, _HAND)
    feet = _pair(names, _FOOT)
    if not (hands or feet) and len(skeleton.joints) >= 8:
        head, hands, feet = _by_shape(nodes, parents, children, head)
    if head is None:
        head = _top_of_trunk(nodes, parents, children, (*hands, *feet))
    paths = {joint: _ancestors(parents, joint) for joint in (*hands, *feet, *([head] if head is not None else []))}
    pelvis = _fork([paths[f] for f in feet]) if len(feet) == 2 else 0
    trunk = paths[head] if head is not None else _common([paths[h] for h in hands]) if hands else (pelvis,)
    arms = tuple(_limb(names, _after_fork(paths[h], trunk), side, arm=True) for h, side in hands.items())
    stem = _common([paths[f] for f in feet]) if len(feet) == 2 else trunk
    legs = tuple(_limb(names, _after_fork(paths[f], stem), side, arm=False) for f, side in feet.items())
    arms, legs = tuple(a for a in arms if a.upper), tuple(a for a in legs if a.upper)
    spine = tuple(j for j in trunk if j != head and j not in _common_but_last(trunk, pelvis))
    return Limbs(pelvis=pelvis, spine=spine, head=head, arms=arms, legs=legs)


def _first(names: list[tuple[str, int]], pattern: re.Pattern[str]) -> int | None:
    return next((i for i, (name, _) in enumerate(names) if pattern.search(name)), None)


def _pair(names: list[tuple[str, int]], pattern: re.Pattern[str]) -> dict[int, int]:
    """The first joint of each side that has the name, as {joint: side}; joints come before their children."""
    found: dict[int, int] = {}
    for index, (name, side) in enumerate(names):
        if side and side not in found.values() and pattern.search(name):
            found[index] = side
    return found if len(found) == 2 else {}


def _by_shape(
    nodes: FloatArray, parents: tuple[int, ...], children: tuple[tuple[int, ...], ...], head: int | None
) -> tuple[int | None, dict[int, int], dict[int, int]]:
    """Head, hands and feet of a figure that stands along +Y: its highest tip, widest pair, lowest pair."""
    tips = [node for node in range(len(parents)) if node >= len(children) or not children[node]]
    size = float(np.ptp(nodes, axis=0).max())
    if len(tips) < 4 or size <= 0:
        return head, {}, {}
    middle = nodes[0, 0]
    sides = {s: [t for t in tips if (nodes[t, 0] - middle) * s > 0.02 * size] for s in (1, -1)}
    if not (sides[1] and sides[-1]):
        return head, {}, {}
    feet = {_limb_end(min(sides[s], key=lambda t: nodes[t, 1]), nodes, parents, children): s for s in (1, -1)}
    legs = {j for foot in feet for j in _ancestors(parents, foot)[1:]}
    widest = {s: [t for t in sides[s] if not set(_ancestors(parents, parents[t])) & (set(feet))] for s in (1, -1)}
    hands = {}
    if widest[1] and widest[-1]:
        farthest = {s: max(widest[s], key=lambda t: abs(nodes[t, 0] - middle)) for s in (1, -1)}
        hands = {_limb_end(tip, nodes, parents, children): s for s, tip in farthest.items()}
    if head is None:
        free = [t for t in tips if not set(_ancestors(parents, t)[1:]) & ((legs | set(hands)) - {0})]
        head = parents[max(free, key=lambda t: nodes[t, 1])] if free else None
    return head, hands if len(hands) == 2 else {}, feet if len(feet) == 2 else {}


def _limb_end(tip: int, nodes: FloatArray, parents: tuple[int, ...], children: tuple[tuple[int, ...], ...]) -> int:
    """The hand or foot of a limb that ends in `tip`: the joint from which it is short enough to be one."""
    path = _ancestors(parents, tip)
    lengths = np.linalg.norm(np.diff(nodes[list(path)], axis=0), axis=1)
    reach = np.cumsum(lengths[::-1])[::-1]
    near = [j for j, r in zip(path[:-1], reach, strict=True) if r <= 0.13 * float(np.ptp(nodes, axis=0).max())]
    return near[0] if near else tip if tip < len(children) else parents[tip]


def _top_of_trunk(
    nodes: FloatArray, parents: tuple[int, ...], children: tuple[tuple[int, ...], ...], limbs: tuple[int, ...]
) -> int | None:
    """The last joint with a bone towards the highest tip that no limb holds; None where there is no limb at all."""
    if not limbs:
        return None
    held = {j for limb in limbs for j in range(len(parents)) if limb in _ancestors(parents, j)}
    tips = [n for n in range(len(parents)) if (n >= len(children) or not children[n]) and n not in held]
    above = [t for t in tips if nodes[t, 1] > nodes[list(limbs), 1].mean()]
    if not above:
        return None
    tip = max(above, key=lambda t: nodes[t, 1])
    return parents[tip] if parents[tip] >= 0 and tip >= len(children) else tip


def _ancestors(parents: tuple[int, ...], joint: int) -> tuple[int, ...]:
    path = [joint]
    while parents[path[-1]] >= 0:
        path.append(parents[path[-1]])
    return tuple(path[::-1])


def _common(paths: list[tuple[int, ...]]) -> tuple[int, ...]:
    shared = []
    for level in zip(*paths, strict=False):
        if len(set(level)) > 1:
            break
        shared.append(level[0])
    return tuple(shared)


def _fork(paths: list[tuple[int, ...]]) -> int:
    return (_common(paths) or (0,))[-1]


def _after_fork(path: tuple[int, ...], trunk: tuple[int, ...]) -> tuple[int, ...]:
    return tuple(j for j in path if j not in trunk)


def _common_but_last(trunk: tuple[int, ...], pelvis: int) -> tuple[int, ...]:
    """What stands on the trunk before the pelvis: reference joints that carry no flesh."""
    return trunk[: trunk.index(pelvis)] if pelvis in trunk else ()


def _limb(names: list[tuple[str, int]], path: tuple[int, ...], side: int, *, arm: bool) -> Limb:
    """Split the joints of a limb, the last of them the hand or foot."""
    if not path:
        return Limb(side, (), (), (), 0)
    *before, end = path
    hinge_name, girdle_name = (_ELBOW, _ARM_GIRDLE) if arm else (_KNEE, _LEG_GIRDLE)
    hinges = [k for k, j in enumerate(before) if k > 0 and hinge_name.search(names[j][0])]
    hinge = hinges[0] if hinges else max(len(before) - 1, 0)
    upper = before[:hinge] if hinge else before
    lower = before[hinge:] if hinge else []
    girdle: list[int] = []
    while len(upper) > 1 and girdle_name.search(names[upper[0]][0]):
        girdle.append(upper.pop(0))
    if not hinges and len(upper) > 1:
        girdle, upper = girdle + upper[:-1], upper[-1:]
    return Limb(side, tuple(girdle), tuple(upper), tuple(lower), end)
