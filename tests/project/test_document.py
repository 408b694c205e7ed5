import numpy as np
import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, invariant, precondition, rule

from qmd_studio.codecs.compact.settings import CompactSettings
from qmd_studio.errors import EditError, QmdStudioError
from qmd_studio.formats.loaded import Loaded
from qmd_studio.motion.motion import Motion
from qmd_studio.motion.skeleton import Column, ColumnKind, EndSite, Joint, Skeleton, SkeletonKind
from qmd_studio.project.clip import Clip, clip_from
from qmd_studio.project.commands import (
    ActivateClip,
    AddClip,
    CopySettings,
    RemoveClip,
    RenameClip,
    SetCodecSettings,
    SetFps,
    SetLengthUnit,
    SetLevels,
)
from qmd_studio.project.document import Document
from qmd_studio.project.state import Side
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.reduction import Reduction
from tests.paper_settings import paper


def small_skeleton():
    columns = (
        Column("root.x", 0, ColumnKind.TRANSLATION, 0),
        Column("root.rx", 0, ColumnKind.ROTATION, 0),
        Column("arm.rz", 1, ColumnKind.ROTATION, 2, level=3),
    )
    joints = (Joint("root", -1, (0.0, 1.0, 0.0), product=(1,)), Joint("arm", 0, (0.5, 0.0, 0.0), product=(2,)))
    return Skeleton("small", SkeletonKind.BVH, joints, (EndSite("tip", 1, (0.2, 0, 0)),), columns, (0, 1, 2), 0.01)


def small_clip(name="wave", n_frames=5):
    X = np.linspace(0.0, 1.0, n_frames * 3).reshape(n_frames, 3)
    return Clip(name, Motion(small_skeleton(), X, 30.0, name=name))


@pytest.fixture
def document():
    document = Document()
    document.execute(AddClip(small_clip()))
    return document


def test_add_clip_when_two_are_added_then_the_newest_is_shown(document):
    document.execute(AddClip(small_clip("walk")))
    assert [clip.name for clip in document.state.clips] == ["wave", "walk"]
    assert document.state.active_clip.name == "walk"


def test_remove_clip_when_it_is_shown_then_its_neighbour_is(document):
    document.execute(AddClip(small_clip("walk")))
    document.execute(RemoveClip(document.state.active))
    assert document.state.active_clip.name == "wave"
    document.execute(RemoveClip(document.state.active))
    assert document.state.active_clip is None


def test_a_failing_command_leaves_the_document_as_it_was(document):
    before, history = document.state, document.history
    with pytest.raises(EditError):
        document.execute(SetFps(1, 0.0))
    with pytest.raises(EditError):
        document.execute(SetFps(1, 1e-5))
    with pytest.raises(EditError):
        document.execute(RemoveClip(99))
    with pytest.raises(QmdStudioError):
        document.execute(SetLevels(1, (("no such column", 2),)))
    assert document.state is before
    assert document.history == history


def test_a_transaction_when_its_second_command_fails_then_the_first_is_taken_back(document):
    before, seen = document.state, []
    document.changed.connect(seen.append)

    def rename_twice():
        with document.transaction("Two things"):
            document.execute(RenameClip(1, "other"))
            document.execute(RenameClip(1, "  "))

    with pytest.raises(EditError):
        rename_twice()
    assert document.state is before
    assert seen == []


def test_a_transaction_is_one_step(document):
    with document.transaction("Open 2 files"):
        document.execute(AddClip(small_clip("a")))
        document.execute(AddClip(small_clip("b")))
    assert document.undo_text == "Open 2 files"
    document.undo()
    assert len(document.state.clips) == 1


def test_a_drag_is_one_step_and_the_next_drag_another(document):
    for bits in (9, 10, 11):
        document.execute(SetCodecSettings(paper(bits=bits), drag="bits"))
    document.end_merge()
    for bits in (12, 13):
        document.execute(SetCodecSettings(paper(bits=bits), drag="bits"))
    document.undo()
    assert document.state.codec.coding.bits == 11
    document.undo()
    assert document.state.codec.coding.bits == paper().coding.bits


def test_drags_of_two_sliders_do_not_merge(document):
    document.execute(SetCodecSettings(paper(bits=9), drag="bits"))
    document.execute(SetCodecSettings(paper(bits=9, fdf=4), drag="fdf"))
    document.undo()
    assert document.state.codec == paper(bits=9)


def test_a_drag_back_to_where_it_began_leaves_no_step(document):
    steps = document.history
    document.execute(SetCodecSettings(paper(bits=9), drag="bits"))
    document.execute(SetCodecSettings(paper(), drag="bits"))
    assert document.history == steps


def test_the_clean_mark_follows_undo_and_redo(document):
    document.mark_clean()
    document.execute(RenameClip(1, "other"))
    assert not document.is_clean
    document.undo()
    assert document.is_clean
    document.redo()
    assert not document.is_clean


def test_length_unit_when_changed_then_lengths_scale_and_angles_do_not(document):
    before = document.state.active_clip.motion
    document.execute(SetLengthUnit(1, 1.0))
    after = document.state.active_clip.motion
    assert after.skeleton.metres_per_unit == pytest.approx(1.0)
    np.testing.assert_allclose(after.X[:, 0], before.X[:, 0] * 100)
    np.testing.assert_array_equal(after.X[:, 1:], before.X[:, 1:])
    assert after.skeleton.joints[1].offset == pytest.approx((50.0, 0.0, 0.0))


