"""Acclaim files: what opens stands where the bones say, what is written reads back equal, what is amiss is named."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from scipy.spatial.transform import Rotation

from qmd_studio import registry
from qmd_studio.errors import FormatError
from qmd_studio.formats.asf import FORMAT as SKELETON_FORMAT
from qmd_studio.formats.asf import read_asf
from qmd_studio.formats.asf_amc import FORMAT, companion, read_amc
from qmd_studio.formats.loaded import Loaded, ReadOptions
from qmd_studio.motion.kinematics import point_positions
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import SkeletonKind
from tests.corpus import corpus_file, corpus_files
from tests.formats.damage import assert_ends_well, assert_every_prefix_ends_well, damaged
from tests.generated_motion import walker

ASF = b"""# a leg
:version 1.10
:name LEG
:units
  mass 1.0
  length 0.45
  angle deg
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 0 0 0
   orientation 0 0 0
:bonedata
  begin
     id 1
     name hip
     direction 1 0 0
     length 2
     axis 0 0 0  XYZ
  end
  begin
     id 2
     name thigh
     direction 0 -1 0
     length 8
     axis 0 0 90 XYZ
    dof rx rz
    limits (-160.0 20.0)
           (-inf inf)
  end
  begin
     id 3
     name back
     direction 0 1 0
     length 12
     axis 0 0 0 XYZ
    dof ry
  end
:hierarchy
  begin
    root hip back
    hip thigh
  end
