"""Files are recognised by content first, errors name their file, and nothing is imported before it is needed."""

import subprocess
import sys

import numpy as np
import pytest

from qmd_studio import registry
from qmd_studio.avatar.humanoid import Body, Surface
from qmd_studio.errors import FormatError, StorageError
from qmd_studio.formats.loaded import Format, ReadOptions
from qmd_studio.motion.channels import channel_skeleton
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import EndSite
from tests.corpus import corpus_file


@pytest.fixture
def motion():
    joints = [("hips", -1, (0.0, 0.9, 0.0), ["Xposition", "Zrotation"]), ("chest", 0, (0.0, 0.5, 0.0), ["Xrotation"])]
    skeleton = channel_skeleton(joints, [EndSite("head", 1, (0.0, 0.3, 0.0))])
    return Motion(skeleton, np.arange(6, dtype=float).reshape(2, 3) / 8, 25.0, name="nod")


@pytest.mark.parametrize("suffix", [".bvh", ".csv", ".npz", ".BVH"])
def test_what_is_saved_opens_again_whatever_it_is_called(tmp_path, motion, suffix):
    path = tmp_path / f"nod{suffix}"
    registry.save_motion(path, motion)
    renamed = path.rename(tmp_path / "nod.data")
    loaded = registry.open_file(renamed)
    np.testing.assert_allclose(loaded.motion.X, motion.X, atol=1e-12)
    assert loaded.motion.fps == 25.0
    assert loaded.skeleton.joints == motion.skeleton.joints


def test_content_wins_over_a_wrong_suffix(tmp_path, motion):
    path = tmp_path / "nod.npz"
    path.write_bytes(registry.encode_motion(".bvh", motion))
    assert registry.open_file(path).skeleton.joints[1].name == "chest"


def test_options_reach_the_reader_with_the_path(tmp_path, motion):
    path = tmp_path / "nod.bvh"
    registry.save_motion(path, motion)
    loaded = registry.open_file(path, ReadOptions(fps=60, metres_per_unit=0.5))
    assert (loaded.motion.fps, loaded.motion.name, loaded.skeleton.metres_per_unit) == (60, "nod", 0.5)
    assert loaded.skeleton.joints[1].offset == (0.0, 0.25, 0.0)


@pytest.mark.parametrize("options", [{"fps": 0}, {"fps": float("nan")}, {"metres_per_unit": -1}])
def test_options_that_mean_nothing_are_refused(tmp_path, motion, options):
    path = tmp_path / "nod.bvh"
    registry.save_motion(path, motion)
    with pytest.raises(FormatError, match="positive"):
        registry.open_file(path, ReadOptions(**options))


@pytest.mark.parametrize(
    ("name", "content"), [("a.bvh", b""), ("a.bvh", b"HIERARCHY ROOT"), ("a.xyz", b"what"), ("a.npz", b"PK\x03\x04")]
)
def test_every_error_names_the_file(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(FormatError) as caught:
        registry.open_file(path)
    assert caught.value.path == path


def test_a_file_that_is_not_there_is_a_storage_error(tmp_path):
    with pytest.raises(StorageError):
        registry.open_file(tmp_path / "absent.bvh")


def test_a_suffix_of_no_format_is_refused_and_nothing_is_written(tmp_path, motion):
    with pytest.raises(FormatError, match=r"\.bvh"):
        registry.save_motion(tmp_path / "nod.xyz", motion)
    assert not list(tmp_path.iterdir())


def test_each_format_has_a_name_and_suffixes_of_its_own():
    formats = registry.FORMATS
    assert all(isinstance(entry, Format) for entry in formats)
    names = [entry.name for entry in formats]
    suffixes = [suffix for entry in formats for suffix in entry.suffixes]
    assert len(set(names)) == len(names)
    assert len(set(suffixes)) == len(suffixes)
    assert all(registry.format_for(f"a{suffix}").name in names for suffix in suffixes)


def test_no_format_claims_another_ones_content(motion):
    for target in (".bvh", ".csv", ".npz"):
        head = registry.encode_motion(target, motion)[: registry.SNIFFED_BYTES]
        assert [entry.name for entry in registry.FORMATS if entry.sniff(head)] == [target[1:]]


@pytest.fixture
def body(motion):
    corner = np.zeros((3, 3), dtype=np.float32)
    surface = Surface(
        corner, corner, np.array([[0, 1, 2]]), corner, np.zeros((3, 1), dtype=np.int64), corner[:, :1] + 1
    )
    return Body("triangle", motion.skeleton, surface, np.tile(np.eye(4), (2, 1, 1)))


def with_figures(monkeypatch, write_figure):
    figures = Format("figure", "Figure", (".fig",), bytes.isdigit, lambda data, options: None, None, None, write_figure)
    others = registry.FORMATS
    monkeypatch.setattr(registry, "formats", lambda: (figures, *others))


def test_a_body_and_its_motion_are_written_by_the_format_of_the_suffix(tmp_path, monkeypatch, motion, body):
    with_figures(monkeypatch, lambda body, motion: f"{body.name} {motion and motion.n_frames}".encode())
    registry.save_figure(tmp_path / "a.fig", body, motion)
    registry.save_figure(tmp_path / "b.fig", body)
    assert [path.read_bytes() for path in sorted(tmp_path.iterdir())] == [b"triangle 2", b"triangle None"]


def test_a_body_is_not_written_where_it_would_be_lost(tmp_path, monkeypatch, motion, body):
    with_figures(monkeypatch, lambda body, motion: b"")
    with pytest.raises(FormatError, match="not a motion alone"):
        registry.save_motion(tmp_path / "a.fig", motion)
    scaled = motion.scaled(2.0)
    for name, what, match in (("a.bvh", motion, "no body"), ("a.fig", scaled, "Retarget"), ("a.xyz", motion, "suffix")):
        with pytest.raises(FormatError, match=match) as caught:
            registry.save_figure(tmp_path / name, body, what)
        assert caught.value.path == tmp_path / name
    assert not list(tmp_path.iterdir())


@pytest.mark.corpus
def test_a_real_amc_becomes_bvh_and_not_the_other_way_round(tmp_path):
    loaded = registry.open_file(corpus_file("cmu_asfamc/02_01.amc"))
    registry.save_motion(tmp_path / "walk.bvh", loaded.motion)
    walk = registry.open_file(tmp_path / "walk.bvh").motion
    assert walk.n_frames == loaded.motion.n_frames == 343
    for suffix in (".amc", ".bap"):
        with pytest.raises(FormatError, match="retarget"):
            registry.save_motion(tmp_path / f"walk{suffix}", walk)


def test_importing_the_registry_imports_no_format():
    code = (
        "import sys, qmd_studio.registry as r;"
        "print([m for m in r.FORMAT_MODULES if m in sys.modules], 'numba' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[] False"
