"""An arm in motion: what its encoders say and where its flange truly is."""

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenario_file.sections import Robot
from fakes.world.arm import (
    OutOfReachError,
    forward,
    forward_matrix,
    inverse,
    nominal_links,
    singular,
)
from fakes.world.flaws.arm import ArmFlaws
from fakes.world.frames import MM, Array, distance, matrix_distance, stream
from fakes.world.motion import JointPath, LinearPath, Path, Profile, StreamSegment, way_m
from fakes.world.truth import RobotTruth
from fakes.world.wander import Wander, small_displacement

STEP_ANGLE_MAX_RAD = np.deg2rad(0.5)
"""docs/protocols/sjl-1.md, section 4: ``STEP`` is refused beyond this angle."""
_STILL_M = 1e-9
"""A setpoint that is no farther away is the present pose; the metres of a step divide by it."""
_JUMP_RAD = np.deg2rad(45.0)
"""A joint that turns farther than this between two knots of a linear path passes a singularity."""
_JOG_ROUNDS = 3
"""An arm is wrong by nearly the same a millimetre away: each round leaves a thousandth."""
_JOG_ACCELERATION_M_S2 = 0.1


class RefusedMotionError(Exception):
    """The controller refuses a motion; ``reason`` is its word on the wire."""

    def __init__(self, reason: str) -> None:
        super().__init__(reason)
        self.reason = reason


