"""The load of the cell file against what a controller reckons with and what was weighed."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import RigidTransform

from cellctl.cell.arm_loads import require_selected_loads, weighed_checks
from cellctl.config.devices import LoadConfig, RobotConfig
from cellctl.errors.robot import OtherLoadSelected
from cellctl.interfaces import ArmLoad, PendantSelection
from tests.unit.cell.robots import StillRobot

LOAD = {"mass_kg": 20.0, "com_mm": (0.0, 10.0, 100.0), "tolerance_kg": 0.5, "tolerance_mm": 5.0}
COM_M = np.array([0.0, 0.01, 0.1])
BEFORE_SENSOR = RigidTransform.from_translation([0.0, 0.0, 0.06])


@dataclass
class TellingRobot(StillRobot):
    """Its controller says what is selected."""

    selected: ArmLoad | None = None

    async def selection(self) -> PendantSelection:
        return PendantSelection(self.selected)


def configs(load: LoadConfig | None) -> dict[str, RobotConfig]:
    return {"arm": RobotConfig(driver="siasun-rpc", load=load)}


@pytest.mark.parametrize(
    "selected",
    [
        None,
        ArmLoad(20.4, COM_M),
        ArmLoad(19.6, None),
        ArmLoad(20.0, COM_M + np.array([0.0, -0.004, 0.004])),
    ],
)
async def test_the_stated_load_passes(selected: ArmLoad | None) -> None:
    stated = LoadConfig.model_validate(LOAD)
    await require_selected_loads([TellingRobot("arm", selected=selected)], configs(stated))


@pytest.mark.parametrize(
    ("selected", "said"),
    [
        (ArmLoad(0.0, COM_M), "selected load differs by -20 kg"),
        (ArmLoad(20.6, None), "0.6 kg"),
        (ArmLoad(20.0, COM_M + np.array([0.006, 0.0, 0.0])), "centre of mass by 6 mm"),
        (ArmLoad(float("nan"), None), "nan kg"),
    ],
)
async def test_another_one_is_refused(selected: ArmLoad, said: str) -> None:
    stated = LoadConfig.model_validate(LOAD)
    with pytest.raises(OtherLoadSelected, match=f"arm: .*{said}"):
        await require_selected_loads([TellingRobot("arm", selected=selected)], configs(stated))


async def test_without_a_stated_load_nothing_is_asked() -> None:
    robot = TellingRobot("arm", selected=ArmLoad(500.0, None))
    await require_selected_loads([robot], configs(None))


@pytest.mark.parametrize(
    ("weighed_kg", "off_m", "passed"),
    [(18.0, 0.0, [True, True]), (18.6, 0.0, [False, True]), (18.0, 0.006, [True, False])],
)
def test_what_is_weighed_is_the_load_without_the_sensor(
    weighed_kg: float, off_m: float, passed: list[bool]
) -> None:
    """The sensor is 2 kg of the 20 kg, 60 mm before the flange; the rest hangs lower."""
    stated = LoadConfig.model_validate(LOAD | {"not_weighed_kg": 2.0})
    flange_r_com_m = (20.0 * COM_M - 2.0 * BEFORE_SENSOR.translation) / 18.0
    sensor_r_com_m = BEFORE_SENSOR.inv().apply(flange_r_com_m) + np.array([off_m, 0.0, 0.0])
    checks = weighed_checks(stated, weighed_kg, sensor_r_com_m, BEFORE_SENSOR)
    assert [check.passed for check in checks] == passed


def test_a_load_is_more_than_what_is_not_weighed() -> None:
    with pytest.raises(ValueError, match="not_weighed_kg"):
        LoadConfig.model_validate(LOAD | {"not_weighed_kg": 20.0})
