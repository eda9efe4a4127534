"""The payload from still poses with the part gripped (paper 2.4.1)."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.payload import IdentifiedPayload
from cellctl.calibration.store.kind import CalibrationKind
from cellctl.cell.arm_loads import weighed_checks
from cellctl.cell.guarded_robot import GuardedRobot
from cellctl.config.devices import LoadConfig
from cellctl.errors.force import NotSettled, SensorSilent
from cellctl.force.gravity.payload_result import PayloadResult, evaluate_payload, payload_document
from cellctl.force.gravity.pose_file import PoseRecord
from cellctl.force.gravity.poses import IdentificationPose, PoseRole, plan_identification
from cellctl.force.gravity.signs import reaction_check
from cellctl.geometry.pose import MM, Array
from cellctl.guard.report import GuardSample, GuardSamples
from cellctl.interfaces import Robot
from cellctl.runtime.procedure import ProcedureContext, ProcedureOutcome
from cellctl.workers import VisionWorkers

HOLD_OUT_POSES = 4
"""Poses that the fit does not use: the result is held against their readings."""
STEADY_N, STEADY_N_M = 4.0, 1.5
"""Scatter of single samples at standstill, raw, above which hoses or arm still swing."""
STEADY_TRIES = 5
"""Readings at one pose until one is steady."""
POLL_S = 0.02
READ_TIMEOUT_S = 2.0
"""Longest silence of the sensor beyond the end of a reading."""


@dataclass(frozen=True, slots=True)
class Stillness:
    """How long the load is left alone and read, and the scatter up to which it counts as still."""

    settle_s: float = 0.5
    average_s: float = 1.0
    steady_n: float = STEADY_N


STILLNESS = Stillness()


@dataclass(frozen=True, slots=True, eq=False)
class StillReading:
    """What the sensor reads while arm and load stand still."""

    base_R_sensor: Rotation
    wrench: Array
    """Mean of the raw samples, shape (6,), N and N·m."""
    times_s: Array
    """Of the samples, monotonic; at least one."""


class SampleSource(Protocol):
    """The part of the guard's client that this procedure reads."""

    def latest(self) -> GuardSample:
        """The newest sample."""
        ...

    def samples(self, since_s: float) -> GuardSamples:
        """All samples later than a time."""
        ...


async def identify_payload_on_cell(
    context: ProcedureContext,
    arm: GuardedRobot,
    workers: VisionWorkers,
    *,
    pose_count: int,
    cone_deg: float,
    kind: CalibrationKind[IdentifiedPayload],
    stillness: Stillness = STILLNESS,
) -> ProcedureOutcome:
    """Tilt around the present orientation, with nothing near, and identify.

    The present pose must hold the part in the orientation in which it will be mated. The arm tilts
    about its flange, so its main axes hardly move and stay off their limits. Raises
    ``NotSettled``, ``SensorSilent``, ``PosesDegenerate`` and what the robot raises.
    """
    robot = arm.robot
    poses = identification_poses(robot.state().base_T_flange, pose_count, cone_deg)
    readings: list[StillReading] = []
    for number, pose in enumerate(poses, start=1):
        await context.progress(number, len(poses), f"{pose.role.value} pose")
        await robot.move_linear(
            pose.base_T_flange,
            speed_m_s=arm.config.linear_speed_mm_s * MM,
            acceleration_m_s2=arm.config.linear_acceleration_mm_s2 * MM,
        )
        readings.append(await still_reading(robot, arm.guard, arm.flange_T_sensor, stillness))
    roles = [pose.role for pose in poses]
    await context.keep_input(_input(context, arm, readings, roles))
    result = weighed(
        PoseRecord(
            Rotation.concatenate([reading.base_R_sensor for reading in readings]),
            np.array([reading.wrench for reading in readings]),
            tuple(roles),
        ),
        arm.config.load,
        arm.flange_T_sensor,
    )
    # Loaded when it is drawn: checks of a cell file load this module for its moves.
    from cellctl.procedures.payload_picture import residual_picture

    return ProcedureOutcome(
        kind=kind,
        record=payload_document(result),
        passed=result.accepted,
        warnings=tuple(str(check) for check in result.checks if not check.passed),
        picture_png=await workers.run(residual_picture, result),
        serial_number=arm.guard.health().sensor_serial,
    )


