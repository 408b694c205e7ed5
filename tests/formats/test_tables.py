"""CSV and NPZ give a motion back equal to the last bit, and refuse what is damaged or hostile."""

import io
import json
import math
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings

from qmd_studio.errors import FormatError
from qmd_studio.formats import csv_text, npz
from qmd_studio.formats.loaded import ReadOptions
from qmd_studio.motion.channels import channel_skeleton
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, EndSite, Joint, Skeleton, SkeletonKind
from qmd_studio.motion.skeleton_json import json_text, parse_json, skeleton_from_json, skeleton_to_json
from qmd_studio.registry import encode_motion, open_file
from tests.corpus import corpus_files
from tests.formats.damage import NASTY_WORDS, assert_ends_well, assert_every_prefix_ends_well, damaged

MODULES = pytest.mark.parametrize("module", [csv_text, npz], ids=["csv", "npz"])


def small_skeleton():
    """A skeleton with something in every field."""
    turned = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    return Skeleton(
        name='näme, "quoted"',
        kind=SkeletonKind.BAP,
        joints=(Joint("root", -1, (0.1, 0.2, 1 / 3), (1,)), Joint("腕", 0, (0.0, 1.0, 0.0), orientation=turned)),
        end_sites=(EndSite("tip", 1, (0.0, 0.5, 0.0)),),
        columns=(
            Column("root, x\nposition", 0, ColumnKind.TRANSLATION, 0, rest=0.1),
            Column('root "rx"', 0, ColumnKind.ROTATION, 0, -1, 2, limits=(-1.5, 1.5), bap_id=34),
            Column("extra", 0, ColumnKind.OPAQUE, 2, level=6, limits=(-math.inf, 3.0), bap_id=296),
        ),
        points=(2, 0),
        metres_per_unit=0.01,
    )


def small_motion(mask=True):
    X = np.array([[1 / 3, -0.0, 1e-300], [np.pi, 1e12, -7.25], [5e-324, 2.0, 1e300]])
    given_values = np.array([[True, True, False], [False, True, False], [True, False, True]])
    return Motion(small_skeleton(), X, 1 / 0.03, name="wave", mask=given_values if mask else None)


def assert_equal(first, second):
    assert first.skeleton == second.skeleton
    assert (first.fps, first.name) == (second.fps, second.name)
    np.testing.assert_array_equal(first.X, second.X)
    assert np.array_equal(np.signbit(first.X), np.signbit(second.X))
    assert (first.mask is None) == (second.mask is None)
    if first.mask is not None:
        np.testing.assert_array_equal(first.mask, second.mask)


def reader(module):
    return lambda data: module.read(data, ReadOptions())


@MODULES
@pytest.mark.parametrize("mask", [True, False])
def test_every_field_comes_back_to_the_last_bit(module, mask):
    data = module.FORMAT.write(small_motion(mask))
    assert module.sniff(data[:4096])
    loaded = module.read(data, ReadOptions())
    assert_equal(loaded.motion, small_motion(mask))
    assert module.FORMAT.write(loaded.motion) == data


@pytest.mark.parametrize("path", corpus_files("bvh/*.bvh"))
def test_real_motions_come_back_to_the_last_bit(path):
    motion = open_file(path).motion
    for module in (csv_text, npz):
        again = module.read(module.FORMAT.write(motion), ReadOptions()).motion
        assert_equal(again, motion)
        assert encode_motion(".bvh", again) == encode_motion(".bvh", motion)


@MODULES
def test_every_prefix_ends_well(module):
    assert_every_prefix_ends_well(reader(module), module.FORMAT.write(small_motion()))


@MODULES
def test_a_file_cut_anywhere_is_refused(module):
    data = module.FORMAT.write(small_motion())
    for length in range(len(data)):
        with pytest.raises(FormatError):
            module.read(data[:length], ReadOptions())


@settings(max_examples=200, deadline=None)
@given(damaged(csv_text.FORMAT.write(small_motion())))
def test_a_damaged_csv_ends_well(data):
    assert_ends_well(reader(csv_text), data)


@settings(max_examples=200, deadline=None)
@given(damaged(npz.FORMAT.write(small_motion())))
def test_a_damaged_npz_ends_well(data):
    assert_ends_well(reader(npz), data)


@settings(max_examples=200, deadline=None)
@given(damaged(json_text(skeleton_to_json(small_skeleton())).encode()))
def test_a_damaged_description_ends_well(data):
    assert_ends_well(lambda text: skeleton_from_json(parse_json(text)), data)


def test_numpy_alone_reads_the_matrix():
    with np.load(io.BytesIO(npz.FORMAT.write(small_motion())), allow_pickle=False) as arrays:
        np.testing.assert_array_equal(arrays["X"], small_motion().X)
        assert json.loads(arrays["description"].tobytes())["frames"] == 3


def test_the_csv_header_names_columns_and_units():
    lines = csv_text.FORMAT.write(small_motion(mask=False)).decode().split("\n")
    assert lines[2] == '"root, x position [m]","root ""rx"" [rad]",extra [1]'
    assert lines[3] == "0.3333333333333333,-0.0,1e-300"


def zipped(**members):
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in members.items():
            archive.writestr(f"{name}.npy", data)
    return stream.getvalue()


