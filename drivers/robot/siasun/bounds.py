"""Checks every target against the site's bounds before anything is sent."""

import math
from dataclasses import fields

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.errors.robot import TargetOutOfBounds, WayNotReached
from cellctl.geometry.arm.chain import ArmChain
from cellctl.geometry.arm.linear_way import BrokenWay, WaySteps, linear_joint_way
from cellctl.geometry.joint_path import joint_path
from cellctl.geometry.pose import MM, Array, pose_to_xyzabc
from cellctl.interfaces.robot import RobotState
from cellctl.interfaces.streaming_robot import StreamLimits, StreamOffer
from drivers.robot.siasun.codec.records import StreamFigures, StreamOption
from drivers.robot.siasun.config import MotionLimits
from drivers.robot.siasun.kinematics import arm_chain

STEP_MAX_ANGLE_DEG = 0.5
"""The controller refuses a STEP that turns further (protocol, section 4)."""
DH_FITS_MM = 5.0
DH_FITS_DEG = 0.5
"""Largest distance and angle between the flange that a controller reports and where the dh table
puts it. The table of the right arm fits much better, that of another arm does not."""
LINEAR_STEPS = WaySteps(
    way_m=0.05, turn_rad=math.radians(10.0), jump_rad=math.radians(45.0), at_most=8
)
"""Points of a straight way at which the joints are solved for. The check runs on the event loop
before every straight move, and 8 points take 2 ms of it."""