"""
AMC = b"""# two frames
:FULLY-SPECIFIED
:DEGREES
1
root 0 10 0 0 0 0
back 5
thigh 0 0
2
root 1 10 -1.5e-001 0 90 0
back -5
thigh 30 0
"""


def opened(tmp_path: Path, amc: bytes = AMC, asf: bytes = ASF, **options) -> Loaded:
    (tmp_path / "leg.asf").write_bytes(asf)
    return read_amc(amc, ReadOptions(path=tmp_path / "leg.amc", **options))


def open_real(path: Path) -> Loaded:
    given = corpus_file("cmu_asfamc/02.asf") if path.parent.name == "cmu_derived" else None
    return registry.open_file(path, ReadOptions(skeleton=given))


def test_columns_keep_the_order_of_the_amc_with_levels_by_depth(tmp_path):
    skeleton = opened(tmp_path).skeleton
    names = ["root tx", "root ty", "root tz", "root rx", "root ry", "root rz", "back ry", "thigh rx", "thigh rz"]
    assert [column.name for column in skeleton.columns] == names
    assert skeleton.levels == (1, 1, 1, 1, 1, 1, 2, 3, 3)
    assert skeleton.columns[7].limits == pytest.approx((np.radians(-160), np.radians(20)))
    assert skeleton.columns[8].limits is None


def test_points_are_the_root_and_the_far_end_of_each_bone(tmp_path):
    motion = opened(tmp_path).motion
    unit = 0.0254 / 0.45
    assert motion.skeleton.point_names == ("root", "thigh", "thigh end", "back end")
    first, second = point_positions(motion.skeleton, motion.X) / unit
    np.testing.assert_allclose(first, [[0, 10, 0], [2, 10, 0], [2, 2, 0], [0, 22, 0]], atol=1e-12)
    # a quarter turn to the left takes x to -z; the thigh's own x axis points along the world's y, so it doesn't swing
    np.testing.assert_allclose(second, [[1, 10, -0.15], [1, 10, -2.15], [1, 2, -2.15], [1, 22, -0.15]], atol=1e-12)


def test_frame_rate_is_120_unless_said_otherwise(tmp_path):
    assert opened(tmp_path).motion.fps == 120
    assert opened(tmp_path, fps=30.0).motion.fps == 30
    said = b":SAMPLES-PER-SECOND 60\n" + AMC
    assert opened(tmp_path, said).motion.fps == 60
    assert opened(tmp_path, said, fps=30.0).motion.fps == 30
    with pytest.raises(FormatError, match="frame rate"):
        opened(tmp_path, said.replace(b"60", b"-60"))
    with pytest.raises(FormatError, match="frame rate"):
        opened(tmp_path, fps=0.0)


def test_frame_rate_other_than_120_survives_writing(tmp_path):
    motion = opened(tmp_path, fps=30000 / 1001).motion
    written = FORMAT.write(motion)
    assert FORMAT.sniff(written)
    again = opened(tmp_path, written).motion
    assert again.fps == motion.fps
    assert FORMAT.write(again) == written


def walk_out(asf: str, amc: str, n_frames: int) -> np.ndarray:
    """Return root and bone ends (n_frames, 31, 3) in file units by G = G_parent C M C^-1, read by other means."""

    def turn(x, y, z):
        return Rotation.from_euler("xyz", [x, y, z], degrees=True).as_matrix()  # about fixed axes: Rz Ry Rx

    bones = {}
    for block in re.findall(r"begin\s+id.*?end\n", asf, flags=re.DOTALL):
        field = {key: rest.split() for key, rest in re.findall(r"(name|direction|length|axis|dof) +(.*)", block)}
        direction, axis = (np.array(field[key][:3], dtype=float) for key in ("direction", "axis"))
        bones[field["name"][0]] = (direction * float(field["length"][0]), turn(*axis), field.get("dof", []))
    tree = [line.split() for line in asf[asf.index(":hierarchy") :].splitlines() if len(line.split()) > 1]
    frames = re.split(r"^\d+\s*$", amc, flags=re.MULTILINE)[1 : n_frames + 1]
    result = []
    for frame in frames:
        values = {line.split()[0]: [float(word) for word in line.split()[1:]] for line in frame.strip().splitlines()}
        turned, ends = {"root": turn(*values["root"][3:])}, {"root": np.array(values["root"][:3])}
        for parent, *children in tree:
            for child in children:
                vector, own, dofs = bones[child]
                angles = dict(zip(dofs, values.get(child, []), strict=True))
                moved = turn(*(angles.get(f"r{letter}", 0.0) for letter in "xyz"))
                turned[child] = turned[parent] @ own @ moved @ np.linalg.inv(own)
                ends[child] = ends[parent] + turned[child] @ vector
        result.append([ends[name] for name in ("root", *bones)])
    return np.array(result)


@pytest.mark.corpus
@pytest.mark.parametrize("name", ["02_01", "49_08"])
def test_points_stand_where_the_acclaim_formula_puts_root_and_bone_ends(name):
    amc, asf = corpus_file(f"cmu_asfamc/{name}.amc"), corpus_file(f"cmu_asfamc/{name[:2]}.asf")
    wanted = walk_out(asf.read_text(), amc.read_text(), 5)
    motion = open_real(amc).motion
    got = point_positions(motion.skeleton, motion.X[:5]) / motion.skeleton.metres_per_unit
    assert got.shape == wanted.shape == (5, 31, 3)
    for ours, theirs in zip(got, wanted, strict=True):  # as sets: the order of points is ours to choose
        away = np.linalg.norm(ours[:, None] - theirs[None], axis=2)
        assert away.min(axis=0).max() < 1e-9
        assert away.min(axis=1).max() < 1e-9
        assert len(np.unique(away.argmin(axis=1))) == 31


@pytest.mark.corpus
@pytest.mark.parametrize("path", corpus_files("*/*.amc"))
def test_every_real_motion_opens_and_survives_writing(path, tmp_path):
    loaded = open_real(path)
    motion = loaded.motion
    written = FORMAT.write(motion)
    beside, skeleton = companion(tmp_path / "again.amc", motion)
    beside.write_bytes(skeleton)
    again = read_amc(written, ReadOptions(path=tmp_path / "again.amc")).motion
    np.testing.assert_allclose(again.X, motion.X, rtol=0, atol=1e-9)
    assert FORMAT.write(again) == written
    step = max(1, motion.n_frames // 20)
    ours, theirs = (point_positions(m.skeleton, m.X[::step]) for m in (motion, again))
    np.testing.assert_allclose(theirs, ours, rtol=0, atol=1e-9)
    assert again.skeleton.levels == motion.skeleton.levels
    assert again.skeleton.point_names == motion.skeleton.point_names


@pytest.mark.corpus
def test_cut_off_last_frame_is_left_out_with_its_line_and_count():
    loaded = open_real(corpus_file("cmu_asfamc/07_12.amc"))
    assert loaded.motion.n_frames == 244
    assert loaded.warnings == ("Line 7352: the last frame, number 245, has 61 of 62 values and was left out",)


@pytest.mark.corpus
def test_cmu_motion_has_62_columns_31_points_and_the_papers_unit():
    loaded = open_real(corpus_file("cmu_asfamc/02_01.amc"))
    assert loaded.motion.X.shape == (343, 62)
    assert len(loaded.skeleton.points) == 31
    assert loaded.skeleton.metres_per_unit == pytest.approx(0.056444, abs=1e-6)


def test_no_skeleton_is_an_error_with_the_way_out(tmp_path):
    with pytest.raises(FormatError, match="no skeleton") as caught:
        read_amc(AMC, ReadOptions(path=tmp_path / "leg.amc"))
    assert "--skeleton" in caught.value.hint


def test_skeleton_alone_opens_at_rest():
    loaded = read_asf(ASF, ReadOptions())
    assert loaded.motion.n_frames == 1
    assert not loaded.motion.X.any()


def test_content_tells_motion_and_skeleton_apart():
    assert FORMAT.sniff(AMC)
    assert not FORMAT.sniff(ASF)
    assert SKELETON_FORMAT.sniff(ASF)
    assert not SKELETON_FORMAT.sniff(AMC)


def test_saving_a_motion_puts_its_skeleton_beside_it_once(tmp_path):
    motion = opened(tmp_path).motion
    out = tmp_path / "out"
    out.mkdir()
    registry.save_motion(out / "copy.amc", motion)
    np.testing.assert_allclose(registry.open_file(out / "copy.amc").motion.X, motion.X, rtol=0, atol=1e-12)
    (out / "copy.asf").write_bytes(ASF)
    registry.save_motion(out / "copy.amc", motion)
    assert (out / "copy.asf").read_bytes() == ASF


def test_line_ends_comments_and_radians_do_not_matter(tmp_path):
    plain = opened(tmp_path).motion
    for changed in (
        AMC.replace(b"\n", b"\r\n"),
        AMC.replace(b"\n", b"\r"),
        b"\xef\xbb\xbf" + AMC,
        AMC.replace(b"\n2\n", b" # the end of it\n\n# next\n2\n"),
    ):
        again = opened(tmp_path, changed).motion
        np.testing.assert_array_equal(again.X, plain.X)
    turned = AMC.replace(b":DEGREES", b":RADIANS").replace(b"thigh 30", b"thigh 0.5")
    assert opened(tmp_path, turned).motion.X[1, 7] == 0.5


def test_bones_may_change_their_order_from_frame_to_frame(tmp_path):
    shuffled = AMC.replace(b"back -5\nthigh 30 0", b"thigh 30 0\nback -5")
    np.testing.assert_array_equal(opened(tmp_path, shuffled).motion.X, opened(tmp_path).motion.X)


@pytest.mark.parametrize(
    ("amc", "line", "words"),
    [
        (AMC.replace(b"back ", b"neck "), 6, "bone neck"),
        (AMC.replace(b"back 5", b"back 5 6").replace(b"back -5", b"back -5 6"), 6, "1 values"),
        (AMC.replace(b"back 5\n", b"").replace(b"back -5\n", b""), 6, "no line for back"),
        (AMC.replace(b"back 5", b"back five"), 6, "five"),
        (AMC.replace(b"back -5", b"back nan") + b"3\nroot 0 0 0 0 0 0\n", 10, "nan"),
        (AMC.replace(b"back -5", b"back 1_0"), 10, "1_0"),
        (AMC.replace(b"root 1 10", b"root 1e300 10"), 9, "1e300"),
        (AMC.replace(b"back -5\n", b"") + AMC[AMC.index(b"2\n") :], 10, "frame 2 has no line for back"),
        (AMC.replace(b"thigh 0 0", b"thigh 0"), 7, "1"),
        (AMC.replace(b"back -5", b"back -5\nback -5"), 11, "twice"),
        (AMC.replace(b"back -5", b"spine -5"), 10, "spine"),
    ],
)
def test_mismatch_is_an_error_with_its_line(tmp_path, amc, line, words):
    with pytest.raises(FormatError) as caught:
        opened(tmp_path, amc)
    assert caught.value.at == f"line {line}"
    assert words in str(caught.value)


@pytest.mark.parametrize("lost", [1, 4, 5, 8, 11, 14, 20, 30, 35])
def test_cut_off_last_frame_leaves_the_frames_before(tmp_path, lost):
    loaded = opened(tmp_path, AMC[:-lost])
    if lost > 3:
        assert loaded.motion.n_frames == 1
        assert "left out" in loaded.warnings[0]


def test_jump_in_frame_numbers_is_a_warning(tmp_path):
    loaded = opened(tmp_path, AMC.replace(b"\n2\n", b"\n12\n"))
    assert loaded.motion.n_frames == 2
    assert "1 is followed by 12" in loaded.warnings[0]


@pytest.mark.parametrize(
    ("asf", "words"),
    [
        (ASF.replace(b"    hip thigh\n", b"    thigh hip\n    hip thigh\n"), "two parents"),
        (ASF.replace(b"root hip back", b"root back"), "does not hang from the root"),
        (ASF.replace(b"root hip back", b"root back\n    thigh hip"), "does not hang from the root"),
        (ASF.replace(b"hip thigh\n", b"hip thigh tail\n"), "unknown bone"),
        (ASF.replace(b"hip thigh\n", b"hip thigh root\n"), "two parents"),
        (ASF.replace(b"name thigh", b"name hip"), "defined twice"),
        (ASF.replace(b"length 8", b"length nan"), "cannot be used"),
        (ASF.replace(b"length 0.45", b"length 0"), "not positive"),
        (ASF.replace(b"direction 0 -1 0", b"direction 0 -1"), "missing"),
        (ASF.replace(b"dof rx rz", b"dof rx rx"), "degree of freedom"),
        (ASF.replace(b"dof rx rz", b"dof rx l"), "degree of freedom"),
        (ASF.replace(b"90 XYZ", b"90 XYX"), "order of axes"),
        (ASF.replace(b"angle deg", b"angle grad"), "angle unit"),
        (ASF[: ASF.index(b":hierarchy")], "lacks a section"),
    ],
)
def test_broken_skeleton_is_an_error_that_names_its_file(tmp_path, asf, words):
    with pytest.raises(FormatError, match=words) as caught:
        opened(tmp_path, asf=asf)
    assert caught.value.path == tmp_path / "leg.asf"


def test_skeleton_is_found_by_name_then_subject_then_alone(tmp_path):
    def found(*names):
        folder = tmp_path / "-".join(names)
        folder.mkdir()
        for name in names:
            (folder / name).write_bytes(ASF)
        (folder / "02_01.amc").write_bytes(AMC)
        return registry.open_file(folder / "02_01.amc").notes[0]

    assert found("02_01.asf", "02.asf", "other.asf") == "Skeleton from 02_01.asf"
    assert found("02.ASF", "other.asf") == "Skeleton from 02.ASF"
    assert found("other.asf") == "Skeleton from other.asf"
    with pytest.raises(FormatError, match=r"2 \.asf files of other names"):
        found("one.asf", "two.asf")


def test_length_unit_is_the_one_that_makes_a_person(tmp_path):
    by_rule = opened(tmp_path)
    assert by_rule.skeleton.metres_per_unit == pytest.approx(0.0254 / 0.45)
    metres = ASF.replace(b"length 0.45", b"length 0.01").replace(b"length 8", b"length 0.8").replace(b"h 12", b"h 0.8")
    guessed = opened(tmp_path, asf=metres.replace(b"length 2", b"length 0.2"))
    assert guessed.skeleton.metres_per_unit == 1.0
    assert "metre" in guessed.notes[0]
    assert opened(tmp_path, metres_per_unit=0.5).skeleton.metres_per_unit == 0.5
    with pytest.raises(FormatError):
        opened(tmp_path, metres_per_unit=-1.0)


def test_written_skeleton_keeps_frames_limits_and_unit(tmp_path):
    odd = ASF.replace(b"axis 0 0 90 XYZ", b"axis 20 -90 35 ZXY").replace(b"dof rx rz", b"dof rz rx")
    amc = AMC.replace(b"thigh 30 0", b"thigh 30 -40")
    motion = opened(tmp_path, amc, odd, metres_per_unit=0.031).motion
    (tmp_path / "leg.asf").unlink()
    registry.save_motion(tmp_path / "leg.amc", motion)
    again = registry.open_file(tmp_path / "leg.amc").motion
    assert again.skeleton.metres_per_unit == 0.031
    assert again.skeleton.points == motion.skeleton.points
    for ours, theirs in zip(motion.skeleton.columns, again.skeleton.columns, strict=True):
        assert (theirs.name, theirs.joint, theirs.axis, theirs.level) == (ours.name, ours.joint, ours.axis, ours.level)
        assert theirs.limits == (pytest.approx(ours.limits) if ours.limits else None)
    wanted, got = (point_positions(m.skeleton, m.X) for m in (motion, again))
    np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-9)


def test_other_skeletons_are_not_written_as_acclaim(tmp_path):
    motion = opened(tmp_path).motion
    other = Motion(replace(motion.skeleton, kind=SkeletonKind.BVH), motion.X, 30.0)
    with pytest.raises(FormatError, match="retargeted"):
        registry.save_motion(tmp_path / "x.amc", other)
    with pytest.raises(FormatError, match="retargeted"):
        registry.save_motion(tmp_path / "x.asf", other)
    assert not list(tmp_path.glob("x.*"))


@pytest.mark.parametrize("name", ["two words", "a#b", "line\nbreak", "", "root", "thigh"])
def test_names_that_would_not_read_back_are_not_written(tmp_path, name):
    motion = opened(tmp_path).motion
    joints = tuple(replace(j, name=name) if j.name == "back" else j for j in motion.skeleton.joints)
    other = replace(motion, skeleton=replace(motion.skeleton, joints=joints))
    with pytest.raises(FormatError, match="Acclaim"):
        FORMAT.write(other)
    with pytest.raises(FormatError, match="Acclaim"):
        SKELETON_FORMAT.write(other)


def test_numbers_that_would_not_read_back_are_not_written(tmp_path):
    motion = opened(tmp_path).motion
    X = motion.X.copy()
    X[0, 6] = 1e11
    with pytest.raises(FormatError, match="too large for an Acclaim file"):
        FORMAT.write(replace(motion, X=X))
    joints = (replace(motion.skeleton.joints[0], offset=(0.0, 1e11, 0.0)), *motion.skeleton.joints[1:])
    far = replace(motion.skeleton, joints=joints)
    with pytest.raises(FormatError, match="too large for an Acclaim file"):
        SKELETON_FORMAT.write(replace(motion, skeleton=far, X=0 * motion.X))


def test_name_of_several_lines_is_written_as_one(tmp_path):
    motion = opened(tmp_path).motion
    named = replace(motion.skeleton, name="a\n:root\n  order")
    data = SKELETON_FORMAT.write(replace(motion, skeleton=named, X=0 * motion.X))
    assert SKELETON_FORMAT.read(data, ReadOptions()).skeleton.name == "a :root order"


def test_columns_that_acclaim_has_no_words_for_are_not_written(tmp_path):
    motion = opened(tmp_path).motion
    columns = motion.skeleton.columns
    back = columns[6]
    for changed in (
        (*columns[:6], replace(back, sign=-1), *columns[7:]),
        (*columns[:3], replace(columns[3], rest=0.5), *columns[4:]),
        (*columns[:2], replace(columns[2], joint=2, name="thigh tz"), *columns[3:]),
    ):
        with pytest.raises(FormatError, match="column"):
            FORMAT.write(replace(motion, skeleton=replace(motion.skeleton, columns=changed)))


def test_every_prefix_of_motion_and_skeleton_ends_well(tmp_path):
    (tmp_path / "leg.asf").write_bytes(ASF)
    options = ReadOptions(path=tmp_path / "leg.amc")
    assert_every_prefix_ends_well(lambda data: read_amc(data, options), AMC)
    assert_every_prefix_ends_well(lambda data: read_asf(data, ReadOptions()), ASF)


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(amc=damaged(AMC))
def test_damaged_motion_ends_well(tmp_path, amc):
    (tmp_path / "leg.asf").write_bytes(ASF)
    assert_ends_well(lambda data: read_amc(data, ReadOptions(path=tmp_path / "leg.amc")), amc)


@settings(max_examples=150, deadline=None)
@given(asf=damaged(ASF))
def test_damaged_skeleton_ends_well(asf):
    def read(data):
        loaded = read_asf(data, ReadOptions())
        assert np.isfinite(point_positions(loaded.skeleton, loaded.motion.X)).all()

    assert_ends_well(read, asf)


@pytest.mark.parametrize(
    "amc",
    [
        b"1\n" * 32_000,
        b"1\nroot" + b" 1" * 30_000,
        b"1\n" + b"".join(b"b%d 1\n" % k for k in range(8_000)),
        b"1\nroot 1\n" * 6_000 + b"9" * 5_000,
        b"1\nroot " + b"9" * 60_000,
    ],
)
def test_absurd_motions_end_well(tmp_path, amc):
    (tmp_path / "leg.asf").write_bytes(ASF)
    problem = assert_ends_well(lambda data: read_amc(data, ReadOptions(path=tmp_path / "leg.amc")), amc)
    assert isinstance(problem, FormatError)


def test_long_chain_of_bones_ends_well():
    bones = b"".join(b"begin\nname %d\ndirection 1 0 0\nlength 1\nend\n" % k for k in range(1_000))
    chain = b"".join(b"%d %d\n" % (k, k + 1) for k in range(999))
    asf = b":root\n:bonedata\n" + bones + b":hierarchy\nroot 0\n" + chain
    loaded = assert_ends_well(lambda data: read_asf(data, ReadOptions()), asf)
    assert len(loaded.skeleton.joints) == 1_001


def test_generated_walk_comes_back_from_acclaim_as_it_was(tmp_path):
    motion = walker(40)
    registry.save_motion(tmp_path / "walk.amc", motion)
    again = registry.open_file(tmp_path / "walk.amc").motion
    np.testing.assert_allclose(again.X, motion.X, rtol=0, atol=1e-9)
    ours, theirs = (
        dict(zip(m.skeleton.point_names, point_positions(m.skeleton, m.X).transpose(1, 0, 2), strict=True))
        for m in (motion, again)
    )
    for name, places in ours.items():
        np.testing.assert_allclose(theirs[name.replace("_end", " end")], places, rtol=0, atol=1e-9)
