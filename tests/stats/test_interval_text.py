"""Intervals are shown with the digits that their width allows."""

import pytest

from qtab.stats import Interval


@pytest.mark.parametrize(
    ("numbers", "text"),
    [
        ((-180.026, -181.537, -178.514), "-180.0 [-181.5, -178.5]"),
        ((0.0201, 0.00384, 0.03636), "0.020 [0.004, 0.036]"),
        ((1.0, 0.963007, 1.0), "1.000 [0.963, 1.000]"),
        ((-0.0001, -0.5, 0.5), "0.00 [-0.50, 0.50]"),
        ((12345.6, 12000.0, 12700.0), "12346 [12000, 12700]"),
        ((5.0, 5.0, 5.0), "5 [5, 5]"),
        ((0.0, -1e-9, 1e-9), "0 [-1e-09, 1e-09]"),
        ((1e300, -float("inf"), float("inf")), "1e+300 [-inf, inf]"),
        ((float("nan"), float("nan"), float("nan")), "nan [nan, nan]"),
    ],
)
def test_an_interval_has_two_digits_of_half_its_width(numbers: tuple[float, float, float], text: str) -> None:
    assert str(Interval(*numbers, 0.95, "t")) == text
