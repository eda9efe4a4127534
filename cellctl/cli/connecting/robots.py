"""What a robot is asked: who it is, how it stands, how often it reports."""

from cellctl.cell.arm_loads import require_selected_loads
from cellctl.cell.readiness import reasons_not_ready
from cellctl.cell.robot_reports import (
    ANY_AGE_S,
    NOT_TOLD,
    RobotReports,
    joints_deg,
    listen,
    selection_as_json,
)
from cellctl.cli.commissioning.one_robot import connected
from cellctl.cli.connecting.answer import Answer, spread_ms
from cellctl.config import CellConfig
from cellctl.config.driver_settings import robot_driver
from cellctl.errors.robot import OtherLoadSelected, TargetOutOfBounds

LISTEN_S = 1.0


async def ask_robot(cell: CellConfig, name: str) -> Answer:
    """Connect, listen for a second, let go. Re-arms nothing; raises what the driver raises."""
    config = cell.robots[name]
    differs: list[str] = []
    async with connected(cell, name) as (robot, connect_s):
        # Before anything else: a link that is dropped meanwhile would latch the arm.
        latched = robot.state(ANY_AGE_S).stop_latched
        notes = [f"would refuse a motion: {why}" for why in reasons_not_ready(robot)]
        heard = await listen(robot, LISTEN_S)
        try:
            await require_selected_loads([robot], cell.robots)
        except OtherLoadSelected as fault:
            differs.append(fault.detail)
    driver, settings = robot_driver(config)
    try:
        driver.check_joint_target(settings, heard.state.joints_rad)
    except TargetOutOfBounds as fault:
        notes.append(f"stands outside of the bounds of the cell file: {fault.detail}")
    override_percent = 100.0 * heard.state.speed_override_ratio
    if override_percent < 100.0:
        notes.append(f"the override at the pendant is {override_percent:.0f} %")
    return Answer(
        f"robots.{name}",
        config.driver,
        _facts(heard, connect_s) | {"stop latch, as found": "set" if latched else "not set"},
        differs=tuple(differs),
        notes=tuple(notes),
    )


def _facts(heard: RobotReports, connect_s: float) -> dict[str, str]:
    state = heard.state
    facts = {"connected after": f"{connect_s:.2f} s", **heard.facts}
    facts["reports"] = f"{len(heard.periods_s)} in {LISTEN_S:g} s, {spread_ms(heard.periods_s)}"
    if heard.round_trips_s:
        facts["answers after"] = spread_ms(heard.round_trips_s)
    drives = "on" if state.drives_on else "off"
    stop = "pressed" if state.emergency_stop else "not pressed"
    facts["state"] = f"{state.mode.value}, drives {drives}, emergency stop {stop}"
    facts["joints"] = "  ".join(f"{angle:.3f}" for angle in joints_deg(state)) + " deg"
    told = {k: v for k, v in selection_as_json(heard.selection).items() if v != NOT_TOLD}
    words = "; ".join(f"{key}: {value}" for key, value in told.items())
    facts["at the pendant"] = words or NOT_TOLD
    return facts
