"""Times after which something stops, and how long each may be before it protects nothing.

Drivers name such a setting as those here do; docs/guard.md, "Times that protect", has the table.
"""

from collections.abc import Iterator, Set
from dataclasses import dataclass
from typing import TypeGuard

from cellctl.config.cell import CellConfig
from cellctl.config.devices import GROUPS
from cellctl.config.document.leaves import leaves
from cellctl.config.driver_settings import checked_settings
from cellctl.config.issue import ConfigIssue

MOST_WAY_MM = 150.0
"""Longest way that an arm may go on by itself: what people leave free between an arm that passes
and a fixture."""
MOST_WAY_SIMULATED_MM = 600.0


@dataclass(frozen=True, slots=True)
class ProtectiveTime:
    """Bounds of the settings of one name, in seconds."""

    most_s: float
    most_simulated_s: float
    """Wider, because a fake cell shares the processors of a PC with the daemon and hits nothing."""
    why: str
    goes_on: bool = False
    """Whether an arm goes on for so long, so that its speed bounds the time as well."""
    sections: tuple[str, ...] = ()
    """Sections in which the name means this; none: in all."""


PROTECTIVE_TIMES = {
    "max_deadman_s": ProtectiveTime(
        1.0, 2.0, "an arm that has lost this PC goes on for so long", goes_on=True
    ),
    "heartbeat_ms": ProtectiveTime(
        1.0, 2.0, "an arm that has lost this PC goes on for so long", goes_on=True
    ),
    "silence_s": ProtectiveTime(
        1.0, 2.0, "an arm that reports nothing goes on unseen for so long", goes_on=True
    ),
    "stale_s": ProtectiveTime(
        0.5, 1.0, "a motion is planned from where the arm was so long ago", goes_on=True
    ),
    "max_stream_loss_s": ProtectiveTime(
        0.5, 1.0, "in contact an arm goes on to its last setpoint for so long"
    ),
    "stop_timeout_s": ProtectiveTime(
        5.0, 5.0, "that a stop was not obeyed is found so late; arms stop within a second"
    ),
    "reply_timeout_s": ProtectiveTime(
        3.0,
        5.0,
        "a device that does not answer, a stop included, is found so late",
        sections=("robots", "force_sensors", "digital_ios", "grippers"),
    ),
    "max_watchdog_s": ProtectiveTime(
        1.0, 2.0, "outputs, a permit included, stay on for so long when this PC dies"
    ),
    "max_lag_s": ProtectiveTime(
        0.5, 1.0, "the guard learns of a contact so late; at 1 mm/s 0.5 s are 50 N at 100 N/mm"
    ),
    "stale_ms": ProtectiveTime(
        0.1, 0.5, "the guard watches nothing for so long; at 1 mm/s 0.1 s are 100 N at 1000 N/mm"
    ),
    "flange_age_ms": ProtectiveTime(
        0.25, 1.0, "the guard subtracts the weight for a pose of so long ago"
    ),
    "lost_tick_ms": ProtectiveTime(
        0.1, 1.0, "in contact nobody corrects the arm for so long; five ticks of a slow stream"
    ),
    "old_force_ms": ProtectiveTime(
        0.05, 0.5, "the arm goes on against a force that was measured so long ago"
    ),
    "lost_force_ms": ProtectiveTime(
        0.1, 1.0, "the contact goes on without a force for so long; at 1 mm/s 10 N at 100 N/mm"
    ),
    "heartbeat_timeout_s": ProtectiveTime(
        5.0, 5.0, "the cell works for so long without its line, whose PLC beats twice a second"
    ),
}


def protective_time_issues(cell: CellConfig, bad: Set[str]) -> Iterator[ConfigIssue]:
    """Every protective time that is too long to protect.

    ``bad`` holds the paths of devices whose settings are wrong themselves.
    """
    for key, value in _values(cell, bad):
        section, name = key.split(".", 1)[0], key.rsplit(".", 1)[-1]
        rule = PROTECTIVE_TIMES.get(name)
        if rule is None or not _is_number(value):
            continue
        if not rule.sections or section in rule.sections:
            yield from _too_long(cell, key, float(value), rule)


def most_way_mm(cell: CellConfig) -> float:
    """Longest way that an arm of this cell may go on by itself."""
    return MOST_WAY_SIMULATED_MM if cell.simulated else MOST_WAY_MM


def times_alone_s(cell: CellConfig, robot: str) -> dict[str, float]:
    """Times for which an arm goes on by itself, by the key and value that say so."""
    settings = checked_settings(GROUPS["robots"], cell.robots[robot]).model_dump()
    return {
        f"{key} = {value:g}": float(value) * _unit(key)[0]
        for key, value in leaves(settings)
        if key in PROTECTIVE_TIMES and PROTECTIVE_TIMES[key].goes_on and _is_number(value)
    }


def _values(cell: CellConfig, bad: Set[str]) -> Iterator[tuple[str, object]]:
    """Values of the cell, those of settings that it leaves to their defaults included."""
    devices = cell.devices()
    settings_of = tuple(f"{path}.settings." for path in devices)
    for key, value in leaves(cell.model_dump()):
        if not key.startswith(settings_of):
            yield key, value
    for path, (group, device) in devices.items():
        if ".".join(path.split(".")[:2]) not in bad:
            yield from leaves(checked_settings(group, device).model_dump(), f"{path}.settings.")


def _too_long(
    cell: CellConfig, key: str, value: float, rule: ProtectiveTime
) -> Iterator[ConfigIssue]:
    unit_s, unit = _unit(key)
    most_s = rule.most_simulated_s if cell.simulated else rule.most_s
    why = rule.why
    speed_mm_s = _fastest_mm_s(cell, key) if rule.goes_on else None
    if speed_mm_s is not None:
        way_mm = most_way_mm(cell)
        if way_mm / speed_mm_s < most_s:
            most_s = way_mm / speed_mm_s
            why = f"{why}: {way_mm:g} mm at {speed_mm_s:g} mm/s"
    if value * unit_s > most_s:
        allowed = f"at most {most_s / unit_s:.3g} {unit}: {why}"
        yield ConfigIssue(key, f"{value:g}", allowed)


def _fastest_mm_s(cell: CellConfig, key: str) -> float | None:
    """Speed of the straight moves of the arm that a device is, or is mounted on."""
    section, name = key.split(".")[:2]
    if section == "force_sensors":
        name = cell.force_sensors[name].mounted_on
    robot = cell.robots.get(name)
    return None if robot is None else robot.linear_speed_mm_s


def _unit(key: str) -> tuple[float, str]:
    return (1e-3, "ms") if key.endswith("_ms") else (1.0, "s")


def _is_number(value: object) -> TypeGuard[float]:
    return isinstance(value, int | float) and not isinstance(value, bool)
