"""Listens to the reports of one robot for a while and writes them for people. Moves nothing."""

import asyncio
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cellctl.clock import now_s
from cellctl.geometry.pose import MM, Array, pose_to_xyzabc
from cellctl.interfaces import PendantSelection, Robot, RobotState

ANY_AGE_S = 1e9
"""Greatest age for ``Robot.state`` where even an old report is wanted: some thirty years."""
_LOOK_S = 0.005
"""Pause between two looks at the newest report: a quarter of the 20 ms in which controllers report,
so that none is missed and its age is known to 5 ms."""
NOT_TOLD = "not told by this controller"


@dataclass(slots=True)
class RobotReports:
    """What one robot has reported."""

    facts: dict[str, str]
    """Facts of its link, by name."""
    state: RobotState
    """The newest report."""
    periods_s: list[float] = field(default_factory=list)
    """Times from one report to the next."""
    oldest_s: float = 0.0
    """Greatest age that the newest report has had."""
    round_trips_s: tuple[float, ...] = ()
    """From a question or command to its first answer, the newest ones."""
    selection: PendantSelection = field(default_factory=PendantSelection)

    def as_json(self) -> dict[str, dict[str, Any]]:
        """The reports by part and name, in ms, mm and degrees."""
        return {
            "link": dict(self.facts),
            "reports": {
                "count": len(self.periods_s),
                **_percentiles("period_ms", self.periods_s),
                "oldest_ms": round(1000 * self.oldest_s, 1),
            },
            "round_trips": {
                "count": len(self.round_trips_s),
                **_percentiles("ms", self.round_trips_s),
            },
            "selected_at_the_pendant": selection_as_json(self.selection),
            "state": state_as_json(self.state),
        }


async def listen(robot: Robot, seconds: float) -> RobotReports:
    """Collect the reports of a connected robot for so long; raises what its ``state`` raises."""
    heard = RobotReports(robot.link_facts(), robot.state(ANY_AGE_S))
    end_s = now_s() + seconds
    while now_s() < end_s:
        state, before = robot.state(ANY_AGE_S), heard.state
        if state.time_s > before.time_s:
            heard.periods_s.append(state.time_s - before.time_s)
            heard.state = state
        heard.oldest_s = max(heard.oldest_s, now_s() - state.time_s)
        await asyncio.sleep(_LOOK_S)
    # Asked again at the end: a second channel may have said hello only after the first question.
    heard.facts, heard.round_trips_s = robot.link_facts(), robot.round_trips_s()
    heard.selection = await robot.selection()
    return heard


def selection_as_json(selection: PendantSelection) -> dict[str, Any]:
    """Load in kg and mm of the flange, frames as x, y, z, A, B, C in mm and degrees."""
    frames = {
        "flange_T_tool_xyzabc_mm_deg": selection.flange_T_tool,
        "base_T_work_xyzabc_mm_deg": selection.base_T_work,
    }
    written = {
        name: NOT_TOLD if frame is None else _numbers(pose_to_xyzabc(frame))
        for name, frame in frames.items()
    }
    load = selection.load
    if load is None:
        return {"load_kg": NOT_TOLD, **written}
    com_m = load.flange_r_com_m
    return {
        "load_kg": round(load.mass_kg, 3),
        "load_com_mm": NOT_TOLD if com_m is None else _numbers(com_m / MM),
        **written,
    }


def _numbers(values: Array) -> list[float]:
    return [round(float(value), 4) for value in values]


def state_as_json(state: RobotState) -> dict[str, Any]:
    """A state in the units of the cell file: mm and degrees, angles A, B, C of Rz Ry Rx."""
    return {
        "mode": state.mode.value,
        "emergency_stop": state.emergency_stop,
        "drives_on": state.drives_on,
        "moving": state.moving,
        "stop_latched": state.stop_latched,
        "error_code": state.error_code,
        "error_words": state.error_words,
        "override_percent": round(100.0 * state.speed_override_ratio, 1),
        "flange_xyzabc_mm_deg": _numbers(pose_to_xyzabc(state.base_T_flange)),
        "joints_deg": joints_deg(state),
    }


def joints_deg(state: RobotState) -> list[float]:
    """Joints in degrees, as they are written in a cell file."""
    return [round(float(angle), 5) + 0.0 for angle in np.degrees(state.joints_rad)]


def _percentiles(name: str, times_s: list[float] | tuple[float, ...]) -> dict[str, float]:
    if not times_s:
        return {}
    figures = np.percentile(times_s, [50, 99, 100]) * 1000
    return {
        f"{name}_{part}": round(float(figure), 2)
        for part, figure in zip(("p50", "p99", "max"), figures, strict=True)
    }