def identification_poses(
    base_T_flange: RigidTransform, pose_count: int, cone_deg: float
) -> tuple[IdentificationPose, ...]:
    """Tilts about the flange, ``base_T_flange`` at their middle, in the order to drive them."""
    return plan_identification(
        base_T_flange,
        # With the part as the pivot the flange itself would travel, and the main axes with it,
        # towards their limits.
        pivot_in_flange_m=np.zeros(3),
        half_angle_rad=float(np.radians(cone_deg)),
        # One pose is the repeat. Six are the least that ``affine24`` can be fitted to.
        fit_poses=max(pose_count - HOLD_OUT_POSES - 1, 6),
        hold_out_poses=HOLD_OUT_POSES,
    )


def weighed(
    poses: PoseRecord, load: LoadConfig | None, flange_T_sensor: RigidTransform
) -> PayloadResult:
    """The payload with all that it is held against; ``load`` is that of the cell file.

    Raises ``TooFewPoses`` or ``PosesDegenerate``.
    """
    result = evaluate_payload(poses)
    rigid = result.identification.rigid
    result = result.also((reaction_check(rigid),))
    if load is None:
        return result
    return result.also(weighed_checks(load, rigid.mass_kg, rigid.centre_of_mass_m, flange_T_sensor))


async def still_wrench(
    robot: Robot,
    guard: SampleSource,
    flange_T_sensor: RigidTransform,
    *,
    steady_n: float = STEADY_N,
) -> tuple[Rotation, Array]:
    """base_R_sensor and mean raw wrench, shape (6,), as ``still_reading``."""
    stillness = Stillness(steady_n=steady_n)
    reading = await still_reading(robot, guard, flange_T_sensor, stillness)
    return reading.base_R_sensor, reading.wrench


async def still_reading(
    robot: Robot,
    guard: SampleSource,
    flange_T_sensor: RigidTransform,
    stillness: Stillness,
) -> StillReading:
    """The mean of raw readings once the forces scatter by little enough.

    Raises ``NotSettled`` or ``SensorSilent``.
    """
    limits = np.array([stillness.steady_n] * 3 + [STEADY_N_M] * 3)
    for _ in range(STEADY_TRIES):
        # Raw readings: a compensation that is active belongs to the old payload, and would be
        # identified again as a part of the new one.
        samples = await _samples(guard, stillness.settle_s, stillness.average_s)
        scatter = samples.raw.std(axis=0)
        if (scatter < limits).all():
            rotation = robot.state().base_T_flange.rotation * flange_T_sensor.rotation
            return StillReading(rotation, samples.raw.mean(axis=0), samples.time_s)
    shown = ", ".join(f"{value:.2f}" for value in scatter)
    raise NotSettled(f"raw readings scatter by ({shown}) N, N·m at a pose of the payload")


async def _samples(guard: SampleSource, settle_s: float, average_s: float) -> GuardSamples:
    loop = asyncio.get_running_loop()
    begin_s = loop.time() + settle_s
    end_s = begin_s + average_s
    # Waits for the sample, not for the time: samples come late when the machine is busy, and a
    # sensor that went silent must not leave an average over fewer of them.
    while guard.latest().time_s < end_s:
        if loop.time() > end_s + READ_TIMEOUT_S:
            raise SensorSilent("no samples while reading a pose of the payload")
        await asyncio.sleep(POLL_S)
    return guard.samples(begin_s)


def _input(
    context: ProcedureContext,
    arm: GuardedRobot,
    readings: Sequence[StillReading],
    roles: Sequence[PoseRole],
) -> dict[str, Any]:
    load = arm.config.load
    return {
        "sensor": arm.sensor_name,
        "flange_T_sensor": arm.flange_T_sensor.as_matrix().tolist(),
        "load": None if load is None else load.model_dump(mode="json"),
        "poses": [
            {
                "role": role.value,
                "base_R_sensor_xyzw": reading.base_R_sensor.as_quat().tolist(),
                "force_n": reading.wrench[:3].tolist(),
                "moment_n_m": reading.wrench[3:].tolist(),
                # The mean can be computed anew from the recording of the run, which has them all.
                "samples": len(reading.times_s),
                "from_s": context.record.recorded_at_s(float(reading.times_s[0])),
                "to_s": context.record.recorded_at_s(float(reading.times_s[-1])),
            }
            for role, reading in zip(roles, readings, strict=True)
        ],
    }
