"""One file in every way in which programs write it: the same skeleton and the same values each time."""

import re

import numpy as np
import pytest

from qmd_studio.errors import FormatError
from qmd_studio.formats import bvh
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.kinematics import node_positions, rest_values
from tests.formats.damage import assert_ends_well
from tests.formats.test_bvh_reads import FACTORS, PLAIN, ROWS


def read(data, **options):
    return bvh.read(data if isinstance(data, bytes) else data.encode(), ReadOptions(**options))


def decimal_commas(text):
    return re.sub(r"(\d)\.(\d)", r"\1,\2", text.replace("OFFSET 10 ", "OFFSET 10,0 ").replace("1 92 3", "1 92,0 3"))


def broken_over_lines(text):
    head, rows = text.split("Frame Time: 0.0333333\n")
    return head + "Frame Time: 0.0333333\n" + rows.replace(" 10 ", "\n10 ").replace(" 21 ", "\n\n21\n")


SAME = {
    "byte order mark": lambda text: "\ufeff" + text,
    "CRLF": lambda text: text.replace("\n", "\r\n"),
    "CR": lambda text: text.replace("\n", "\r"),
    "mixed line ends": lambda text: text.replace("{\n", "{\r\n").replace("}\n", "}\r"),
    "brace on the same line": lambda text: re.sub(r"\n\s*\{", " {", text),
    "brace stuck to the name": lambda text: re.sub(r"\n\s*\{", "{", text),
    "all on one line": lambda text: re.sub(r"\s+", " ", text.split("MOTION")[0]) + "\nMOTION" + text.split("MOTION")[1],
    "lower case": lambda text: re.sub(r"(?<![A-Za-z])(HIERARCHY|ROOT|JOINT|OFFSET|CHANNELS|MOTION)", low, text),
    "upper case": lambda text: text.replace("End Site", "END SITE").replace("rotation", "ROTATION"),
    "End site": lambda text: text.replace("End Site", "End site"),
    "ZRotation": lambda text: text.replace("rotation", "Rotation"),
    "tabs for blanks": lambda text: text.replace(" ", "\t").replace("End\tSite", "End Site"),
    "blanks at line ends": lambda text: text.replace("\n", "  \n"),
    "blank lines": lambda text: text.replace("\n", "\n\n"),
    "no blank after colons": lambda text: text.replace(": ", ":"),
    "blank before colons": lambda text: text.replace(": ", " : "),
    "many blanks": lambda text: (
        text.replace(" ", "   ").replace("End   Site", "End Site").replace("Frame   T", "Frame T")
    ),
    "exponents": lambda text: text.replace("1 92 3", "1.0e+000 920E-1 3e0"),
    "leading points and pluses": lambda text: text.replace("1 92 3", "+1 92. 3.").replace("0.0333333", ".0333333"),
    "decimal commas": decimal_commas,
    "frames over several lines": broken_over_lines,
    "no line end at the end": str.rstrip,
    "Ctrl-Z at the end": lambda text: text + "\x1a",
    "CHANNELS before OFFSET": lambda text: re.sub(r"(\t*OFFSET[^\n]*\n)(\t*CHANNELS[^\n]*\n)", r"\2\1", text),
    "one line of all numbers": lambda text: text.replace("45\n", "45 ").replace("46\n", "46 "),
}


def low(found):
    return found.group().lower()


@pytest.mark.parametrize("write", SAME.values(), ids=SAME)
def test_a_dialect_means_the_same(write):
    text = write(PLAIN)
    assert write is str or text != PLAIN
    plain, loaded = read(PLAIN), read(text)
    assert loaded.skeleton == plain.skeleton
    np.testing.assert_allclose(loaded.motion.X, np.array(ROWS) * FACTORS, rtol=1e-15)
    assert loaded.motion.fps == 30
    assert not loaded.warnings
    assert bvh.sniff(text.encode()[:4096])


@pytest.mark.parametrize(
    ("name", "encoding"),
    [
        ("左腕", "cp932"),
        ("左腕", "utf-8"),
        ("Hüfte", "latin-1"),
        ("left arm up", "ascii"),
        ("ソ{"[0], "cp932"),
        ("a:b.c-d", "ascii"),
    ],
)
def test_names_of_any_letters_stay(name, encoding):
    loaded = read(PLAIN.replace("Chest", name).encode(encoding))
    assert loaded.skeleton.joints[1].name == name
    again = read(bvh.FORMAT.write(loaded.motion))
    assert again.skeleton.joints[1].name == name


def test_names_twice_are_kept_and_their_columns_told_apart():
    loaded = read(PLAIN.replace("Leg", "Chest"))
    assert [joint.name for joint in loaded.skeleton.joints] == ["Hips", "Chest", "Chest"]
    names = [column.name for column in loaded.skeleton.columns]
    assert len(set(names)) == len(names)
    assert names[-1] == "Chest Xrotation #2"


