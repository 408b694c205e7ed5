"""The avatars that ship: whole, mirrored, on the ground, and holding together in every anatomical pose."""

from __future__ import annotations

import hashlib
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from qmd_studio.avatar.humanoid import Body
from qmd_studio.motion.bap import Bap, bap_table
from qmd_studio.motion.hanim import hanim_joints, table_rows
from qmd_studio.registry import open_file

FOLDER = Path(__file__).resolve().parents[2] / "avatars"
NAMES = ("ada", "tim")
FILES = [(name, kind) for name in NAMES for kind in ("avatar", "segmented")]
STATURE = {"ada": 1.7504, "tim": 1.20}
FACE_JOINTS = {"temporomandibular"} | {
    f"{side}_{part}_joint" for side in "lr" for part in ("eyeball", "eyelid", "eyebrow")
}
N_PIECES = 16
"""Eyes, upper lids, brows and ten nails; everything else is one skin."""

MOST_STRETCH = 7.0
"""How much longer than at rest an edge of the skin may become in one joint's extreme pose, if over 12 mm by then."""
LEAST_VOLUME = 0.75
"""What share of its volume the skin about a bent elbow, knee or finger keeps at the least."""


@cache
def opened(name: str, kind: str = "avatar"):
    return open_file(FOLDER / name / f"{kind}.x3d")


@cache
def welded(name: str, kind: str = "avatar"):
    """Return the body, places of its own points (n, 3), faces by these, and which point each vertex is."""
    body = opened(name, kind).body
    surface = body.surface
    rows = np.concatenate([surface.vertices, surface.joints, surface.weights], axis=1).astype(np.float64)
    _, first, number = np.unique(np.round(rows, 6), axis=0, return_index=True, return_inverse=True)
    return body, first, number.ravel()[surface.faces]


def pieces(faces: np.ndarray) -> np.ndarray:
    edges = np.concatenate([faces[:, :2], faces[:, 1:]])
    n = faces.max() + 1
    return connected_components(coo_matrix((np.ones(len(edges)), edges.T), shape=(n, n)), directed=False)[1]


def posed(body: Body, angles: dict[str, list[tuple[Bap, float]]]) -> np.ndarray:
    """Return the surface's vertices with joints turned by parameters in radians, by H-Anim's own formula."""
    joints = body.skeleton.joints
    world = np.tile(np.eye(4), (len(joints), 1, 1))
    for number, joint in enumerate(joints):
        turn = np.eye(4)
        turn[:3, 3] = joint.offset
        for parameter, angle in sorted(angles.get(joint.name, []), key=lambda pair: pair[0].applied):
            axis = np.eye(3)[parameter.axis] * parameter.sign
            turn[:3, :3] = Rotation.from_rotvec(axis * angle).as_matrix() @ turn[:3, :3]
        world[number] = turn if joint.parent < 0 else world[joint.parent] @ turn
    moves = np.concatenate([world @ np.linalg.inv(body.bind), [np.eye(4)]])  # the last is the figure itself
    surface = body.surface
    at = np.concatenate([surface.vertices, np.ones((len(surface.vertices), 1))], axis=1).astype(np.float64)
    each = np.einsum("vkij,vj->vki", moves[surface.joints], at)[..., :3]
    return np.einsum("vk,vki->vi", surface.weights.astype(np.float64), each)


def extreme_poses() -> list:
    limited = [p for p in bap_table() if p.joint and p.limits and not p.joint.startswith("r_")]
    return [pytest.param(p, end, id=f"{p.name} {('least', 'most')[end]}") for p in limited for end in (0, 1)]


@pytest.mark.parametrize(("name", "kind"), FILES)
def test_file_opens_without_a_word(name, kind):
    loaded = opened(name, kind)
    assert loaded.warnings == ()
    assert loaded.notes == ()
    assert 15_000 <= len(loaded.body.surface.faces) <= 25_000
    assert (FOLDER / name / f"{kind}.x3d").stat().st_size < 2_000_000


@pytest.mark.parametrize(("name", "kind"), FILES)
def test_every_joint_of_level_three_is_there_under_its_parent(name, kind):
    joints = opened(name, kind).skeleton.joints
    parents = {joint.name: joints[joint.parent].name if joint.parent >= 0 else None for joint in joints}
    assert set(parents) == {joint.name for joint in hanim_joints()} | FACE_JOINTS
    assert all(parents[joint.name] == joint.parent for joint in hanim_joints())
    assert all(parents[name] == "skullbase" for name in FACE_JOINTS)


