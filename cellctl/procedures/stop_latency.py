"""Measures how long a robot takes to stop at the speeds of contact."""

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.checks import all_passed
from cellctl.calibration.store.envelope import read_calibration
from cellctl.calibration.store.kind import CalibrationKind, verdict_is_pass
from cellctl.cell.readiness import require_full_speed
from cellctl.errors.calibration import CalibrationError
from cellctl.errors.force import CommissioningFailed
from cellctl.errors.robot import MotionAborted, NotRearmed
from cellctl.geometry.pose import MM, Array
from cellctl.interfaces import Robot
from cellctl.procedures.stop_latency_result import METHOD, UPPER_BOUND, StopLatency, TimedStop
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.workers import VisionWorkers

SPEEDS_M_S = (2e-3, 4e-3, 6e-3, 8e-3)
"""Speeds of contact, evenly: the latency is the slope of overrun against speed."""
REPEATS = 3
"""Motions at each speed."""
TRAVEL_M = 0.03
"""Way of one motion: three times as far as the arm goes at 8 mm/s before it is told to stop. Its
own braking before the target must not pass for the stop."""
RUN_S = 1.0
"""Time on the way before the stop is requested: the speed is constant by then."""
ACCELERATION_M_S2 = 0.05
"""The greatest of these speeds is reached within 0.7 mm."""
POLL_S = 0.01
START_TIMEOUT_S, END_TIMEOUT_S = 2.0, 5.0
"""Longest wait for the arm to move, and for it to stand."""
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class StoredStopLatency:
    """A result of this procedure that passed and was not invalidated."""

    kind: str
    made: datetime
    valid_until: datetime
    upper_ms: float


def stored_stop_latencies(folder: Path) -> tuple[StoredStopLatency, ...]:
    """Those in a folder of calibrations, by name; a file that cannot be read is none."""
    return tuple(_stored_stop_latencies(folder))


def _stored_stop_latencies(folder: Path) -> Iterator[StoredStopLatency]:
    for path in sorted(folder.glob("*.json")):
        try:
            stored = read_calibration(folder, path.stem)
        except CalibrationError:
            continue
        record = stored.record
        if record.get("method") == METHOD and verdict_is_pass(record):
            upper_ms = float(record["upper_ms"])
            yield StoredStopLatency(stored.kind, stored.made, stored.valid_until, upper_ms)


async def measure_stop_latency_on_cell(
    context: ProcedureContext,
    robot: Robot,
    workers: VisionWorkers,
    *,
    bound_ms: float,
    kind: CalibrationKind[float],
) -> ProcedureOutcome:
    """Stop the robot on its way up from where it stands, at several speeds.

    ``bound_ms``: what every recipe is safe with while this result is not valid.
    """

    async def safe_point(number: int, total: int) -> None:
        await context.progress(number, total, "stop")

    stops = await timed_stops(robot, UP, safe_point)
    taken = [stop.to_input() for stop in stops]
    await context.keep_input({"bound_ms": bound_ms, "direction": UP.tolist(), "stops": taken})
    measured = StopLatency.of(stops, UP)
    checks = measured.checks(bound_ms)
    data = measured.estimate, measured.speeds_m_s, measured.overruns_m
    # Loaded when it is drawn: checks of a cell file load this module for its moves.
    from cellctl.procedures.stop_latency_picture import latency_picture

    return ProcedureOutcome(
        kind=kind,
        record=measured.to_record(checks),
        passed=all_passed(checks),
        warnings=(),
        picture_png=await workers.run(latency_picture, *data, checks),
        serial_number="",
        bounds=frozenset({UPPER_BOUND}),
    )


async def measure_stop_latency(
    robot: Robot,
    direction: Array,
    safe_point: Callable[[int, int], Awaitable[None]],
    *,
    speeds_m_s: tuple[float, ...] = SPEEDS_M_S,
    repeats: int = REPEATS,
) -> StopLatency:
    """The latency from ``timed_stops``; raises what these raise, and ``CommissioningFailed``."""
    stops = await timed_stops(robot, direction, safe_point, speeds_m_s=speeds_m_s, repeats=repeats)
    return StopLatency.of(stops, direction)