def npy(array, allow_pickle=False):
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=allow_pickle)
    return stream.getvalue()


def description():
    text = json_text({"version": 1, "fps": 30, "name": "", "frames": 2, "skeleton": skeleton_to_json(small_skeleton())})
    return npy(np.frombuffer(text.encode(), dtype=np.uint8))


def test_an_npz_made_with_numpy_opens():
    X = np.asfortranarray(np.arange(6, dtype=np.float32).reshape(2, 3))
    loaded = npz.read(zipped(description=description(), X=npy(X)), ReadOptions(fps=50))
    np.testing.assert_array_equal(loaded.motion.X, X)
    assert loaded.motion.fps == 50


@pytest.mark.parametrize(
    "members",
    [
        {"X": npy(np.array([{"a": 1}], dtype=object), allow_pickle=True)},
        {"X": npy(np.zeros((2, 3), dtype=np.int64))},
        {"X": npy(np.zeros((2, 4)))},
        {"X": npy(np.zeros((3, 3)))},
        {"X": npy(np.zeros(6))},
        {"X": npy(np.full((2, 3), np.nan))},
        {"X": npy(np.zeros((2, 3))).replace(b"(2, 3)", b"(9, 9)")},
        {"X": npy(np.zeros((2, 3))), "mask": npy(np.zeros((2, 3)))},
        {"X": npy(np.zeros((2, 3))), "mask": npy(np.zeros((2, 2), dtype=bool))},
        {"y": npy(np.zeros((2, 3)))},
        {f"m{i}": b"" for i in range(40)},
    ],
    ids=[
        "pickle",
        "integers",
        "columns",
        "frames",
        "vector",
        "nan",
        "shape",
        "mask type",
        "mask shape",
        "absent",
        "many",
    ],
)
def test_arrays_that_do_not_fit_are_refused(members):
    problem = assert_ends_well(reader(npz), zipped(description=description(), **members))
    assert isinstance(problem, FormatError)


def test_a_zip_bomb_costs_little():
    problem = assert_ends_well(reader(npz), zipped(description=bytes(60 << 20), X=npy(np.zeros((2, 3)))))
    assert isinstance(problem, FormatError)


def test_a_declared_size_that_deflate_cannot_reach_is_refused_unread():
    data = bytearray(zipped(description=description(), X=npy(np.zeros((2, 3)))))
    entry = data.index(b"PK\x01\x02")
    data[entry + 24 : entry + 28] = (0x7FFFFFF0).to_bytes(4, "little")
    with pytest.raises(FormatError, match="more than its bytes can hold"):
        npz.read(bytes(data), ReadOptions())


def paths(value, path=()):
    """Every place in a JSON value."""
    children = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in children:
        yield (*path, key)
        yield from paths(child, (*path, key))


def test_every_wrong_type_in_a_skeleton_is_refused_or_means_something():
    wrong = [None, True, -5, 10**400, 1.5, float("inf"), "x", [], [[]], {}]
    original = skeleton_to_json(small_skeleton())
    refused = 0
    for path in list(paths(original)):
        for value in wrong:
            document = json.loads(json.dumps(original))
            place = document
            for key in path[:-1]:
                place = place[key]
            place[path[-1]] = value
            refused += isinstance(assert_ends_well(skeleton_from_json, document), FormatError)
    assert refused > 6 * len(list(paths(original)))


@pytest.mark.parametrize(
    "text", ["[" * 100_000, '{"a":' * 100_000, "[]", "{", '{"a": NaN}', "1" * 10**6, "\ud800", b"\xff"]
)
def test_json_that_is_no_object_is_refused(text):
    problem = assert_ends_well(parse_json, text if isinstance(text, bytes) else text.encode(errors="surrogatepass"))
    assert isinstance(problem, FormatError)


@pytest.mark.parametrize("word", NASTY_WORDS[3:6])
def test_a_cell_that_is_no_number_is_named(word):
    data = csv_text.FORMAT.write(small_motion(mask=False)).replace(b"-7.25", word)
    with pytest.raises(FormatError) as caught:
        csv_text.read(data, ReadOptions())
    assert caught.value.at == "line 5, column 3"


def test_a_motion_without_columns_makes_no_csv():
    skeleton = channel_skeleton([("still", -1, (0.0, 1.0, 0.0), [])], [])
    with pytest.raises(FormatError):
        csv_text.FORMAT.write(Motion(skeleton, np.zeros((2, 0)), 30.0))


def test_orientation_that_is_no_rotation_is_refused():
    values = skeleton_to_json(small_skeleton())
    values["joints"][1]["orientation"][0][0] += 1e-3
    with pytest.raises(FormatError, match=r"orientation.*rotation"):
        skeleton_from_json(values)


@pytest.mark.parametrize("write", [csv_text.write, npz.write])
def test_figure_of_more_joints_than_can_be_read_is_not_written(write):
    skeleton = channel_skeleton([("j", -1, (0.0, 0.0, 0.0), ["Zrotation"] if i == 0 else []) for i in range(5000)], [])
    with pytest.raises(FormatError, match="too many parts"):
        write(Motion(skeleton, np.zeros((1, 1)), 30.0))
