"""Acclaim files: what opens stands where the bones say, what is written reads back equal, what is amiss is named."""

import os
from pathlib import Path

import numpy as np
import pytest

from qmd_studio import registry
from qmd_studio.errors import FormatError
from qmd_studio.formats.asf import FORMAT as SKELETON_FORMAT
from qmd_studio.formats.asf import read_asf
from qmd_studio.formats.asf_amc import FORMAT, companion, read_amc
from qmd_studio.formats.loaded import Loaded, ReadOptions
from qmd_studio.motion.kinematics import point_positions

CORPUS = Path(os.environ.get("QMD_CORPUS", Path(__file__).parents[2] / ".." / "shared" / "corpus"))
needs_corpus = pytest.mark.skipif(not CORPUS.is_dir(), reason="the corpus of real motions is absent (QMD_CORPUS)")

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


def corpus_amcs() -> list[Path]:
    return sorted(CORPUS.glob("*asfamc/*.amc")) + sorted(CORPUS.glob("cmu_derived/*.amc"))


def open_real(path: Path) -> Loaded:
    derived = CORPUS / "cmu_asfamc" / "02.asf" if path.parent.name == "cmu_derived" else None
    return read_amc(path.read_bytes(), ReadOptions(path=path, skeleton=derived))


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


@needs_corpus
@pytest.mark.corpus
@pytest.mark.parametrize("path", corpus_amcs(), ids=lambda path: path.stem)
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


@needs_corpus
@pytest.mark.corpus
def test_cut_off_last_frame_is_left_out_with_its_line_and_count():
    loaded = open_real(CORPUS / "cmu_asfamc" / "07_12.amc")
    assert loaded.motion.n_frames == 244
    assert loaded.warnings == ("Line 7352: the last frame, number 245, has 61 of 62 values and was left out",)


@needs_corpus
@pytest.mark.corpus
def test_cmu_motion_has_62_columns_31_points_and_the_papers_unit():
    loaded = open_real(CORPUS / "cmu_asfamc" / "02_01.amc")
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
