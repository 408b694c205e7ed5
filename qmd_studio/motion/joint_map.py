"""Which joint of one skeleton moves which joints of another: made from the parts they are, editable, kept as JSON.

    {"joint map": 1, "joints": [{"source": "lowerback", "targets": ["vl5", "vl4", "vl3", "vl2", "vl1", "vt12"]}, …]}

with "columns": ["vl5_roll", …] beside it where not all columns of those joints may turn.

A source with several targets below one another spreads its turn over them evenly; side by side, as fingers are, each
of them takes it whole.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from qmd_studio.errors import FormatError
from qmd_studio.motion.bap import bap
from qmd_studio.motion.body_parts import FINGERS, parts_of
from qmd_studio.motion.joint_names import plain_names
from qmd_studio.motion.skeleton import Skeleton

MAX_MAP_BYTES = 1 << 20
_KEY = "joint map"
_VERSION = 1
_HINT = "Save one with qmd retarget --save-map to see what it looks like"

CMU_62 = (
    ("root", "HumanoidRoot"),
    ("lowerback", "vl5"),
    ("upperback", "vt10"),
    ("thorax", "vt1"),
    ("lowerneck", "vc4"),
    ("upperneck", "vc2"),
    ("head", "skullbase"),
    *(
        (side + bone, f"{side}_{joint}")
        for side in "lr"
        for bone, joint in (
            ("clavicle", "sternoclavicular"),
            ("humerus", "shoulder"),
            ("radius", "elbow"),
            ("hand", "wrist"),
            ("fingers", "middle1"),
            ("thumb", "thumb1"),
            ("femur", "hip"),
            ("tibia", "knee"),
            ("foot", "ankle"),
            ("toes", "metatarsal"),
        )
    ),
)
"""CMU's bones to as few H-Anim joints: the motions of 62 columns stay as small as they were."""

CMU_62_BAPS = (
    *(181, 182, 183, 184, 185, 186, 120, 121, 122, 99, 100, 101, 72, 73, 74, 60, 61, 62, 54, 55, 56, 48, 49, 50),
    *(24, 26, 25, 27, 32, 34, 36, 33, 35, 37, 38, 39, 46, 47, 42, 44, 43, 45, 149, 150, 171, 173, 172, 174),
    *(4, 6, 8, 5, 7, 9, 10, 11, 14, 18, 15, 19, 22, 23),
)
"""The parameters that they move, one a column. The forearm's turn is the wrist's twisting: the elbow's, which is
applied after its flexion, would swing the forearm about."""


@dataclass(frozen=True, slots=True)
class JointMap:
    """Pairs (source joint, target joints) by name; a target stands once. Joints that are in no pair stay at rest.

    Where `columns` are given, no others of the target turn.
    """

    pairs: tuple[tuple[str, tuple[str, ...]], ...]
    columns: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        sources = [source for source, _ in self.pairs]
        targets = [target for _, names in self.pairs for target in names]
        for names, what in ((sources, "source"), (targets, "target")):
            twice = next((name for name in names if names.count(name) > 1), None)
            if twice is not None:
                raise FormatError(f"a {what} joint stands in two pairs of the map", at=f"joint {twice!r}")

    def checked(self, source: Skeleton, target: Skeleton) -> JointMap:
        """Return this map; raises `FormatError` where it names a joint that one of the skeletons lacks."""
        sides = (
            ("source", source, [s for s, _ in self.pairs]),
            ("target", target, [t for _, n in self.pairs for t in n]),
        )
        for what, skeleton, names in sides:
            known = {joint.name for joint in skeleton.joints}
            for name in names:
                if name not in known:
                    some = ", ".join(sorted(known)[:12]) + (", …" if len(known) > 12 else "")
                    raise FormatError(f"the map names no joint of the {what}", at=f"joint {name!r}", wanted=some)
        columns = {column.name for column in target.columns}
        for name in self.columns:
            if name not in columns:
                raise FormatError("the map names no column of the target", at=f"column {name!r}")
        return self


def match_joints(source: Skeleton, target: Skeleton) -> JointMap:
    """Return the map between the parts that both skeletons have, and between other joints of one name."""
    ours, theirs = parts_of(source), parts_of(target)
    pairs: dict[int, list[int]] = {ours.root: [theirs.root]}
    for part, joint in ours.named.items():
        if part in theirs.named and part != "head" and joint not in pairs:
            pairs[joint] = [theirs.named[part]]
    _match_chain(pairs, (ours.spine, theirs.spine), (source, target))
    heads = [tuple(j for j in (*side.neck, side.head) if j is not None) for side in (ours, theirs)]
    _match_chain(pairs, (heads[0], heads[1]), (source, target))
    _match_fingers(pairs, ours.named, theirs.named)
    taken = {t for targets in pairs.values() for t in targets}
    _match_rest(pairs, taken, (source, target))
    named = [(source.joints[s].name, tuple(target.joints[t].name for t in ts)) for s, ts in pairs.items() if ts]
    return JointMap(_unique(named, source, target))


def cmu_62_map(source: Skeleton, target: Skeleton) -> JointMap:
    """Return the map of a CMU skeleton to few joints of an H-Anim one: no vertebra but the six, one finger of four.

    Raises `FormatError` where either skeleton has other names.
    """
    columns = tuple(bap(bap_id).name for bap_id in CMU_62_BAPS)
    return JointMap(tuple((bone, (joint,)) for bone, joint in CMU_62), columns).checked(source, target)


