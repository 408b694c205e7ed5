"""The closed form of the size against both tables of the paper."""

import pytest

from qmd_studio.codecs.qmd.size import payload_size
from tests.paper_tables import PAPER_SIZES


@pytest.mark.parametrize(("name", "n", "fdf", "bits", "segment", "printed_kb"), PAPER_SIZES)
def test_payload_size_for_each_row_of_the_paper_is_what_it_prints(name, n, fdf, bits, segment, printed_kb):
    size = payload_size(n, 62, fdf, bits, segment)
    assert abs(size.bytes / 1024 - printed_kb) < 0.15


def test_payload_size_of_the_paper_s_jog_is_exact_to_the_byte():
    assert payload_size(136, 62, 6, 8).bytes == 12_165


def test_payload_size_parts_add_up_and_a_last_short_segment_costs_its_own_rows_only():
    size = payload_size(100, 62, 6, 10, 30)
    assert size.header_bytes == 4 * 13
    assert size.table_bytes == 4 * 4096
    assert size.exact_bytes == 100 * 24
    assert size.index_bytes == 100 * 2 * 56
    assert size.pose_bytes == 248
    assert size.bytes == sum((4 * 13, 4 * 4096, 2400, 11_200, 248))


def test_payload_size_of_a_motion_of_one_frame_is_a_header_a_table_and_the_pose():
    assert payload_size(0, 62, 6, 8, 30).bytes == 13 + 1024 + 248