def test_clip_from_when_the_file_has_no_motion_then_it_stands_at_rest_and_says_so(tmp_path):
    clip = clip_from(Loaded(small_skeleton()), tmp_path / "body.asf")
    assert clip.motion.n_frames == 1
    assert clip.name == "body"
    assert any("no motion" in note for note in clip.notes)


class Editing(RuleBasedStateMachine):
    """A user edits at random; then everything is undone and redone."""

    keys = Bundle("keys")

    def __init__(self):
        super().__init__()
        self.document = Document()
        self.start = self.document.state

    def do(self, command):
        before = self.document.state
        try:
            self.document.execute(command)
        except QmdStudioError:
            assert self.document.state is before

    @rule(target=keys, name=st.sampled_from("abc"), n_frames=st.integers(1, 4))
    def add(self, name, n_frames):
        self.document.execute(AddClip(small_clip(name, n_frames)))
        return self.document.state.active

    @rule(key=keys)
    def remove(self, key):
        self.do(RemoveClip(key))

    @rule(key=keys)
    def activate(self, key):
        self.do(ActivateClip(key))

    @rule(bits=st.integers(8, 16), drag=st.sampled_from([None, "bits", "fdf"]))
    def codec(self, bits, drag):
        self.do(SetCodecSettings(paper(bits=bits), drag))

    @rule(key=keys, fps=st.sampled_from([-1.0, 24.0, 60.0, float("nan")]))
    def fps(self, key, fps):
        self.do(SetFps(key, fps))

    @rule(key=keys, unit=st.sampled_from([0.01, 0.0254, 1.0, 0.0]))
    def unit(self, key, unit):
        self.do(SetLengthUnit(key, unit))

    @rule(key=keys, level=st.integers(0, 7))
    def level(self, key, level):
        self.do(SetLevels(key, (("arm.rz", level),)))

    @rule(key=keys, name=st.sampled_from(["", "x", "y"]))
    def rename(self, key, name):
        self.do(RenameClip(key, name))

    @rule()
    def release(self):
        self.document.end_merge()

    @precondition(lambda self: self.document.can_undo)
    @rule()
    def undo(self):
        self.document.undo()

    @precondition(lambda self: self.document.can_redo)
    @rule()
    def redo(self):
        self.document.redo()

    @invariant()
    def the_shown_clip_exists(self):
        state = self.document.state
        assert (state.active_clip in state.clips) if state.clips else (state.active_clip is None)
        assert len({clip.key for clip in state.clips}) == len(state.clips)

    def teardown(self):
        end = None
        while self.document.can_redo:
            self.document.redo()
        end = self.document.state
        steps = len(self.document.history)
        for _ in range(steps):
            self.document.undo()
        assert self.document.state == self.start
        assert not self.document.can_undo
        for _ in range(steps):
            self.document.redo()
        assert self.document.state == end


Editing.TestCase.settings = settings(max_examples=60, stateful_step_count=30, deadline=None)
TestEditing = Editing.TestCase


def test_each_side_has_its_own_settings_and_its_own_drags():
    document = Document()
    a, b = paper(fdf=1), paper(fdf=2)
    document.execute(SetCodecSettings(a, drag="fdf", side=Side.A))
    document.execute(SetCodecSettings(paper(fdf=3), drag="fdf", side=Side.A))
    document.execute(SetCodecSettings(b, drag="fdf"))
    assert (document.state.settings_of(Side.A).coding.fdf, document.state.settings_of(Side.B)) == (3, b)
    assert len(document.history) == 2
    document.undo()
    document.undo()
    assert document.state.settings_of(Side.A) is None


def test_settings_are_copied_either_way_and_undo_brings_both_back():
    document = Document()
    document.execute(SetCodecSettings(paper(fdf=4)))
    document.execute(CopySettings(Side.A))
    assert document.undo_text == "Copy settings to A"
    assert document.state.codec_a == document.state.codec == paper(fdf=4)
    document.execute(SetCodecSettings(paper(bits=9), side=Side.A))
    document.execute(CopySettings(Side.B))
    assert document.state.codec == paper(bits=9)
    document.undo()
    assert document.state.codec == paper(fdf=4)


def test_the_original_is_no_setting_for_b():
    document = Document()
    for command in (SetCodecSettings(None), CopySettings(Side.B)):
        with pytest.raises(EditError):
            document.execute(command)
    assert document.history == ()


def test_profile_and_reduction_are_part_of_a_side_and_of_its_undo():
    document, compact = Document(), EncodeSettings(CompactSettings(mean_error_mm=0.3), Reduction(2, 5))
    document.execute(SetCodecSettings(compact))
    document.execute(CopySettings(Side.A))
    assert document.state.codec_a == document.state.codec == compact
    document.execute(SetCodecSettings(EncodeSettings(compact.coding)))
    document.undo()
    assert document.state.codec.reduction == Reduction(2, 5)
    document.undo()
    document.undo()
    assert document.state.codec == EncodeSettings()
