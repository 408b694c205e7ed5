"""Presets: they come back as they were, damage is refused or left out, names never write over one another."""

import contextlib
import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from qmd_studio.codecs.qmd.settings import Encoder, QmdSettings
from qmd_studio.errors import FormatError, StorageError
from qmd_studio.project.presets import BUILT_IN, Preset, PresetShelf, from_json, read_preset, to_json

SETTINGS = st.builds(
    QmdSettings,
    fdf=st.integers(0, 300),
    bits=st.integers(8, 16),
    segment=st.integers(0, 5000),
    encoder=st.sampled_from([Encoder.PAPER, Encoder.CLOSED]),
    k=st.one_of(st.just(math.inf), st.floats(0, 9)),
    rqt=st.integers(1, 10**7),
)
NAMES = st.text(min_size=1, max_size=40).filter(lambda name: name == name.strip() and name)


@given(SETTINGS, NAMES)
def test_a_preset_comes_back_from_its_file(settings, name):
    assert from_json(to_json(Preset(name, settings))) == Preset(name, settings)


@pytest.fixture
def shelf(tmp_path):
    return PresetShelf(tmp_path / "presets")


def test_presets_are_kept_renamed_removed_and_reset(shelf):
    assert shelf.own() == []
    rough, fine = Preset("rough", QmdSettings(fdf=0)), Preset("Fine", QmdSettings(bits=12))
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
    shelf.save(Preset("mine", QmdSettings(fdf=1)))
    shelf.save(Preset("mine", QmdSettings(fdf=2)))
    assert shelf.own() == [Preset("mine", QmdSettings(fdf=2))]


def test_names_that_meet_in_one_file_are_refused_and_nothing_is_lost(shelf):
    shelf.save(Preset("a/b", QmdSettings(fdf=1)))
    with pytest.raises(FormatError):
        shelf.save(Preset("a:b", QmdSettings(fdf=2)))
    shelf.save(Preset("c", QmdSettings()))
    with pytest.raises(FormatError):
        shelf.rename(Preset("c", QmdSettings()), "a/b")
    assert [preset.name for preset in shelf.own()] == ["a/b", "c"]


@pytest.mark.parametrize("name", ["", "   ", "x" * 81])
def test_a_name_that_is_none_is_refused(shelf, name):
    with pytest.raises(FormatError):
        shelf.save(Preset(name, QmdSettings()))


def test_a_name_never_leaves_the_folder(shelf):
    shelf.save(Preset("../../up", QmdSettings()))
    assert [path.parent for path in shelf.folder.iterdir()] == [shelf.folder]
    assert shelf.own()[0].name == "../../up"


def test_a_damaged_file_is_left_out_and_left_alone(shelf):
    shelf.save(Preset("good", QmdSettings()))
    bad = shelf.folder / "bad.json"
    bad.write_bytes(b"{")
    assert [preset.name for preset in shelf.own()] == ["good"]
    assert bad.read_bytes() == b"{"
    with pytest.raises(FormatError) as caught:
        shelf.take_in(bad)
    assert caught.value.path == bad


def test_a_file_of_another_studio_is_taken_in(shelf, tmp_path):
    path = tmp_path / "theirs.json"
    path.write_bytes(to_json(Preset("theirs", QmdSettings(k=2.0, encoder=Encoder.PAPER))))
    assert shelf.take_in(path) == shelf.own()[0] == read_preset(path)
    with pytest.raises(StorageError):
        shelf.take_in(tmp_path / "none.json")


@pytest.mark.parametrize(
    "change",
    [
        {"kind": "else"},
        {"version": 2},
        {"name": 3},
        {"name": ""},
        {"settings": 5},
        {"settings": {"fdf": "six"}},
        {"settings": {"fdf": -1}},
        {"settings": {"fdf": True}},
        {"settings": {"encoder": "zip"}},
        {"settings": {"k": "much"}},
        {"settings": {"colour": 1}},
    ],
)
def test_what_is_no_preset_is_refused(change):
    contents = json.loads(to_json(Preset("mine", QmdSettings()))) | change
    with pytest.raises(FormatError):
        from_json(json.dumps(contents).encode())


@given(st.binary(max_size=200))
def test_any_bytes_are_a_preset_or_a_format_error(data):
    with contextlib.suppress(FormatError):
        from_json(data)


def test_the_built_in_presets_fit_any_motion_of_enough_columns_and_have_names_of_their_own():
    assert len({preset.name for preset in BUILT_IN}) == len({preset.settings for preset in BUILT_IN}) == len(BUILT_IN)
    for preset in BUILT_IN:
        preset.settings.checked(62, 300)
