import numpy as np
import pytest

from cellctl.config.devices import RobotConfig
from cellctl.config.via_points import has_way, via_points

HOME, OVER = (0.0, -90.0, 90.0, 0.0, 90.0, 90.0), (0.0, -50.0, 110.0, 0.0, 30.0, 90.0)
VIA = ((20.0, -70.0, 115.0, 0.0, 80.0, 90.0), (10.0, -60.0, 112.0, 0.0, 60.0, 90.0))
ROBOT = RobotConfig.model_validate(
    {
        "driver": "any",
        "poses_deg": {"home": HOME, "over": OVER, "other": (5.0,) * 6},
        "ways": [{"start": "home", "end": "over", "via_deg": VIA}],
    }
)


def ahead(here_deg: np.ndarray | tuple[float, ...], pose: str = "over") -> list[list[float]]:
    found = via_points(ROBOT, np.radians(here_deg), pose)
    return [np.degrees(point).round(6).tolist() for point in found]


def test_the_whole_way_lies_ahead_of_its_start() -> None:
    assert ahead(HOME) == [list(point) for point in VIA]


def test_an_arm_that_was_stopped_on_the_way_goes_on_from_there() -> None:
    between = (np.array(VIA[0]) + np.array(VIA[1])) / 2
    assert ahead(between + 0.2) == [list(VIA[1])]
    assert ahead(np.array(OVER)) == []


@pytest.mark.parametrize("pose", ["home", "other"])
def test_a_pose_to_which_no_way_leads_is_reached_straight(pose: str) -> None:
    assert ahead(HOME, pose) == []
    assert not has_way(ROBOT, "over", pose)


def test_an_arm_beside_the_way_goes_straight() -> None:
    assert ahead(np.array(HOME) + 3.0) == []