class RobotArm:
    """Kinematics and motion of one arm. Every method takes the time, which never runs backwards."""

    def __init__(
        self, settings: Robot, truth: RobotTruth, seed: int, flaws: ArmFlaws | None = None
    ) -> None:
        """``flaws`` is None for an arm that has only those of its links and its repeatability."""
        self.settings = settings
        self.truth = truth
        self._nominal = nominal_links(settings.chain_mm)
        self._limits = np.deg2rad(np.array(settings.limits_deg))
        self._rated = np.deg2rad(np.array(settings.rated_deg_s))
        # A data sheet's repeatability is taken as three standard deviations of a coordinate.
        sigma = np.repeat(
            [settings.repeatability_mm * MM / 3, np.deg2rad(settings.repeatability_deg) / 3], 3
        )
        rng = stream(seed, "repeatability", settings.name)
        self._wander = Wander(rng, sigma, settings.correlation_mm * MM)
        self._settling_rng = stream(seed, "settling", settings.name)
        self._settling = np.repeat(
            [settings.settling_mm * MM, np.deg2rad(settings.settling_deg)], 3
        )
        self._rest_error = self._next_error = np.zeros(6)
        home = np.deg2rad(np.array(settings.home_deg))
        self._path: Path = JointPath(home, home, self._rated)
        self._profile = Profile(0.0, 0.0, 1.0, 1.0)
        self._travelled_m = 0.0
        self.override_percent = 100
        self._zero_error_rad = np.zeros(6)
        self.by_hand = False
        """The key at the panel stands on manual, because somebody jogs the arm."""
        self._flaws = flaws or ArmFlaws()
        self._cell_T_base = self._base_at(0.0)

    # -- commands -----------------------------------------------------------------------------
    def start_joint(self, time_s: float, target_rad: Array, percent: float) -> None:
        """Begin a joint motion; raises ``RefusedMotionError``."""
        if not 1 <= percent <= 100:
            raise RefusedMotionError("SPEED")
        self._check_limits(target_rad[np.newaxis])
        path = JointPath(self.joints(time_s), target_rad, self._rated)
        self._begin(time_s, path, percent / 100, 1 / self.settings.ramp_s)

    def start_linear(
        self, time_s: float, target: RigidTransform, speed_m_s: float, acceleration_m_s2: float
    ) -> None:
        """Begin a linear motion; raises ``RefusedMotionError``."""
        allowed = 0 < speed_m_s <= self.settings.speed_max_mm_s * MM and acceleration_m_s2 > 0
        if not allowed:
            raise RefusedMotionError("SPEED")
        near = self.joints(time_s)
        try:
            path = LinearPath(self.settings.chain_mm, self.encoder_pose(time_s), target, near)
        except OutOfReachError as error:
            raise RefusedMotionError("REACH") from error
        # Looked at over the whole path before it begins, so that such a motion is refused and not
        # broken off in its middle.
        jumps = np.abs(np.diff(path.knots, axis=0)).max() > _JUMP_RAD
        if jumps or any(singular(knot) for knot in path.knots):
            raise RefusedMotionError("SINGULAR")
        self._check_limits(path.knots)
        self._begin(time_s, path, speed_m_s, acceleration_m_s2)

    def start_jog(self, time_s: float, cell_T_flange: RigidTransform, speed_m_s: float) -> None:
        """Begin a linear motion of somebody at the panel who feels where the flange truly is.

        It ends there whatever the arm is wrong by, except a wander over its travel: the encoders
        show by what. Raises ``RefusedMotionError``.
        """
        near = self.joints(time_s)
        error = self._settling_rng.normal(0, self._settling)
        settled = small_displacement(error)
        cell_T_base = RigidTransform.from_matrix(self._cell_T_base)
        wanted = commanded = cell_T_base.inv() * cell_T_flange
        for _ in range(_JOG_ROUNDS):
            try:
                joints = inverse(self.settings.chain_mm, commanded, near)
            except OutOfReachError as beyond:
                raise RefusedMotionError("REACH") from beyond
            reached = RigidTransform.from_matrix(self._base_T_flange(joints) @ settled)
            commanded = wanted * reached.inv() * commanded
        self.start_linear(time_s, commanded, speed_m_s, _JOG_ACCELERATION_M_S2)
        self._next_error = error

    def check_step(self, time_s: float, target: RigidTransform) -> None:
        """Refuse a step that is longer than this controller allows."""
        distance_m, angle_rad = distance(self.encoder_pose(time_s), target)
        limit_m = self.settings.step_max_mm * MM
        if distance_m > limit_m + 1e-9 or angle_rad > STEP_ANGLE_MAX_RAD:
            raise RefusedMotionError("STEP")

    def follow(self, time_s: float, target: Array, period_s: float) -> None:
        """Go to a streamed setpoint, base_T_flange as a 4x4 matrix, within one period and without
        ramps; raises ``RefusedMotionError``."""
        length_m = way_m(*matrix_distance(self.encoder_matrix(time_s), target))
        # Standing still in a stream is the same setpoint again.
        if length_m < _STILL_M:
            return
        near = self.joints(time_s)
        try:
            joints = inverse(self.settings.chain_mm, RigidTransform.from_matrix(target), near)
        except OutOfReachError as error:
            raise RefusedMotionError("REACH") from error
        if singular(joints) or np.abs(joints - near).max() > _JUMP_RAD:
            raise RefusedMotionError("SINGULAR")
        self._check_limits(joints[np.newaxis])
        self._continue(time_s, StreamSegment(near, joints, length_m), length_m / period_s)

    def stop(self, time_s: float, *, latency_s: float | None = None) -> None:
        """Brake on the path after the controller's latency; the motion goes on until then."""
        timing = self._flaws.timing
        if latency_s is None:
            latency_s = self.settings.stop_latency_ms / 1000
            latency_s *= timing.stop_latency_factor if timing else 1.0
        braking = 1 / self.settings.ramp_s
        # Along a path in joints the ramp is one of joint speed, along a line one of the flange.
        if isinstance(self._path, LinearPath | StreamSegment):
            braking = self.settings.stop_deceleration_mm_s2 * MM
        braking *= timing.braking_factor if timing else 1.0
        stopping = np.isfinite(self._profile.stop_s)
        if isinstance(self._path, StreamSegment) and self.moving(time_s) and not stopping:
            self._run_on(time_s, self._path, latency_s, braking)
        self._profile = self._profile.stopped_from(time_s + latency_s, braking)

    def master(self, joint: int, beside_rad: float) -> None:
        """Somebody masters a joint, 1 to 6, anew and so much beside where it was: the controller
        counts as before, and the arm stands elsewhere."""
        self._zero_error_rad[joint - 1] = beside_rad

    # -- state --------------------------------------------------------------------------------
    def moving(self, time_s: float) -> bool:
        """True until standstill."""
        return time_s < self._profile.end_s

    @property
    def standstill_s(self) -> float:
        """When the present motion ends or ended."""
        return self._profile.end_s

    @property
    def cut_short(self) -> bool:
        """True when the last motion was braked before its target."""
        return self._profile.cut_short

    def joints(self, time_s: float) -> Array:
        """Joint angles of the encoders, shape (6,)."""
        return self._path.joints(self._profile.at(time_s))

    def encoder_pose(self, time_s: float) -> RigidTransform:
        """base_T_flange as the controller believes it."""
        return forward(self._nominal, self.joints(time_s))

    def encoder_matrix(self, time_s: float) -> Array:
        """The same as a 4x4 matrix."""
        return forward_matrix(self._nominal, self.joints(time_s))

    def flange_matrix(self, time_s: float) -> Array:
        """True cell_T_flange as a 4x4 matrix."""
        along = self._profile.at(time_s)
        joints = self._path.joints(along)
        base_T_flange = self._base_T_flange(joints)
        error = self._wander.error(self._travel(along)) + self._settled(along)
        return self._cell_T_base @ base_T_flange @ small_displacement(error)

    def flange(self, time_s: float) -> RigidTransform:
        """True cell_T_flange."""
        return RigidTransform.from_matrix(self.flange_matrix(time_s))

    def _begin(self, time_s: float, path: Path, speed: float, acceleration: float) -> None:
        if self.override_percent <= 0:
            raise RefusedMotionError("SPEED")
        along = self._profile.at(time_s)
        self._travelled_m, self._rest_error = self._travel(along), self._settled(along)
        self._next_error = self._settling_rng.normal(0, self._settling)
        start_s = time_s + self.settings.start_latency_ms / 1000
        if self._flaws.timing is not None:
            start_s += self._flaws.timing.begin_motion()
        # The base drifts only when a motion begins, because one that moves all the time would never
        # let an arm stand, and a standing one costs nothing.
        self._cell_T_base = self._base_at(time_s)
        speed *= self.override_percent / 100
        self._path, self._profile = path, Profile(start_s, path.length, speed, acceleration)

    def _continue(self, time_s: float, path: Path, speed_m_s: float) -> None:
        """Go on without a ramp. The error of the last motion's end stays: a stream is one motion,
        and must not draw a new one in every tick."""
        along = self._profile.at(time_s)
        self._travelled_m, self._rest_error = self._travel(along), self._settled(along)
        self._next_error = self._rest_error
        self._path = path
        self._profile = Profile(time_s, path.length, speed_m_s, np.inf)

    def _run_on(
        self, time_s: float, segment: StreamSegment, latency_s: float, braking: float
    ) -> None:
        """Keep the speed of a streamed step long enough for a stop that has its own latency: the
        controller's dead time is the same whoever says where to go."""
        speed = self._profile.speed
        length_m = speed * latency_s + speed**2 / braking + segment.length
        further = segment.lengthened(self._profile.at(time_s), length_m)
        self._continue(time_s, further, speed)

    def _base_T_flange(self, joints: Array) -> Array:
        """The pose that the links as they were built give, without the error of a single motion."""
        joints = joints + self._zero_error_rad
        if self._flaws.transmission is not None:
            joints = joints + self._flaws.transmission.error(joints)
        return forward_matrix(self.truth.links, joints)

    def _base_at(self, time_s: float) -> Array:
        base = self.truth.cell_T_base.as_matrix()
        drift = self._flaws.base_drift
        return base if drift is None else base @ drift.at(time_s)

    def _travel(self, along: float) -> float:
        if self._path.length == 0:
            return self._travelled_m
        return self._travelled_m + self._path.travel_m * along / self._path.length

    def _settled(self, along: float) -> Array:
        """Error of the single motion, taken on in proportion to the way."""
        ratio = along / self._path.length if self._path.length > 0 else 0.0
        return self._rest_error + ratio * (self._next_error - self._rest_error)

    def _check_limits(self, joints_rad: Array) -> None:
        inside = (joints_rad >= self._limits[:, 0]) & (joints_rad <= self._limits[:, 1])
        if not inside.all():
            raise RefusedMotionError("LIMIT")
