"""The load that the cell file states for an arm, held against what its controller reckons with."""

from collections.abc import Iterable, Mapping

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.config.devices import LoadConfig, RobotConfig
from cellctl.errors.robot import OtherLoadSelected
from cellctl.force.gravity.acceptance import PayloadCheck
from cellctl.geometry.pose import MM, Array
from cellctl.interfaces import ArmLoad, Robot


async def require_selected_loads(
    robots: Iterable[Robot], configs: Mapping[str, RobotConfig]
) -> None:
    """Raise ``OtherLoadSelected`` for the first arm whose controller reckons with another load.

    An arm whose controller does not tell its load, or whose section states none, passes.
    """
    for robot in robots:
        stated = configs[robot.name].load
        if stated is None:
            continue
        selected = (await robot.selection()).load
        if selected is None:
            continue
        wrong = [str(check) for check in _selected_checks(stated, selected) if not check.passed]
        if wrong:
            raise OtherLoadSelected(f"{robot.name}: {'; '.join(wrong)}")


def weighed_checks(
    stated: LoadConfig, weighed_kg: float, sensor_r_com_m: Array, flange_T_sensor: RigidTransform
) -> tuple[PayloadCheck, ...]:
    """What hangs on the force sensor against the load that is stated.

    ``sensor_r_com_m`` has shape (3,), in the frame of the sensor.
    """
    # By moments about the flange. What the sensor does not feel acts at the origin of its frame, as
    # ``not_weighed_kg`` says of itself.
    expected_kg = stated.mass_kg - stated.not_weighed_kg
    moment_kg_mm = stated.mass_kg * np.asarray(stated.com_mm)
    moment_kg_mm -= stated.not_weighed_kg * flange_T_sensor.translation / MM
    found_mm = flange_T_sensor.apply(sensor_r_com_m) / MM
    off_mm = float(np.abs(found_mm - moment_kg_mm / expected_kg).max())
    return (
        PayloadCheck(
            "mass beside the load of the cell file",
            weighed_kg - expected_kg,
            stated.tolerance_kg,
            "kg",
        ),
        PayloadCheck(
            "centre of mass beside that of the cell file", off_mm, stated.tolerance_mm, "mm"
        ),
    )


def _selected_checks(stated: LoadConfig, selected: ArmLoad) -> tuple[PayloadCheck, ...]:
    off_kg = selected.mass_kg - stated.mass_kg
    checks = [PayloadCheck("selected load differs by", off_kg, stated.tolerance_kg, "kg")]
    if selected.flange_r_com_m is not None:
        off_mm = float(np.abs(selected.flange_r_com_m / MM - np.asarray(stated.com_mm)).max())
        checks.append(PayloadCheck("its centre of mass by", off_mm, stated.tolerance_mm, "mm"))
    return tuple(checks)
