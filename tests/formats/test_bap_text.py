"""BAP text opens in every variant, comes back as it was, and what it cannot mean is refused with its line."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.errors import FormatError
from qmd_studio.formats.bap_text import FORMAT
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.bap import bap_skeleton, bap_table, column_of
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, Joint, Skeleton, SkeletonKind
from qmd_studio.registry import encode_motion, open_file, save_motion
from tests.corpus import corpus_file, corpus_files
from tests.formats.damage import assert_ends_well, assert_every_prefix_ends_well, damaged


def read(text, **options):
    return FORMAT.read(text if isinstance(text, bytes) else text.encode(), ReadOptions(**options))


def mask(*bap_ids, n=186):
    return " ".join("1" if place in bap_ids else "0" for place in range(1, n + 1))


def column(motion, bap_id):
    return motion.X[:, column_of(bap_id)]


GOLDEN = f"""# two arms and a step
3.1 small.bap 25 3
{mask(34, 39, 181)}
0 -17453 0 12
# the right elbow only
{mask(39)}
1 34907
{mask()}
2
"""


def test_a_plain_file_has_its_values_in_radians_and_metres():
    motion = read(GOLDEN).motion
    assert (motion.name, motion.fps, motion.X.shape) == ("small.bap", 25.0, (3, 186))
    assert column(motion, 34)[0] == pytest.approx(-0.17453)
    assert column(motion, 181)[0] == pytest.approx(0.012)
    assert read(GOLDEN).warnings == ()


def test_what_a_frame_leaves_out_holds_its_last_value_and_the_mask_remembers():
    motion = read(GOLDEN).motion
    assert column(motion, 34) == pytest.approx([-0.17453] * 3)
    assert column(motion, 39) == pytest.approx([0.0, 0.34907, 0.34907])
    assert motion.mask[:, column_of(39)].tolist() == [True, True, False]
    assert motion.mask.sum() == 4


def test_before_its_first_value_a_parameter_is_zero():
    motion = read(f"3.1 x 25 2\n{mask(10)}\n0 5\n{mask(10, 34)}\n1 6 7\n").motion
    assert column(motion, 34) == pytest.approx([0.0, 7e-5])


@pytest.mark.parametrize(
    ("text", "name", "fps"),
    [
        (f"3.1 a man walks.bap 30 1\n{mask(1)}\n0 4\n", "a man walks.bap", 30),
        (f"3.1 x 29.97 1\n{mask(1)}\n0 4\n", "x", 29.97),
        (f"3.1 walk#2 30 1\r\n{mask(1)} \r\n0 4 \r\n", "walk#2", 30),
        (f"3.1 x 30 1\r{mask(1)}\r0 4", "x", 30),
        (f"# a\n\n# b\n3.2\tx\t30\t1\n\n#c\n{mask(1)}\n  # d\n0 4.0 # e\n\n# f", "x", 30),
        (f"\ufeff3.1 x 30 1\n{mask(1)}\n0 +4.\n", "x", 30),
        (f"2.1 x 30 1\n{mask(1, n=295)} \n0 4 \n", "x", 30),
        (f"3.2 x 30 1\n{mask(1, n=296)}\n0 4\n", "x", 30),
        (f"3.1 x 30 1\n{mask(1, n=40)}\n0 4\n", "x", 30),
    ],
)
def test_variants_open_without_a_warning(text, name, fps):
    loaded = read(text)
    assert (loaded.motion.name, loaded.motion.fps) == (name, fps)
    assert loaded.warnings == ()
    assert loaded.motion.X.shape == (1, 186)
    assert column(loaded.motion, 1)[0] == pytest.approx(4e-5)


def test_old_numbering_of_169_is_translated():
    loaded = read(f"3.0 x 25 1\n{mask(48, 98, 167, n=169)}\n0 11 22 33\n")
    assert [column(loaded.motion, bap_id)[0] for bap_id in (125, 51, 120)] == pytest.approx([11e-5, 22e-5, 33e-5])
    assert loaded.motion.mask.sum() == 3
    assert "older numbering" in loaded.notes[0]


def test_extensions_are_opaque_columns_only_where_a_file_uses_them():
    loaded = read(f"3.2 x 25 1\n{mask(34, 200, n=296)}\n0 7 1234\n")
    assert loaded.skeleton == bap_skeleton(extensions=True)
    assert column(loaded.motion, 200)[0] == 1234.0
    assert loaded.skeleton.columns[column_of(200)].kind is ColumnKind.OPAQUE


def test_values_with_decimals_are_kept_and_rounded_when_written():
    motion = read(f"3.1 x 25 1\n{mask(34)}\n0 100.6\n").motion
    assert column(motion, 34)[0] == pytest.approx(100.6e-5)
    assert FORMAT.write(motion).endswith(b"\n0 101\n")


@pytest.mark.parametrize("count", ["7", "2147483648", "-1", "0", "1e308"])
def test_a_wrong_number_of_frames_is_a_warning(count):
    loaded = read(f"3.1 x 25 {count}\n{mask(1)}\n0 4\n{mask(1)}\n1 5\n")
    assert loaded.motion.n_frames == 2
    assert "holds 2" in loaded.warnings[0]


def test_a_missing_number_of_frames_is_a_warning():
    loaded = read(f"3.1 x 25\n{mask(1)}\n0 4\n")
    assert (loaded.motion.fps, loaded.motion.name) == (25.0, "x")
    assert "no number of frames" in loaded.warnings[0]


def test_frame_numbers_with_an_even_step_divide_the_rate():
    loaded = read(f"3.1 x 30 3\n{mask(1)}\n0 1\n{mask(1)}\n3 2\n{mask(1)}\n6 3\n")
    assert (loaded.motion.n_frames, loaded.motion.fps) == (3, 10.0)
    assert "by 3" in loaded.notes[1]
    assert read(f"3.1 x 30 3\n{mask(1)}\n0 1\n{mask(1)}\n3 2\n{mask(1)}\n6 3\n", fps=24).motion.fps == 24


def test_over_skipped_frame_numbers_the_pose_is_held():
    loaded = read(f"3.1 x 30 3\n{mask(1)}\n5 1\n{mask(1)}\n6 2\n{mask(1)}\n9 3\n")
    assert column(loaded.motion, 1) == pytest.approx([1e-5, 2e-5, 2e-5, 2e-5, 3e-5])
    assert loaded.motion.mask[:, column_of(1)].tolist() == [True, True, False, False, True]
    assert "Line 7" in loaded.warnings[0]


def test_frame_numbers_that_go_back_are_read_as_they_come():
    loaded = read(f"3.1 x 30 2\n{mask(1)}\n4 1\n{mask(1)}\n4 2\n")
    assert column(loaded.motion, 1) == pytest.approx([1e-5, 2e-5])
    assert "Line 5" in loaded.warnings[0]


def test_frame_numbers_far_apart_are_refused():
    with pytest.raises(FormatError, match="line 7: too many frames are missing"):
        read(f"3.1 x 30 3\n{mask(1)}\n0 1\n{mask(1)}\n1 2\n{mask(1)}\n2147483000 3\n")


@pytest.mark.parametrize(
    ("end", "what"),
    [
        (mask(1, 2), "186 of 186"),
        (mask(1, 2) + "\n", "186 of 186"),
        (mask(1, 2)[:50], "25 of 186"),
        (mask(1, 2) + "\n2 5", "1 of 2"),
        (mask(1, 2) + "\n2 5\n# end\n", "1 of 2"),
        (mask(1, 2) + "\n2 5 -", "1 of 2"),
        (mask(1, 2) + "\n2 5 1e", "1 of 2"),
        (mask(1, 2) + "\n2", "0 of 2"),
    ],
)
def test_an_incomplete_last_frame_is_dropped_with_its_line(end, what):
    loaded = read(f"3.1 x 25 1\n{mask(1)}\n0 4\n" + end)
    assert loaded.motion.n_frames == 1
    assert what in loaded.warnings[0]
    assert loaded.warnings[0].startswith("Line 4" if "186" in what else "Line 5")


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("", "wanted version"),
        ("# nothing\n", "wanted version"),
        ("HIERARCHY\nROOT hips\n", "line 1"),
        ("3.1 x 25 1\n", "no complete frame"),
        (f"3.1 x 0 1\n{mask(1)}\n0 4\n", "line 1.*frame rate"),
        (f"3.1 x nan 1\n{mask(1)}\n0 4\n", "line 1.*frame rate"),
        (f"3.1 x\n{mask(1)}\n0 4\n", "line 1"),
        (f"3.1 x 25 0\n{mask(1)}\n", "no complete frame"),
        (f"3.1 x 25 1\n{mask(1)} 2\n0 4\n", "line 2.*0 or 1; got '2'"),
        (f"3.1 x 25 1\n{mask(1)}\n0 nan\n", "line 3.*not a number"),
        (f"3.1 x 25 1\n{mask(1)}\n0 inf\n", "line 3.*not a number"),
        (f"3.1 x 25 1\n{mask(1)}\n0 1e999\n", "line 3.*not a number"),
        (f"3.1 x 25 1\n{mask(1)}\n0 arm\n", "line 3.*'arm'"),
        (f"3.1 x 25 1\n{mask(1)}\n0 4 5\n", "line 3.*1 values; got 2"),
        (f"3.1 x 25 2\n{mask(1)}\n0\n{mask(1)}\n1 4\n", "line 3.*got 0"),
        (f"3.1 x 25 2\n{mask(1)}\n0 4\n{mask(1, n=180)}\n1 4\n", "line 4.*wanted 186.*got 180"),
        (f"3.1 x 25 1\n{mask(1)}\n0.5 4\n", "line 3.*frame number"),
        (f"3.1 x 25 1\n{mask(1)}\n-1 4\n", "line 3.*frame number"),
        (f"3.1 x 25 1\n{mask(1, n=297)}\n0 4\n", "line 2.*at most 296"),
        (f"2.1 x 25 1\n{mask(3, n=68)}\n0 4\n", "line 2.*face"),
    ],
)
def test_what_does_not_fit_is_refused_with_its_place(text, place):
    with pytest.raises(FormatError, match=place):
        read(text)


def test_the_rate_can_be_said_where_the_header_has_none():
    assert read(f"3.1 x 0 1\n{mask(1)}\n0 4\n", fps=12).motion.fps == 12


def test_every_prefix_ends_well():
    assert_every_prefix_ends_well(read, GOLDEN.encode())


@settings(max_examples=150, deadline=None)
@given(damaged(GOLDEN.encode()))
def test_damage_ends_well(data):
    assert_ends_well(read, data)


@pytest.mark.parametrize("frame", ["1\n{0} 3\n", "0\n{0}\n"])
def test_many_tiny_frames_stay_within_bounds(frame):
    text = "3.1 x 30 2147483648\n" + "".join(frame.format(number) for number in range(8000))
    assert read(text[: 64 << 10]).motion.n_frames > 5000
    assert_ends_well(read, text[: 64 << 10].encode())


@pytest.mark.parametrize(
    "data",
    [
        b"3.1 x 30 1\n1\n0 " + b"9" * 65000,
        b"3.1 " + b"9" * 65000,
        b"3.1 x 30 1\n" + b"1 " * 32000,
        b"3.1 x 1e-320 2\n1\n0 1\n1\n5 1\n1\n10 1\n",
        b"\r" * 65536,
        b"\x00" * 65536,
    ],
)
def test_absurd_files_are_refused_in_time(data):
    assert isinstance(assert_ends_well(read, data), FormatError)


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_a_written_motion_reads_as_it_was(data):
    skeleton = bap_skeleton(extensions=data.draw(st.booleans()))
    n_frames = data.draw(st.integers(1, 5))
    rng = np.random.default_rng(data.draw(st.integers(0, 2**32)))
    raw = rng.integers(-400_000, 400_000, (n_frames, skeleton.n_columns))
    si = np.array([bap_table()[c.bap_id - 1].si_per_unit for c in skeleton.columns])
    given = rng.random(raw.shape) < data.draw(st.sampled_from((0.05, 0.5, 1.0)))
    given[0, -1] = True
    fps = data.draw(st.sampled_from((25.0, 29.97, 1 / 3, 120.0)))
    first = read(FORMAT.write(Motion(skeleton, raw * si, fps, name="m", mask=given)))
    np.testing.assert_array_equal(np.rint(first.motion.X / si), raw)
    second = read(FORMAT.write(first.motion))
    np.testing.assert_array_equal(first.motion.X, second.motion.X)
    np.testing.assert_array_equal(first.motion.mask, second.motion.mask)
    assert first.motion.skeleton == second.motion.skeleton
    assert first.motion.fps == second.motion.fps == fps
    assert first.warnings == second.warnings == ()


def test_golden_comes_back_with_its_mask():
    first = read(GOLDEN).motion
    again = read(FORMAT.write(first)).motion
    assert np.array_equal(first.X, again.X)
    assert np.array_equal(first.mask, again.mask)
    assert FORMAT.write(again) == FORMAT.write(first)


def test_a_value_that_was_edited_is_written_though_the_mask_left_it_out():
    motion = read(GOLDEN).motion
    X = motion.X.copy()
    X[2, column_of(34)] = 0.5
    again = read(FORMAT.write(motion.with_values(X))).motion
    np.testing.assert_allclose(again.X, X, atol=5e-6)


def test_names_with_blanks_and_hashes_cannot_break_the_header():
    motion = Motion(bap_skeleton(), np.zeros((1, 186)), 25.0, name="# my walk \n 7")
    assert read(FORMAT.write(motion)).motion.fps == 25.0


def test_a_motion_on_another_skeleton_is_refused_with_that_reason():
    columns = (Column("Xrotation", 0, ColumnKind.ROTATION, 0),)
    skeleton = Skeleton("bvh", SkeletonKind.BVH, (Joint("Hips", -1, (0, 0, 0), (0,)),), (), columns, (0,))
    with pytest.raises(FormatError, match="retargeting"):
        encode_motion(".bap", Motion(skeleton, np.zeros((1, 1)), 25.0))


def test_a_value_too_large_is_refused_with_its_place():
    X = np.zeros((2, 186))
    X[1, column_of(34)] = 1e6
    with pytest.raises(FormatError, match="frame 1, column l_shoulder_abduct"):
        FORMAT.write(Motion(bap_skeleton(), X, 25.0))


def test_content_is_recognised_whatever_the_suffix(tmp_path):
    path = tmp_path / "wave.txt"
    path.write_text(GOLDEN)
    assert open_file(path).motion.n_frames == 3
    save_motion(tmp_path / "again.bap", open_file(path).motion)
    assert np.array_equal(open_file(tmp_path / "again.bap").motion.X, open_file(path).motion.X)
    assert not FORMAT.sniff(b"HIERARCHY\nROOT Hips\n")
    assert not FORMAT.sniff(b"1 2 3\n4 5 6\n")
    assert not FORMAT.sniff(b"2.1 anger 25 1\n" + mask(n=68).encode() + b"\n0\n")


@pytest.mark.parametrize("path", corpus_files("bap/*.bap"))
def test_bap_of_the_corpus_opens_and_comes_back(path):
    loaded = open_file(path)
    again = read(FORMAT.write(loaded.motion)).motion
    assert loaded.warnings == ()
    assert np.array_equal(again.X, loaded.motion.X)
    assert np.array_equal(again.mask, loaded.motion.mask)


@pytest.mark.corpus
def test_frame_numbers_of_the_corpus_that_go_by_steps_are_read_as_a_rate():
    stepped = open_file(corpus_file("bap/vreng_test.bap")).motion
    assert np.degrees(stepped.X[:4, column_of(32)]) == pytest.approx([0, -10, -20, -30], abs=1e-3)