async def timed_stops(
    robot: Robot,
    direction: Array,
    safe_point: Callable[[int, int], Awaitable[None]],
    *,
    speeds_m_s: tuple[float, ...] = SPEEDS_M_S,
    repeats: int = REPEATS,
) -> tuple[TimedStop, ...]:
    """Start, request a stop on the way, and see how far the arm still goes; return each time.

    ``direction``: unit vector in the base that is free for 30 mm; ``safe_point`` is awaited at
    standstill before each stop with its number and how many there are. Raises
    ``SpeedOverridden``, ``CommissioningFailed`` and what the robot and ``safe_point`` raise.
    """
    home = robot.state().base_T_flange
    speeds = [speed for speed in speeds_m_s for _ in range(repeats)]
    stops = []
    for number, speed_m_s in enumerate(speeds, start=1):
        await safe_point(number, len(speeds))
        stops.append(await _stop(robot, direction, speed_m_s))
        # A stop latches the robot; it takes no further motion before this.
        await robot.rearm()
        # Back to where it began, so that the travel is known to be free each time.
        await robot.move_linear(home, speed_m_s=0.01, acceleration_m_s2=ACCELERATION_M_S2)
    return tuple(stops)


async def _stop(robot: Robot, direction: Array, speed_m_s: float) -> TimedStop:
    # With an override on the pendant the arm is slower than commanded, and the slope of overrun
    # against commanded speed would be a latency that is too short. Asked again after the stop,
    # because the override may be turned on the way.
    require_full_speed(robot)
    start = robot.state().base_T_flange
    target = RigidTransform.from_translation(direction * TRAVEL_M) * start
    motion = asyncio.create_task(
        robot.move_linear(target, speed_m_s=speed_m_s, acceleration_m_s2=ACCELERATION_M_S2)
    )
    try:
        await _moving(robot, motion)
        await asyncio.sleep(RUN_S)
        state, request_s = robot.state(), asyncio.get_running_loop().time()
        await robot.stop()
        await _aborted(motion)
    finally:
        # Also after a fault: a motion that nobody awaits would go on without anyone to see how it
        # ends.
        motion.cancel()
        await asyncio.gather(motion, return_exceptions=True)
    require_full_speed(robot)
    stop = TimedStop(
        speed_m_s,
        start.translation,
        state.base_T_flange.translation,
        request_s - state.time_s,
        await at_rest(robot),
    )
    # Too near to its target, the arm was braking by itself, and the overrun says nothing about the
    # stop.
    if stop.way_m(direction) > TRAVEL_M - speed_m_s * 0.1:
        raise CommissioningFailed(
            f"at {speed_m_s / MM:.1f} mm/s the arm ran to its target instead of stopping"
        )
    return stop


async def _moving(robot: Robot, motion: asyncio.Task[object]) -> None:
    try:
        async with asyncio.timeout(START_TIMEOUT_S):
            while not robot.state().moving:
                if motion.done():
                    motion.result()
                await asyncio.sleep(POLL_S)
    except TimeoutError as error:
        raise CommissioningFailed("the robot accepted a motion but did not move") from error


async def _aborted(motion: asyncio.Task[object]) -> None:
    try:
        async with asyncio.timeout(END_TIMEOUT_S):
            await motion
    except (MotionAborted, NotRearmed):
        return
    except TimeoutError as error:
        raise CommissioningFailed("the stopped motion never ended") from error


async def at_rest(robot: Robot, timeout_s: float = END_TIMEOUT_S) -> Array:
    """Position in the base, m, shape (3,), once two reports in a row say the same and none of them
    is of a moving arm; raises ``CommissioningFailed`` when that does not come."""
    last, position = -1.0, np.full(3, np.nan)
    try:
        async with asyncio.timeout(timeout_s):
            while True:
                state = robot.state()
                if state.time_s > last:
                    here = state.base_T_flange.translation
                    if not state.moving and np.allclose(here, position, atol=1e-7):
                        return np.asarray(here)
                    last, position = state.time_s, here
                await asyncio.sleep(POLL_S)
    except TimeoutError as error:
        raise CommissioningFailed(f"the stopped arm still moves after {timeout_s:g} s") from error