def test_an_end_site_may_have_a_name():
    loaded = read(PLAIN.replace("End Site", "End Site Skull top", 1))
    assert [site.name for site in loaded.skeleton.end_sites] == ["Skull top", "Leg end"]


@pytest.mark.parametrize("change", [("\t\tCHANNELS 1 Xrotation\n", ""), ("CHANNELS 1 Xrotation", "CHANNELS 0")])
def test_a_joint_may_have_no_channels(change):
    text = PLAIN.replace(*change)
    for last in (" 45", " 46", " 47"):
        text = text.replace(last + "\n", "\n")
    assert read(text).motion.X.shape == (3, 9)


def test_positions_on_any_joint_replace_its_offset():
    text = PLAIN.replace("CHANNELS 1 Xrotation", "CHANNELS 2 Yposition Xrotation")
    for last in (" 45", " 46", " 47"):
        text = text.replace(last + "\n", f" -80{last}\n")
    loaded = read(text)
    rest = node_positions(loaded.skeleton, rest_values(loaded.skeleton)[None])[0]
    np.testing.assert_allclose(rest[:3], [[0, 0.9, 0], [0, 1.4, 0], [0.1, 0, 0]], atol=1e-12)
    X = np.zeros((1, loaded.skeleton.n_columns))
    X[0, -2] = -0.8
    np.testing.assert_allclose(node_positions(loaded.skeleton, X)[0, 2], [0.1, -0.8, 0], atol=1e-12)


def test_two_roots_each_move_by_themselves():
    twice = PLAIN.split("MOTION")[0] + PLAIN.split("MOTION")[0].replace("HIERARCHY\n", "").replace("Hips", "Box")
    rows = "\n".join(" ".join(map(str, row + row)) for row in ROWS)
    loaded = read(f"{twice}MOTION\nFrames: 3\nFrame Time: 0.02\n{rows}\n")
    assert [joint.parent for joint in loaded.skeleton.joints] == [-1, 0, 0, -1, 3, 3]
    positions = node_positions(loaded.skeleton, loaded.motion.X)
    np.testing.assert_allclose(positions[:, 0], positions[:, 3])


def test_rotations_multiply_in_the_order_of_the_channels():
    loaded = read(PLAIN.replace("1 92 3 10 20 30 ", "0 0 0 90 90 0 "))
    # Rz(90) · Rx(90): y of the chest's offset goes to z by x, and stays there by z.
    chest = node_positions(loaded.skeleton, loaded.motion.X)[0, 1]
    np.testing.assert_allclose(chest, [0, 0, 0.5], atol=1e-12)


@pytest.mark.parametrize("count", ["2", "4", "0", "100", "2147483648"])
def test_a_wrong_count_of_whole_rows_is_warned_of(count):
    loaded = read(PLAIN.replace("Frames: 3", f"Frames: {count}"))
    assert loaded.motion.n_frames == 3
    (warning,) = loaded.warnings
    assert "line 26" in warning
    assert f"{count} frames" in warning
    assert "3 are there" in warning


def test_an_incomplete_last_frame_is_dropped_with_a_warning():
    loaded = read(PLAIN.replace("5 12 22 32 3 4 5 47", "5 12"))
    assert loaded.motion.n_frames == 2
    (warning,) = loaded.warnings
    assert "line 30" in warning
    assert "4 of 10" in warning


