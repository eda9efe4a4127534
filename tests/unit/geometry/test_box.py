"""Ways that meet a box, held against many points on them."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cellctl.geometry.box import Box
from tests.rigs.sweeps import examples

BOX = Box.from_mm([1000.0, -500.0, 0.0], [2000.0, 500.0, 800.0])
coordinate = st.one_of(st.floats(-3.0, 3.0), st.sampled_from([0.0, 0.5, -0.5, 0.8, 1.0, 1.5, 2.0]))
point = st.tuples(coordinate, coordinate, coordinate).map(np.array)


@settings(max_examples=examples(40))
@given(point, point)
def test_a_line_meets_the_box_exactly_when_points_of_it_lie_there(
    begin: np.ndarray, end: np.ndarray
) -> None:
    places = np.linspace(begin, end, 200)
    met = BOX.meets(np.array([begin, end]))
    # Rounding may put a point of a line that touches a face on either side of it.
    if any(BOX.grown(-1e-9).holds(place) for place in places):
        assert met
    if met:
        between_m = float(np.linalg.norm(end - begin)) / 199
        assert any(BOX.grown(between_m + 1e-9).holds(place) for place in places)


@settings(max_examples=examples(40))
@given(st.lists(point, min_size=2, max_size=5))
def test_a_way_meets_the_box_when_one_of_its_lines_does(points: list[np.ndarray]) -> None:
    lines = [BOX.meets(np.array(line)) for line in pairwise(points)]
    assert BOX.meets(np.array(points)) is any(lines)


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        ([[0, 0, 0.4], [3, 0, 0.4]], True),
        ([[0, 0, 0.9], [3, 0, 0.9]], False),
        ([[0, 0, 0.8], [3, 0, 0.8]], True),
        ([[0, -1.4, 0.4], [1.2, 0.0, 0.4]], True),
        ([[0, 0.0, 0.4], [0.9, 0.0, 0.4]], False),
        ([[0.8, 0.4, 0.4], [1.1, 0.7, 0.4]], False),
        ([[0.9, 0.35, 0.4], [1.1, 0.55, 0.4]], True),
        ([[1.5, 0.0, 0.4]], True),
        ([[0.5, 0.0, 0.4]], False),
        ([[0.0, 0.0, 0.4], [0.5, 0.0, np.nan]], True),
    ],
)
def test_a_way_meets_the_box(points: list[list[float]], *, expected: bool) -> None:
    assert BOX.meets(np.array(points, dtype=float)) is expected


def test_a_place_that_is_not_a_number_counts_as_inside() -> None:
    assert BOX.holds(np.array([5.0, np.nan, 0.0]))
    assert not BOX.holds(np.array([0.9, 0.0, 0.4]))
    assert BOX.grown(0.2).holds(np.array([0.9, 0.0, 0.4]))
