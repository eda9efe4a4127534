"""How a drawing's axes point is not assumed: the layout and the rims decide."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.errors.vision import HoleAmbiguous, HoleMissing
from cellctl.geometry.pose import MM
from cellctl.vision.features.hole import Hole
from cellctl.vision.measure import measure_pair
from tests.rigs.sweeps import sweep
from tests.unit.vision.plates import (
    Light,
    Pair,
    holes_triangle,
    plate_facing,
    render_pair,
    table_1_head,
)

HEAD = table_1_head()
HOLES = holes_triangle()
POSE = plate_facing(3.0, -2.0, 6.0)
TRUTH = POSE.apply(np.array([hole.position_m for hole in HOLES]))
OUT = np.array([0.0, 0.0, 1.0])


@pytest.fixture(scope="module")
def pair() -> Pair:
    return render_pair(HEAD, POSE, HOLES, Light(), seed=5)


def drawn_in(frame: RigidTransform, outward: np.ndarray | None = None) -> tuple[Hole, ...]:
    return tuple(
        replace(hole, position_m=frame.apply(hole.position_m), outward=outward) for hole in HOLES
    )


@pytest.mark.parametrize(
    "turn",
    [
        Rotation.from_euler("x", 180, degrees=True),
        Rotation.from_euler("xyz", [50, -35, 20], degrees=True),
        Rotation.from_euler("y", 90, degrees=True),
    ],
    ids=["z into the part", "askew", "face along y and z"],
)
def test_any_frame_of_the_drawing_will_do(pair: Pair, turn: Rotation) -> None:
    frame = RigidTransform.from_components([0.2, -0.1, 0.05], turn)
    result = measure_pair(*pair, HEAD, drawn_in(frame))
    assert np.abs(result.positions_m - TRUTH).max() < 10e-6


def test_a_stated_face_must_look_at_the_head(pair: Pair) -> None:
    same = RigidTransform.identity()
    result = measure_pair(*pair, HEAD, drawn_in(same, OUT))
    assert np.abs(result.positions_m - TRUTH).max() < 10e-6
    with pytest.raises(HoleMissing):
        measure_pair(*pair, HEAD, drawn_in(same, -OUT))


def test_a_layout_that_is_its_own_mirror_image_needs_the_face_stated() -> None:
    corners = ((-50, -40), (50, -40), (0, 40))
    isosceles = tuple(
        Hole(f"E{index}", "pin", 6 * MM, np.array([x, y, 0.0]) * MM)
        for index, (x, y) in enumerate(corners)
    )
    images = render_pair(HEAD, POSE, isosceles, Light(), seed=6)
    with pytest.raises(HoleAmbiguous):
        measure_pair(*images, HEAD, isosceles)
    stated = tuple(replace(hole, outward=OUT) for hole in isosceles)
    truth = POSE.apply(np.array([hole.position_m for hole in isosceles]))
    assert np.abs(measure_pair(*images, HEAD, stated).positions_m - truth).max() < 10e-6


@pytest.mark.parametrize("count", sweep((1, 2), (1,)))
def test_one_or_two_holes_are_measured_in_the_plane_of_their_rims(count: int) -> None:
    """The plate stands 16° askew to the line of sight: taken square to it, a hole is 0.1 px off."""
    few = (HOLES[0], replace(HOLES[1], diameter_m=8 * MM))[:count]
    images = render_pair(HEAD, POSE, few, Light(), seed=7)
    result = measure_pair(*images, HEAD, few)
    for hole, truth in zip(result.holes, TRUTH, strict=False):
        error = hole.position_m - truth
        assert error @ np.linalg.solve(hole.covariance_m2, error) < 20.0
        assert np.linalg.norm(error) < 10e-6