@pytest.mark.parametrize(
    ("old", "new", "place"),
    [
        ("2 93 4 11", "2 93 4", "line 29"),
        ("2 93 4 11", "2 93 4 11 11", "line 29"),
        ("1 92 3", "1 92", "line 28"),
        ("3 94 5 12 22 32 3 4 5 47", "3 94 5 12 22 32 3 4 5 47 1", "line 30"),
        ("3 94 5 12 22 32 3 4 5 47", "3 94 5 12 22 32 3 4 5 47\n1 2", "line 31"),
        ("2 93 4", "2 9x3 4", "line 29"),
        ("2 93 4", "2 inf 4", "line 29"),
        ("2 93 4", "2 1e999 4", "line 29"),
        ("2 93 4", "2 1_0 4", "line 29"),
        ("2 93 4", "2 0x10 4", "line 29"),
        ("2 93 4", "2 1,5,5 4", "line 29"),
        ("Frames: 3", "Frames: -3", "line 26"),
        ("Frames: 3", "Frames: many", "line 26"),
        ("Frames: 3\n", "", "line 25"),
        ("Frame Time: 0.0333333\n", "", "line 26"),
        ("0.0333333", "0", "line 27"),
        ("0.0333333", "-0.1", "line 27"),
        ("0.0333333", "nan", "line 27"),
        ("0.0333333", "1e-320", "line 27"),
        ("OFFSET 0 50 0", "OFFSET 0 50", "line 9"),
        ("OFFSET 0 50 0", "OFFSET 0 nan 0", "line 8"),
        ("\t\tOFFSET 0 50 0\n", "", "line 13"),
        ("Zposition Zrotation", "Zposition Wrotation", "line 5"),
        ("CHANNELS 1 X", "CHANNELS 2 X", "line 19"),
        ("CHANNELS 1 X", "CHANNELS X", "line 18"),
        ("CHANNELS 1 X", "CHANNELS 99999999999999999999 X", "line 18"),
        ("ROOT Hips\n", "ROOT\n", "line 2"),
        ("JOINT Leg", "ROOT Leg", "line 15"),
        ("\t\t\tOFFSET 0 0 10", "\t\t\tJOINT x { OFFSET 0 0 10", "line 21"),
        ("\t}\n}\nMOTION", "\t}\nMOTION", "line 24"),
        ("\t}\n}\nMOTION", "\t}\n}\n}\nMOTION", "line 25"),
        ("HIERARCHY", "HIERARCHIE", "line 1"),
    ],
)
def test_what_cannot_be_meant_is_refused_with_its_line(old, new, place):
    assert old in PLAIN
    with pytest.raises(FormatError) as caught:
        read(PLAIN.replace(old, new))
    assert caught.value.at == place, str(caught.value)


def test_no_frames_are_refused():
    text = PLAIN.split("1 92")[0].replace("Frames: 3", "Frames: 0")
    with pytest.raises(FormatError, match="no frame"):
        read(text)


def test_a_file_without_motion_stands_at_rest():
    loaded = read(PLAIN.split("MOTION")[0])
    np.testing.assert_array_equal(loaded.motion.X, rest_values(loaded.skeleton)[None])
    assert "MOTION" in loaded.warnings[0]


def test_a_frame_rate_given_by_hand_wins_over_a_broken_one():
    assert read(PLAIN.replace("0.0333333", "0"), fps=50).motion.fps == 50


@pytest.mark.parametrize(
    ("unit", "name"),
    [
        (1, "metre"),
        (0.01, "centimetre"),
        (0.0254, "inch"),
        (0.056444, "ASF"),
        (0.1, "decimetre"),
        (0.001, "millimetre"),
        (0.3048, "foot"),
    ],
)
@pytest.mark.parametrize("stature", [1.5, 1.75, 1.85])
def test_the_unit_is_guessed_from_the_stature(unit, name, stature):
    low, high = 0.55 * stature / unit, 0.45 * stature / unit
    text = PLAIN.replace("OFFSET 0 50 0", "OFFSET 0 0 0").replace("OFFSET 0 35 0", f"OFFSET 0 {high} 0")
    loaded = read(text.replace("10 -90 0", f"1 {-low} 0").replace("0 0 10", "0 0 0"))
    assert f": {name}" in loaded.notes[0]
    points = node_positions(loaded.skeleton, rest_values(loaded.skeleton)[None])[0]
    assert np.ptp(points[:, 1]) == pytest.approx(stature, rel=1e-4)


def test_the_unit_can_be_set():
    loaded = read(PLAIN, metres_per_unit=0.0254)
    assert loaded.skeleton.metres_per_unit == 0.0254
    assert loaded.motion.X[0, 1] == pytest.approx(92 * 0.0254)


HOSTILE = {
    "a chain of 10,000": "HIERARCHY\nROOT a {OFFSET 0 0 0 CHANNELS 1 Xrotation\n" + "JOINT b {OFFSET 0 1 0\n" * 10_000,
    "braces": "HIERARCHY\nROOT a " + "{" * 60_000,
    "a million digits": PLAIN.replace("OFFSET 0 50", "OFFSET 0 " + "9" * 10**6),
    "a million digits in a frame": PLAIN.replace("1 92 3", f"1 {'9' * 10**6} 3"),
    "a million digits as count": PLAIN.replace("Frames: 3", "Frames: " + "9" * 10**6),
    "many blank lines": PLAIN.split("1 92")[0] + "\n" * 60_000,
    "no spaces": "HIERARCHY" + "ROOT" * 15_000,
    "many roots": "HIERARCHY " + "ROOT a\n{OFFSET 0 0 0}" * 3000 + "\nMOTION\nFrames: 1\nFrame Time: 1\n",
}


@pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE)
def test_what_is_made_to_hurt_does_not(text):
    assert_ends_well(read, text.encode())


def test_a_chain_of_ten_thousand_joints_that_is_whole_opens():
    text = HOSTILE["a chain of 10,000"] + "}" * 10_001 + "\nMOTION\nFrames: 1\nFrame Time: 1\n3\n"
    assert len(assert_ends_well(read, text.encode()).skeleton.joints) == 10_001
