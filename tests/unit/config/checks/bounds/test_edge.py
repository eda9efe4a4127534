"""How far a figure may go towards a value that is not allowed."""

import pytest

from cellctl.config.checks.bounds.edge import farthest_allowed

EDGE = 3.7


@pytest.mark.parametrize(("allowed", "refused"), [(0.0, 10.0), (0.0, 1e5)])
def test_the_greatest_allowed_value_is_found(allowed: float, refused: float) -> None:
    found = farthest_allowed(allowed, refused, lambda value: value <= EDGE, within=1e-6)
    assert EDGE - 1e-6 <= found <= EDGE


def test_the_least_allowed_value_is_found_likewise() -> None:
    found = farthest_allowed(10.0, 0.0, lambda value: value >= EDGE, within=1e-6)
    assert EDGE <= found <= EDGE + 1e-6
