import math

import pytest

from qmd_studio.codecs.qmd.settings import Buckets, Encoder, QmdSettings
from qmd_studio.errors import StorageError
from qmd_studio.tuning.encode_settings import EncodeSettings
from qmd_studio.tuning.export import export_numbered, export_over, suggested_name


def test_the_name_says_the_settings():
    assert suggested_name("walk", EncodeSettings(QmdSettings()), 343) == "walk__fdf6_b8_nd342.qmd"
    assert suggested_name("walk", EncodeSettings(QmdSettings(11, 9, 90)), 343) == "walk__fdf11_b9_nd90.qmd"


def test_the_papers_encoder_is_named_with_what_is_not_its_default():
    paper = QmdSettings(encoder=Encoder.PAPER)
    assert suggested_name("a", EncodeSettings(paper), 10) == "a__fdf6_b8_nd9_paper.qmd"
    paper = QmdSettings(encoder=Encoder.PAPER, k=2.0, rqt=500)
    assert suggested_name("a", EncodeSettings(paper), 10) == "a__fdf6_b8_nd9_paper_k2_rqt500.qmd"
    paper = QmdSettings(encoder=Encoder.PAPER, buckets=Buckets.WIDTH)
    assert suggested_name("a", EncodeSettings(paper), 10) == "a__fdf6_b8_nd9_paper_width.qmd"
    assert "k" not in suggested_name("a", EncodeSettings(QmdSettings(k=math.inf)), 10)


@pytest.mark.parametrize(("stem", "start"), [("a/b:c", "a_b_c__"), ("..", "motion__"), ("", "motion__")])
def test_a_name_that_no_file_can_have_becomes_one(stem, start):
    assert suggested_name(stem, EncodeSettings(QmdSettings()), 10).startswith(start)


def test_the_other_encoders_are_named_and_a_bounded_file_after_its_bound():
    assert suggested_name("a", EncodeSettings(QmdSettings(encoder=Encoder.PLAIN)), 10) == "a__fdf6_b8_nd9_plain.qmd"
    assert (
        suggested_name("a", EncodeSettings(QmdSettings(encoder=Encoder.BOUNDED, max_error_mm=0.5)), 10)
        == "a__within0.5mm.qmd"
    )


@pytest.mark.parametrize(
    "stem", ["walk__fdf11_b9_nd90", "walk__fdf6_b8_nd9_paper_k2_rqt500-3", "walk__within0.5mm", "walk__within1e-05mm-2"]
)
def test_a_file_that_is_exported_again_names_its_settings_once(stem):
    assert suggested_name(stem, EncodeSettings(QmdSettings()), 343) == "walk__fdf6_b8_nd342.qmd"


def test_another_file_of_that_name_is_left_alone(tmp_path):
    path = tmp_path / "walk.qmd"
    path.write_bytes(b"another")
    (tmp_path / "walk-2.qmd").write_bytes(b"one more")
    done = export_numbered(b"mine", path)
    assert done.path.name == "walk-3.qmd"
    assert done.path.read_bytes() == b"mine"
    assert path.read_bytes() == b"another"


def test_the_same_bytes_are_not_written_twice(tmp_path):
    first = export_numbered(b"mine", tmp_path / "walk.qmd")
    again = export_numbered(b"mine", tmp_path / "walk.qmd")
    assert (first.written, again.written) == (True, False)
    assert again.path == first.path
    assert [p.name for p in tmp_path.iterdir()] == ["walk.qmd"]


def test_a_name_that_the_user_chose_is_written_over(tmp_path):
    path = tmp_path / "walk.qmd"
    path.write_bytes(b"another")
    assert export_over(b"mine", path).path == path
    assert path.read_bytes() == b"mine"


def test_a_folder_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(StorageError):
        export_numbered(b"mine", tmp_path / "gone" / "walk.qmd")