def write_joint_map(joint_map: JointMap) -> bytes:
    """Return the map as JSON text, a pair a line."""
    rows = ",\n".join("  " + json.dumps({"source": s, "targets": list(t)}) for s, t in joint_map.pairs)
    columns = f',\n"columns": {json.dumps(list(joint_map.columns))}' if joint_map.columns else ""
    return f'{{"{_KEY}": {_VERSION}, "joints": [\n{rows}\n]{columns}}}\n'.encode()


def read_joint_map(data: bytes) -> JointMap:
    """Return the map in JSON text; raises `FormatError` for anything else, however it is damaged."""
    if len(data) > MAX_MAP_BYTES:
        got = f"{len(data):,} bytes"
        raise FormatError("the file is too large for a joint map", wanted=f"at most {MAX_MAP_BYTES:,} bytes", got=got)
    try:
        content = json.loads(data)
    except (ValueError, RecursionError):
        raise FormatError("the joint map is no JSON text", hint=_HINT) from None
    if not isinstance(content, dict) or content.get(_KEY) != _VERSION or not isinstance(content.get("joints"), list):
        raise FormatError("this is no joint map", wanted=f'"{_KEY}": {_VERSION} and "joints"', hint=_HINT)
    columns = content.get("columns", [])
    if not isinstance(columns, list) or not all(isinstance(name, str) for name in columns):
        raise FormatError("the columns of the joint map are no list of names", at="columns", hint=_HINT)
    pairs = tuple(_pair(row, number) for number, row in enumerate(content["joints"], start=1))
    return JointMap(pairs, tuple(columns))


def _pair(row: object, number: int) -> tuple[str, tuple[str, ...]]:
    targets = row.get("targets") if isinstance(row, dict) else None
    source = row.get("source") if isinstance(row, dict) else None
    fine = isinstance(source, str) and isinstance(targets, list) and all(isinstance(t, str) for t in targets)
    if not fine:
        wanted = '{"source": a name, "targets": [names]}'
        raise FormatError("a pair of the joint map is not one", at=f"pair {number}", wanted=wanted, hint=_HINT)
    return str(source), tuple(str(target) for target in targets or ())


def _match_chain(
    pairs: dict[int, list[int]], chains: tuple[Sequence[int], Sequence[int]], skeletons: tuple[Skeleton, Skeleton]
) -> None:
    """Share the targets of a spine or neck among its sources, in order; with fewer targets some sources have none."""
    sources, targets = chains
    if not sources or not targets:
        return
    n, m = len(sources), len(targets)
    ours = [plain_names(skeletons[0])[j][0] for j in sources]
    theirs = [plain_names(skeletons[1])[j][0] for j in targets]
    if set(ours) <= set(theirs) and 1 < n < m and ours[0] == theirs[0]:  # fewer vertebrae of the same names
        starts = [theirs.index(name) for name in ours]
        owner = [max(i for i, start in enumerate(starts) if start <= k) for k in range(m)]
    elif set(theirs) <= set(ours) and 1 < m < n and ours[0] == theirs[0]:
        following = [*(ours.index(name) for name in theirs[1:]), n]
        owner = [stop - 1 for stop in following]
    elif m >= n:
        owner = [int((k + 0.5) * n / m) for k in range(m)]
    else:
        owner = [int((k + 1) * n / m + 1e-9) - 1 for k in range(m)]
    for target, i in zip(targets, owner, strict=True):
        pairs.setdefault(sources[i], []).append(target)


def _match_fingers(pairs: dict[int, list[int]], ours: Mapping[str, int], theirs: Mapping[str, int]) -> None:
    """Let a hand with one joint for all fingers move four of them, and the other way round."""
    for side in ("l_", "r_"):
        mitten, theirs_mitten = side + "fingers", theirs.get(side + "fingers")
        fingers = [f"{side}{finger}{k}" for finger in FINGERS for k in (1, 2, 3)]
        if mitten in ours and theirs_mitten is None and not any(f"{side}{finger}1" in ours for finger in FINGERS):
            pairs[ours[mitten]] = [theirs[f] for f in fingers if f in theirs]
        elif theirs_mitten is not None and mitten not in ours:
            first = next((ours[f"{side}{f}1"] for f in ("middle", "index") if f"{side}{f}1" in ours), None)
            if first is not None:
                pairs.setdefault(first, []).append(theirs_mitten)


def _match_rest(pairs: dict[int, list[int]], taken: set[int], skeletons: tuple[Skeleton, Skeleton]) -> None:
    """Pair the joints of one name and side that no part has paired, below joints that are paired with each other."""
    source, target = skeletons
    names = plain_names(target)
    free: dict[tuple[str, int], int] = {}
    for joint in range(len(target.joints)):
        if joint not in taken:
            free.setdefault(names[joint], joint)
    for joint, name in enumerate(plain_names(source)):
        other = free.get(name)
        if joint in pairs or other is None or other in taken:
            continue
        above, others_above = source.joints[joint].parent, target.joints[other].parent
        if others_above in pairs.get(above, ()) or (above < 0 and others_above < 0):
            pairs[joint] = [other]
            taken.add(other)


def _unique(
    pairs: list[tuple[str, tuple[str, ...]]], source: Skeleton, target: Skeleton
) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Leave out pairs whose names are another joint's as well, for a map is by name, and a target's second pair."""
    counts = [{j.name: 0 for j in skeleton.joints} for skeleton in (source, target)]
    for count, skeleton in zip(counts, (source, target), strict=True):
        for joint in skeleton.joints:
            count[joint.name] += 1
    taken: set[str] = set()
    kept = []
    for name, targets in pairs:
        if counts[0][name] == 1:
            own = tuple(dict.fromkeys(t for t in targets if counts[1][t] == 1 and t not in taken))
            taken.update(own)
            kept.append((name, own))
    return tuple((name, own) for name, own in kept if own)
