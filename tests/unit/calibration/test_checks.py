"""Figures against their limits, in words."""

from math import nan

import pytest

from cellctl.calibration.checks import LimitCheck


@pytest.mark.parametrize(
    ("check", "words"),
    [
        (LimitCheck("residual", 0.2, 0.3, "mm"), "residual 0.2 mm (≤ 0.3): ok"),
        (LimitCheck("views", 3, 20, "", "min"), "views 3 (≥ 20): OUT OF LIMIT"),
        (LimitCheck("seat force", nan, 5, "N", "min"), "seat force not measured (≥ 5 N)"),
        (LimitCheck("views", nan, 20, "", "min"), "views not measured (≥ 20)"),
    ],
)
def test_a_check_in_words(check: LimitCheck, words: str) -> None:
    assert str(check) == words