def test_adult_has_the_standard_centres():
    body = opened("ada").body
    centres = {joint.name: body.bind[i, :3, 3] for i, joint in enumerate(body.skeleton.joints)}
    for joint in hanim_joints():
        np.testing.assert_allclose(centres[joint.name], joint.centre, atol=6e-5)


@pytest.mark.parametrize(("name", "kind"), FILES)
def test_figure_stands_on_the_ground_at_its_stature(name, kind):
    vertices = opened(name, kind).body.surface.vertices
    assert vertices[:, 1].min() == pytest.approx(0.0, abs=5e-4)
    assert vertices[:, 1].max() == pytest.approx(STATURE[name], abs=0.005)
    soles = vertices[vertices[:, 1] < 0.002]
    for side in (1, -1):
        assert np.ptp(soles[side * soles[:, 0] > 0][:, 2]) > 0.12 * STATURE[name]


@pytest.mark.parametrize("name", NAMES)
def test_child_has_a_childs_proportions(name):
    vertices = opened(name).body.surface.vertices
    bind = {joint.name: opened(name).body.bind[i, :3, 3] for i, joint in enumerate(opened(name).skeleton.joints)}
    head = (vertices[:, 1].max() - bind["skullbase"][1]) / vertices[:, 1].max()
    legs = bind["l_hip"][1] / vertices[:, 1].max()
    assert (head, legs) == pytest.approx({"ada": (0.074, 0.521), "tim": (0.102, 0.47)}[name], abs=0.02)


