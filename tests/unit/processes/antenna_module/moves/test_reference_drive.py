"""Where the drive goes, and that its reading is in the axes of the base."""

import numpy as np
import pytest

from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.faults.plugging import LooksIncomplete
from cellctl.processes.antenna_module.moves import reference_drive
from tests.unit.processes.antenna_module.chain.reference_draws import ARM
from tests.unit.processes.antenna_module.moves.reference_world import (
    BASE_T_PLATE,
    INSPECT,
    World,
    drive,
)


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch) -> World:
    made = World()
    monkeypatch.setattr(reference_drive, "Mover", lambda _: made)
    return made


async def test_the_reading_is_in_the_axes_of_the_base(world: World) -> None:
    reading = (await drive(world, []).looks(8)).reading(ARM)
    np.testing.assert_allclose(reading.axis_in_camera_2, [0, 0], atol=1e-9)
    marks_m = INSPECT.rotation.apply(np.array([0.3, -0.2, 0.0]) * MM)[:2]
    np.testing.assert_allclose(reading.marks_from_axis, marks_m, atol=1e-9)
    for place in (reading.plate_in_camera_1, reading.plate_in_camera_2):
        np.testing.assert_allclose(place, BASE_T_PLATE.translation[:2], atol=1e-9)


async def test_every_look_has_an_approach_of_its_own(world: World) -> None:
    told: list[tuple[int, int]] = []
    looks = await drive(world, told).looks(4, first=5)
    assert told == [(5, 8), (6, 8), (7, 8), (8, 8)]
    turned, over_plate = world.visited[::2], world.visited[1::2]
    assert over_plate == ["reference_look"] * 4
    assert turned == pytest.approx([-171.0, 9.0, -165.0, 15.0])
    assert (len(looks.plate_in_camera_1), len(looks.plate_in_camera_2)) == (4, 1)


@pytest.mark.parametrize("name", ["gripper", "above", "below"])
async def test_marks_that_are_not_seen_are_named(world: World, name: str) -> None:
    world.hidden = name
    with pytest.raises(LooksIncomplete, match=name):
        await drive(world, []).looks(4)