class Bounds:
    """The bounds of one robot. Methods return the target in the controller's units."""

    def __init__(self, name: str, config: MotionLimits) -> None:
        self._name = name
        self._config = config
        self._chain = arm_chain(config)

    def joints(self, joints_rad: Array, speed_ratio: float) -> tuple[Array, int]:
        """Joint angles in degrees and speed in percent."""
        joints_deg = self._joints_deg(joints_rad)
        limit = self._config.max_joint_speed_percent
        if not 0.0 < speed_ratio * 100.0 <= limit:
            self._refuse(f"joint speed {speed_ratio * 100.0:g} %, allowed (0, {limit}]")
        # MOVJ takes whole percents from 1 on (docs/protocols/sjl-1.md, section 4). Rounded down, so
        # that no move is faster than was asked for; the small term keeps 0.29 * 100 from becoming
        # 28.
        return joints_deg, max(1, math.floor(speed_ratio * 100.0 + 1e-9))

    def joint_way(self, state: RobotState, joints_rad: Array) -> None:
        """Refuse a joint move on whose way the flange leaves the box for joint moves.

        All joints move together and straight in joint space. To be asked after ``table_fits``: a
        table that does not fit would check nothing.
        """
        if self._chain is None:
            return
        for joints in joint_path(state.joints_rad, joints_rad):
            self._flange_in_box(self._chain, joints, "on the way to", joints_rad)

    def linear_way(self, state: RobotState, base_T_flange: RigidTransform) -> None:
        """Refuse a straight move, of any length, that the arm cannot follow.

        It may lead out of reach, beyond the limits of the joints, or through a singular pose. To be
        asked after ``table_fits``. Raises ``WayNotReached``.
        """
        if self._chain is None:
            return
        way = linear_joint_way(self._chain, state.joints_rad, base_T_flange, LINEAR_STEPS)
        broken = way if isinstance(way, BrokenWay) else self._beyond_limits(way)
        if broken is not None:
            target = np.round(pose_to_xyzabc(base_T_flange), 3).tolist()
            raise WayNotReached(
                f"{self._name}: to {target} mm/deg: {broken.why} {broken.share:.0%} of the way"
            )

    def _beyond_limits(self, way_rad: Array) -> BrokenWay | None:
        """The first of these joints, shape (n, 6), that is out of limits, or None.

        The first row, where the arm stands already, does not count: a move may lead out of there.
        """
        for number, joints_rad in enumerate(way_rad[1:], start=1):
            joints_deg = np.degrees(joints_rad)
            if self._beyond(joints_deg):
                lower, upper = self._config.joints_min_deg, self._config.joints_max_deg
                why = (
                    f"joints {np.round(joints_deg, 1).tolist()} deg, allowed {list(lower)} to "
                    f"{list(upper)},"
                )
                return BrokenWay(number / (len(way_rad) - 1), why)
        return None

    def table_fits(self, state: RobotState) -> None:
        """Refuse a robot that reports its flange elsewhere than the dh table puts it.

        Then the table is that of another arm, or the pose is read with other units or another order
        of angles, or it counts in another tool or user frame that was chosen at the pendant. Every
        target would be as wrong as the report.
        """
        if self._chain is None:
            return
        base_T_flange = self._chain.base_T_flange(state.joints_rad)
        distance_m, angle_rad = state.distance_to(base_T_flange)
        # Written so that a table that gives no number is refused.
        if not (distance_m / MM <= DH_FITS_MM and math.degrees(angle_rad) <= DH_FITS_DEG):
            self._refuse(
                f"the dh table puts the flange {distance_m / MM:.2f} mm and "
                f"{math.degrees(angle_rad):.3f} deg beside where the robot reports it; "
                "another tool or user frame, order of angles, or dh table"
            )

    def joint_target(self, joints_rad: Array) -> None:
        """Refuse joints, shape (6,), at which an arm that stands there would be out of bounds.

        Without a dh table only the limits of the joints themselves are known.
        """
        self._joints_deg(joints_rad)
        if self._chain is not None:
            self._flange_in_box(self._chain, joints_rad, "at", joints_rad)

    def _joints_deg(self, joints_rad: Array) -> Array:
        joints_deg: Array = np.degrees(np.asarray(joints_rad, dtype=float))
        if self._beyond(joints_deg):
            lower, upper = self._config.joints_min_deg, self._config.joints_max_deg
            self._refuse(
                f"joints {np.round(joints_deg, 3).tolist()} deg, allowed "
                f"{list(lower)} to {list(upper)}"
            )
        return np.asarray(joints_deg)

    def _beyond(self, joints_deg: Array) -> bool:
        """Whether joints are not six, not numbers, or not within their limits."""
        lower, upper = self._config.joints_min_deg, self._config.joints_max_deg
        return joints_deg.shape != (6,) or not np.all((joints_deg >= lower) & (joints_deg <= upper))

    def _flange_in_box(
        self, chain: ArmChain, joints_rad: Array, where: str, target_rad: Array
    ) -> None:
        lower, upper = self._config.joint_workspace_mm
        place_mm = chain.base_T_flange(joints_rad).translation / MM
        if not np.all((place_mm >= lower) & (place_mm <= upper)):
            self._refuse(
                f"{where} joints {np.round(np.degrees(target_rad), 3).tolist()} deg the flange "
                f"comes to {np.round(place_mm, 1).tolist()} mm, allowed {list(lower)} to "
                f"{list(upper)}"
            )

    def pose(self, base_T_flange: RigidTransform) -> None:
        """Refuse a pose that is none, or outside of the workspace."""
        xyzabc = pose_to_xyzabc(base_T_flange)
        lower, upper = self._config.workspace_min_mm, self._config.workspace_max_mm
        inside = bool(np.all((xyzabc[:3] >= lower) & (xyzabc[:3] <= upper)))
        if not (inside and np.isfinite(xyzabc).all()):
            self._refuse(f"flange at {np.round(xyzabc, 3).tolist()} mm/deg leaves the workspace")

    def speed_mm_s(self, speed_m_s: float) -> float:
        """Path speed in mm/s."""
        return self._limited("speed", speed_m_s / MM, self._config.max_speed_mm_s, "mm/s")

    def acceleration_mm_s2(self, acceleration_m_s2: float, *, least_m_s2: float = 0.0) -> float:
        """Path acceleration in mm/s²; ``least_m_s2`` is the smallest of the job program."""
        limit = self._config.max_acceleration_mm_s2
        # The job would move with more than it is told. The small term allows for rounding.
        if acceleration_m_s2 < least_m_s2 * (1.0 - 1e-9):
            self._refuse(
                f"acceleration {acceleration_m_s2 / MM:g} mm/s2; the job program knows none below "
                f"{least_m_s2 / MM:g} (1 % of the ACC in its hello)"
            )
        return self._limited("acceleration", acceleration_m_s2 / MM, limit, "mm/s2")

    def step(self, state: RobotState, base_T_flange: RigidTransform, step_max_mm: float) -> None:
        """A step's length and angle from where the robot is; ``step_max_mm`` is the job's."""
        distance_m, angle_rad = state.distance_to(base_T_flange)
        # The lower of both: the site may allow less than the job program, and the job program
        # rejects what is more than its own.
        limit_mm = min(self._config.max_step_mm, step_max_mm)
        if not distance_m / MM <= limit_mm:
            self._refuse(f"step of {distance_m / MM:.4f} mm, allowed {limit_mm:g}")
        if not math.degrees(angle_rad) <= STEP_MAX_ANGLE_DEG:
            self._refuse(f"step turns {math.degrees(angle_rad):.3f} deg")

    def stream_offer(self, option: StreamOption) -> StreamOffer:
        """What both the job program and the configuration allow."""
        config, offered = self._config, option.figures
        limits = StreamLimits(
            step_m=min(config.max_stream_step_mm, offered.step_mm) * MM,
            step_rad=math.radians(min(config.max_stream_step_deg, offered.step_deg)),
            travel_m=min(config.max_stream_travel_mm, offered.travel_mm) * MM,
            travel_rad=math.radians(min(config.max_stream_travel_deg, offered.travel_deg)),
            loss_s=min(config.max_stream_loss_s, offered.loss_ms / 1000.0),
        )
        return StreamOffer(option.period_ms / 1000.0, limits)

    def stream(self, limits: StreamLimits, offer: StreamOffer) -> StreamFigures:
        """The limits of a stream in the controller's units; none may exceed what is offered."""
        for field in fields(StreamLimits):
            asked, allowed = getattr(limits, field.name), getattr(offer.limits, field.name)
            # A process that asks for exactly what is offered must not fail for its last bit.
            if not 0.0 < asked <= allowed * (1.0 + 1e-9):
                self._refuse(f"stream with {field.name} {asked:g}, allowed (0, {allowed:g}]")
        self._limited(
            "stream speed",
            limits.step_m / MM / offer.period_s,
            self._config.max_speed_mm_s,
            "mm/s",
        )
        return StreamFigures(
            limits.step_m / MM,
            math.degrees(limits.step_rad),
            limits.travel_m / MM,
            math.degrees(limits.travel_rad),
            round(limits.loss_s * 1000.0),
        )

    def set_point(
        self,
        base_T_flange: RigidTransform,
        last: RigidTransform,
        start: RigidTransform,
        limits: StreamLimits,
    ) -> None:
        """Refuse a streamed setpoint out of the workspace, or too far from the last one or from the
        start of the stream."""
        self._near("step", base_T_flange, last, (limits.step_m, limits.step_rad))
        self._near("travel", base_T_flange, start, (limits.travel_m, limits.travel_rad))
        self.pose(base_T_flange)

    def _near(
        self, what: str, pose: RigidTransform, other: RigidTransform, allowed: tuple[float, float]
    ) -> None:
        # Plain arrays instead of composed transforms, which would take half a millisecond a tick.
        difference = pose.as_matrix() - other.as_matrix()
        distance_m = float(np.linalg.norm(difference[:3, 3]))
        # Two rotations that differ by an angle have matrices that differ by sqrt(8) sin(angle / 2).
        chord = float(np.linalg.norm(difference[:3, :3])) / math.sqrt(8.0)
        angle_rad = 2.0 * math.asin(min(chord, 1.0)) if math.isfinite(chord) else math.nan
        # The tolerance is that of the arithmetic. Not a number fails the comparison, as it must.
        if not (distance_m <= allowed[0] + 1e-9 and angle_rad <= allowed[1] + 1e-9):
            self._refuse(
                f"streamed {what} of {distance_m / MM:.4f} mm and {math.degrees(angle_rad):.4f} deg"
            )

    def _limited(self, what: str, value: float, limit: float, unit: str) -> float:
        # 1e-4 is the last decimal of a speed in a record (docs/protocols/sjl-1.md, section 2): less
        # could be sent as zero.
        if not 1e-4 <= value <= limit:
            self._refuse(f"{what} {value:g} {unit}, allowed (0, {limit:g}]")
        return value

    def _refuse(self, facts: str) -> None:
        raise TargetOutOfBounds(f"{self._name}: {facts}")