@pytest.mark.parametrize(("name", "kind"), FILES)
def test_each_vertex_follows_at_most_four_joints_that_share_it_whole(name, kind):
    surface = opened(name, kind).body.surface
    assert ((surface.weights > 0).sum(axis=1) <= 4).all()
    np.testing.assert_allclose(surface.weights.sum(axis=1), 1.0, atol=1e-3)
    text = (FOLDER / name / f"{kind}.x3d").read_text(encoding="utf-8")
    written = np.zeros(text.count(" ") // 2)
    for index, weight in re.findall(r"skinCoordIndex='([^']*)' skinCoordWeight='([^']*)'", text):
        np.add.at(written, np.array(index.split(), dtype=int), np.array(weight.split(), dtype=float))
    assert (kind == "avatar") == bool(written.any())
    np.testing.assert_allclose(written[written > 0], 1.0, atol=3e-4)  # as written, before any reader evens them


@pytest.mark.parametrize("name", NAMES)
def test_skin_is_closed_and_in_one_piece_beside_eyes_lids_brows_and_nails(name):
    _, _, faces = welded(name)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    n = faces.max() + 1
    there, back = edges[:, 0] * n + edges[:, 1], edges[:, 1] * n + edges[:, 0]
    assert len(np.unique(there)) == len(there)
    np.testing.assert_array_equal(np.sort(there), np.sort(back))
    sizes = np.sort(np.bincount(pieces(faces)[faces[:, 0]]))
    assert len(sizes) == N_PIECES + 1
    assert sizes[-1] > 0.9 * sizes.sum()


@pytest.mark.parametrize(("name", "kind"), FILES)
def test_left_mirrors_right(name, kind):
    surface = opened(name, kind).body.surface
    away, _ = cKDTree(surface.vertices).query(surface.vertices * (-1, 1, 1))
    limit = 2e-4 if kind == "avatar" else 0.03  # caps hang together with the segment that the spine's slices gave
    assert away.max() < limit


@pytest.mark.parametrize("name", NAMES)
def test_each_segment_is_closed_and_follows_its_joint_alone(name):
    body, first, faces = welded(name, "segmented")
    surface = body.surface
    assert ((surface.weights > 0).sum(axis=1) == 1).all()
    owner = surface.joints[first, 0]
    assert (owner[faces] == owner[faces[:, :1]]).all()
    n = len(first)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    np.testing.assert_array_equal(np.sort(edges @ [n, 1]), np.sort(edges @ [1, n]))
    bare = {joint.name for i, joint in enumerate(body.skeleton.joints) if i not in owner}
    assert {joint[:2] for joint in bare - FACE_JOINTS} <= {"Hu", "vc", "vt", "vl"}  # slices thinner than a triangle


@pytest.mark.parametrize("name", NAMES)
def test_fingers_move_only_their_own_skin(name):
    body = opened(name).body
    rest = body.surface.vertices.astype(np.float64)
    fingers = ("thumb", "index", "middle", "ring", "pinky")
    number = {joint.name: i for i, joint in enumerate(body.skeleton.joints)}
    mine = {f: [number[f"l_{f}{i}"] for i in (2, 3)] for f in fingers}
    for finger in fingers:
        curl = {}
        for parameter in bap_table():
            if parameter.joint and parameter.joint[:-1] == f"l_{finger}" and "flexion" in parameter.name:
                curl.setdefault(parameter.joint, []).append((parameter, parameter.limits[0]))
        moved = np.linalg.norm(posed(body, curl) - rest, axis=1)
        for other in fingers:
            share = np.where(np.isin(body.surface.joints, mine[other]), body.surface.weights, 0).sum(axis=1)
            if other == finger:
                assert moved[share > 0.9].min() > 0.004
            else:
                assert moved[share > 0.5].max() < 0.0015, (finger, other)
        assert moved[body.surface.vertices[:, 0] < 0].max() < 1e-6


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(("parameter", "end"), extreme_poses())
def test_skin_holds_together_at_every_limit(name, parameter, end):
    body = opened(name).body
    faces = body.surface.faces
    rest = body.surface.vertices.astype(np.float64)
    there = posed(body, {parameter.joint: [(parameter, parameter.limits[end])]})
    assert np.isfinite(there).all()
    pairs = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    before = np.linalg.norm(rest[pairs[:, 0]] - rest[pairs[:, 1]], axis=1)
    after = np.linalg.norm(there[pairs[:, 0]] - there[pairs[:, 1]], axis=1)
    worst = np.where(after > 0.012, after / before, 0.0)
    assert worst.max() < MOST_STRETCH, rest[pairs[worst.argmax(), 0]]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize(
    ("bap", "angle"), [("l_elbow_flexion", 150), ("l_knee_flexion", -135), ("l_index2_flexion", -100)]
)
def test_bent_hinge_keeps_its_volume(name, bap, angle):
    body = opened(name).body
    parameter = next(p for p in bap_table() if p.name == bap)
    number = body.skeleton.joint_index(parameter.joint)
    centre = body.bind[number, :3, 3]
    rest = body.surface.vertices.astype(np.float64)
    there = posed(body, {parameter.joint: [(parameter, np.radians(angle))]})
    limb = np.isin(body.surface.joints[:, 0], [number, body.skeleton.joints[number].parent])
    radius = np.linalg.norm((rest - centre)[limb & (np.abs(rest[:, 1] - centre[1]) < 0.01)][:, [0, 2]], axis=1).max()
    near = limb & (np.abs(rest[:, 1] - centre[1]) < 2 * radius)
    kept = near[body.surface.faces].all(axis=1)
    assert kept.sum() > 40

    def volume(points):
        a, b, c = (points[body.surface.faces[kept]][:, i] - centre for i in range(3))
        return float((a * np.cross(b, c)).sum())

    assert volume(there) > LEAST_VOLUME * volume(rest)


@pytest.mark.parametrize("name", NAMES)
def test_files_are_what_the_recipe_beside_them_states(name):
    stated = dict(
        re.findall(r"\| ([\w. ]+?) \| ([0-9a-f]{64}) \|", (FOLDER / name / "PROVENANCE.md").read_text("utf-8"))
    )
    for kind in ("avatar", "segmented"):
        data = (FOLDER / name / f"{kind}.x3d").read_bytes()
        assert hashlib.sha256(data).hexdigest() == stated[f"{kind}.x3d"]
    recipe = hashlib.sha256()
    root = FOLDER.parent
    files = [*sorted((FOLDER / "make").glob("*.py")), *sorted((FOLDER / "make").glob("*.csv"))]
    for path in [*files, *(root / "resources" / "tables" / table for table in ("hanim_joints.csv", "hanim_sites.csv"))]:
        recipe.update(path.name.encode() + b"\0" + path.read_bytes().replace(b"\r\n", b"\n") + b"\0")
    assert recipe.hexdigest() == stated["the program and its tables"], "the recipe changed: run make avatars"
    assert "MIT License" in (FOLDER / name / "LICENSE").read_text("utf-8")
    assert len(table_rows("hanim_joints.csv")) == 87
