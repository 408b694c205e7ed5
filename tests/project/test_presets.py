"""Presets: they come back as they were, damage is refused or left out, names never write over one another."""

import contextlib
import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.codecs.qmd.settings import Buckets, Encoder, QmdSettings
from qmd_studio.errors import FormatError, StorageError
from qmd_studio.project.preset_json import Preset, from_json, to_json
from qmd_studio.project.presets import BUILT_IN, PresetShelf, read_preset
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.reduction import Reduction
from tests.generated_motion import walker
from tests.paper_settings import paper

PAPER = st.builds(
    QmdSettings,
    fdf=st.integers(0, 300),
    bits=st.integers(8, 16),
    segment=st.integers(0, 5000),
    encoder=st.sampled_from(Encoder),
    k=st.one_of(st.just(math.inf), st.floats(0, 9)),
    rqt=st.integers(1, 10**7),
    max_error_mm=st.floats(1e-3, 100),
)
COMPACT = st.builds(
    CompactSettings,
    mean_error_mm=st.one_of(st.none(), st.floats(1e-3, 100)),
    max_error_mm=st.one_of(st.none(), st.floats(1e-3, 100)),
    segment=st.integers(0, 500),
    block=st.integers(1, 60),
)
REDUCTIONS = st.builds(Reduction, st.integers(1, 30), st.integers(1, 6), st.one_of(st.none(), st.integers(0, 3)))
SETTINGS = st.builds(EncodeSettings, st.one_of(PAPER, COMPACT), REDUCTIONS)
NAMES = st.text(min_size=1, max_size=40).filter(lambda name: name == name.strip() and name)


@given(SETTINGS, NAMES)
def test_a_preset_comes_back_from_its_file(settings, name):
    assert from_json(to_json(Preset(name, settings))) == Preset(name, settings)


@pytest.fixture
def shelf(tmp_path):
    return PresetShelf(tmp_path / "presets")


def test_presets_are_kept_renamed_removed_and_reset(shelf):
    assert shelf.own() == []
    rough, fine = Preset("rough", paper(fdf=0)), Preset("Fine", paper(bits=12))
    for preset in (rough, fine):
        shelf.save(preset)
    assert PresetShelf(shelf.folder).own() == [fine, rough]
    smooth = shelf.rename(fine, "smooth")
    assert shelf.own() == [rough, smooth]
    shelf.remove(rough)
    assert shelf.own() == [smooth]
    shelf.reset()
    assert shelf.own() == []


def test_saving_under_the_same_name_replaces(shelf):
    shelf.save(Preset("mine", paper(fdf=1)))
    shelf.save(Preset("mine", paper(fdf=2)))
    assert shelf.own() == [Preset("mine", paper(fdf=2))]


def test_names_that_meet_in_one_file_are_refused_and_nothing_is_lost(shelf):
    shelf.save(Preset("a/b", paper(fdf=1)))
    with pytest.raises(FormatError):
        shelf.save(Preset("a:b", paper(fdf=2)))
    shelf.save(Preset("c", paper()))
    with pytest.raises(FormatError):
        shelf.rename(Preset("c", paper()), "a/b")
    assert [preset.name for preset in shelf.own()] == ["a/b", "c"]


@pytest.mark.parametrize("name", ["", "   ", "x" * 81])
def test_a_name_that_is_none_is_refused(shelf, name):
    with pytest.raises(FormatError):
        shelf.save(Preset(name, paper()))


def test_a_name_never_leaves_the_folder(shelf):
    shelf.save(Preset("../../up", paper()))
    assert [path.parent for path in shelf.folder.iterdir()] == [shelf.folder]
    assert shelf.own()[0].name == "../../up"


def test_a_damaged_file_is_left_out_and_left_alone(shelf):
    shelf.save(Preset("good", paper()))
    bad = shelf.folder / "bad.json"
    bad.write_bytes(b"{")
    assert [preset.name for preset in shelf.own()] == ["good"]
    assert bad.read_bytes() == b"{"
    with pytest.raises(FormatError) as caught:
        shelf.take_in(bad)
    assert caught.value.path == bad


def test_a_file_of_another_studio_is_taken_in(shelf, tmp_path):
    path = tmp_path / "theirs.json"
    path.write_bytes(to_json(Preset("theirs", paper(k=2.0, encoder=Encoder.PAPER))))
    assert shelf.take_in(path) == shelf.own()[0] == read_preset(path)
    with pytest.raises(StorageError):
        shelf.take_in(tmp_path / "none.json")


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "else"},
        {"version": 3},
        {"name": 3},
        {"name": ""},
        {"settings": 5},
        {"settings": {"fdf": "six"}},
        {"settings": {"fdf": -1}},
        {"settings": {"fdf": True}},
        {"settings": {"encoder": "zip"}},
        {"settings": {"k": "much"}},
        {"settings": {"colour": 1}},
        {"version": 2, "profile": "zip"},
        {"version": 2, "profile": "compact", "settings": {"fdf": 6}},
        {"version": 2, "profile": "compact", "settings": {"mean_error_mm": "small"}},
        {"version": 2, "reduction": {"fps_divisor": 0}},
        {"version": 2, "reduction": {"max_level": 7}},
        {"version": 2, "reduction": {"max_level": None}},
        {"version": 2, "reduction": [1]},
    ],
)
def test_what_is_no_preset_is_refused(change):
    contents = json.loads(to_json(Preset("mine", paper()))) | change
    with pytest.raises(FormatError):
        from_json(json.dumps(contents).encode())


@given(st.binary(max_size=200))
def test_any_bytes_are_a_preset_or_a_format_error(data):
    with contextlib.suppress(FormatError):
        from_json(data)


def test_the_built_in_presets_fit_any_motion_of_enough_columns_and_have_names_of_their_own():
    assert len({preset.name for preset in BUILT_IN}) == len({preset.settings for preset in BUILT_IN}) == len(BUILT_IN)
    for preset in BUILT_IN:
        assert preset.settings.fitted(walker(200)) == preset.settings


def test_a_file_of_before_there_were_profiles_is_read_and_what_it_can_hold_is_written_as_it_was():
    old = {"fdf": 3, "bits": 9, "segment": 60, "encoder": "paper", "k": "inf", "rqt": 500, "buckets": "width"}
    contents = {"kind": "QMD Studio preset", "version": 1, "name": "old", "settings": old}
    preset = from_json(json.dumps(contents).encode())
    assert preset.settings == EncodeSettings(
        QmdSettings(3, 9, 60, Encoder.PAPER, math.inf, 500, Buckets.WIDTH), Reduction()
    )
    assert json.loads(to_json(preset))["version"] == 1
    fewer = Preset("fewer", EncodeSettings(preset.settings.coding, Reduction(2)))
    assert json.loads(to_json(fewer))["version"] == 2
