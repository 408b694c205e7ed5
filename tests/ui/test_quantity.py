import pytest

from qmd_studio.ui.quantity import kilobytes, millimetres, significant


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0, "0"),
        (0.00001, "< 0.0001"),
        (0.00902, "0.0090"),
        (0.4801, "0.480"),
        (1.474, "1.47"),
        (27.39, "27.4"),
        (812.3, "812"),
    ],
)
def test_a_value_has_the_digits_that_count(value, text):
    assert significant(value) == text


def test_a_large_error_is_told_in_metres():
    assert millimetres(999.0) == "999 mm"
    assert millimetres(1834.0) == "1.83 m"


def test_a_kilobyte_has_1024_bytes():
    assert kilobytes(28645) == "28.0 KB"
    assert kilobytes(3 * 1024**2) == "3.00 MB"
