"""One cell for one trial: world, controller and guard on one simulated clock."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.force.gravity.payload import fit_affine24
from cellctl.force.gravity.poses import plan_identification
from cellctl.geometry.pose import Array, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from fakes.faults import ROBOT_FAULTS, FaultBoard
from fakes.scenes.deck_on_frame.scenario import DeckScenario, Pins
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.wire.sjl.logic import Controller
from fakes.world.arm import inverse
from fakes.world.frames import from_written
from tests.rigs.mating.guard import WorldGuard
from tests.rigs.mating.robot import SESSION, WorldRobot

SCENARIO = Path(__file__).parents[3] / "config" / "deck.scenario.toml"
TICK_S = 1e-3
THRESHOLD = np.repeat([5e-5, np.deg2rad(0.005)], 3)
"""What the measure-compensate loop may leave, each axis; the draw is uniform within."""
VISION_SIGMA = np.repeat([5e-6, np.deg2rad(0.0005)], 3)
"""How well it knows what it left."""


@dataclass(slots=True)
class SensorFault:
    """What is wrong from a moment on: silent, slow, frozen, saturated or damaged."""

    kind: str = ""
    from_s: float = np.inf
    held: Array = field(default_factory=lambda: np.zeros(6))

    def spoil(self, time_s: float, raw: Array) -> Array | None:
        """The sample as it arrives."""
        if time_s < self.from_s or self.kind == "saturated":
            self.held = raw
            return raw
        if self.kind == "silent" or (self.kind == "slow" and round(time_s / TICK_S) % 2):
            return None
        if self.kind == "slow":
            return raw
        return self.held if self.kind == "frozen" else np.full(6, np.nan)

    def saturated(self, time_s: float) -> bool:
        """A channel is at the end of its range."""
        return self.kind == "saturated" and time_s >= self.from_s


class MatingCell:
    """A world whose deck is at its stand-off, with what was measured of it."""

    def __init__(
        self,
        world: DeckOnFrame,
        rng: np.random.Generator,
        *,
        M_T_D: UncertainPose,
        flange_T_deck: RigidTransform,
    ) -> None:
        self.world, self.rng = world, rng
        self.M_T_D, self.flange_T_deck = M_T_D, flange_T_deck
        self.faults = FaultBoard("main", ROBOT_FAULTS)
        self.arm = world.arms["main"]
        self.start_s = world.time_s
        self.controller = Controller(self.arm, self.faults)
        self.robot = WorldRobot(self.controller, self.start_s)
        self.sensor_fault = SensorFault()
        sensor = world.scenario.force_sensors["force"]
        self.flange_T_sensor = from_written(sensor.flange_T_sensor_mm_deg)
        self.guard = WorldGuard(self._identify(), self.flange_T_sensor, self._guard_stop)
        self._stops = 0
        self._ticks = round(self.start_s / TICK_S)
        self.robot.tick(self.start_s, guard_beats=True)
        raw = world.sensor_wrench("force", self.start_s)
        self.guard.tick(self.start_s, raw, self.robot.reported)

    @classmethod
    def drawn(
        cls,
        seed: int,
        *,
        stiffness_n_m: float,
        stop_latency_s: float,
        pins: Pins | None = None,
        left: Array | None = None,
        imperfections: Mapping[str, float] | None = None,
    ) -> Self:
        """Drawn from a seed, the deck within the loop's thresholds and measured as well as vision
        measures it.

        ``left``: what the loop before leaves (m, rad), shape (6,); drawn when None.
        ``imperfections``: scales in place of those of the scenario file.
        """
        rng = np.random.default_rng([seed, 77])
        scenario = _scenario(stiffness_n_m, stop_latency_s, pins, imperfections)
        world = DeckOnFrame(scenario, seed)
        _approach_stand_off(world, rng.uniform(-THRESHOLD, THRESHOLD) if left is None else left)
        return cls(
            world, rng, M_T_D=_measured(world, rng), flange_T_deck=_calibrated_deck(world, rng)
        )

    # -- time -----------------------------------------------------------------------------------
    def advance(self, to_s: float) -> None:
        """Everything up to a time of the loop, millisecond by millisecond."""
        while (self._ticks + 1) * TICK_S <= to_s:
            self._ticks += 1
            time_s = self._ticks * TICK_S
            raw = self.sensor_fault.spoil(time_s, self.world.sensor_wrench("force", time_s))
            saturated = self.sensor_fault.saturated(time_s)
            self.guard.tick(time_s, raw, self.robot.reported, saturated=saturated)
            beats = self.guard.beats(time_s, latched=self.controller.latched)
            self.robot.tick(time_s, guard_beats=beats)

    def _guard_stop(self, time_s: float) -> None:
        self._stops += 1
        self.controller.supervise("GRD", ["ABORT", str(SESSION), str(self._stops)], time_s)

    # -- truth and calibration --------------------------------------------------------------------
    def true_pose(self) -> RigidTransform:
        """Truth: M_T_D."""
        return true_M_T_D(self.world)

    def _identify(self) -> GravityCompensation:
        """The compensation as the payload procedure finds it: 17 poses, real sensor."""
        scenario, sensor = self.world.scenario, self.world.truth.force_sensors["force"]
        payload = scenario.payload
        weight = (payload.gripper_kg + payload.deck_kg) * np.array([0.0, 0.0, -9.80665])
        centre = self.flange_T_sensor.apply(np.array(payload.com_in_sensor_mm) * 1e-3)
        arm_m = sensor.flange_T_sensor.inv().apply(centre)
        here = self.arm.encoder_pose(self.world.time_s)
        rotations, wrenches = [], []
        for pose in plan_identification(here, pivot_in_flange_m=np.zeros(3)):
            flange = pose.base_T_flange.rotation
            wobble = Rotation.from_rotvec(self.rng.normal(0.0, np.deg2rad(0.005), 3))
            force = (wobble * flange * sensor.flange_T_sensor.rotation).inv().apply(weight)
            load = np.concatenate([force, np.cross(arm_m, force)])
            noise = self.rng.normal(0.0, 1.0, 6) * np.repeat([0.15, 0.03], 3)
            rotations.append(flange * self.flange_T_sensor.rotation)
            wrenches.append(sensor.matrix @ load + sensor.offset + noise)
        return fit_affine24(Rotation.concatenate(rotations), np.array(wrenches)).compensation


def true_M_T_D(world: DeckOnFrame) -> RigidTransform:
    """The deck in the frame."""
    parts, deck = world.placed.parts, world.cell_T_deck()
    assert parts is not None
    assert deck is not None
    return parts.cell_T_frame.inv() * deck


def _measured(world: DeckOnFrame, rng: np.random.Generator) -> UncertainPose:
    """M_T_D as vision measures it at the end of its loop."""
    error = _displacement(rng.normal(0.0, VISION_SIGMA))
    return UncertainPose(true_M_T_D(world) * error, np.diag(VISION_SIGMA**2))


def _calibrated_deck(world: DeckOnFrame, rng: np.random.Generator) -> RigidTransform:
    """The deck on the flange as its calibration gives it: from encoders and truth together."""
    deck = world.cell_T_deck()
    assert deck is not None
    encoder = world.arms["main"].encoder_pose(world.time_s)
    error = _displacement(rng.normal(0.0, np.repeat([2e-5, np.deg2rad(0.003)], 3)))
    return encoder.inv() * deck * error


def _approach_stand_off(world: DeckOnFrame, left: Array) -> None:
    """What measuring and compensating does before, with truth for measurements."""
    arm, scenario = world.arms["main"], world.scenario
    above = from_written(scenario.taught["main"]["deck_measure"])
    joints = inverse(
        scenario.robots["main"].chain_mm, above, np.deg2rad(scenario.robots["main"].home_deg)
    )
    arm.start_joint(world.time_s, joints, 100)
    world.advance(arm.standstill_s + 0.05)
    parts = world.placed.parts
    assert parts is not None
    wanted = parts.cell_T_frame * pose_from_xyzabc([0, 0, 25, 0, 0, 0]) * _displacement(left)
    for _ in range(4):
        deck = world.cell_T_deck()
        assert deck is not None
        correction = wanted * deck.inv()
        arm.start_linear(world.time_s, correction * arm.encoder_pose(world.time_s), 0.25, 1.0)
        world.advance(arm.standstill_s + 0.05)
    world.advance(world.time_s + 1.0)


def _displacement(vector: Array) -> RigidTransform:
    return RigidTransform.from_components(vector[:3], Rotation.from_rotvec(vector[3:]))


def _scenario(
    stiffness_n_m: float,
    stop_latency_s: float,
    pins: Pins | None,
    imperfections: Mapping[str, float] | None,
) -> DeckScenario:
    scenario = DeckScenario.read(SCENARIO, imperfections)
    changes = {"stiffness_n_m": (stiffness_n_m,) * 2, "pins": pins}
    contact = scenario.contact.model_copy(update=changes)
    main = scenario.robots["main"].model_copy(update={"stop_latency_ms": stop_latency_s * 1e3})
    robots = {**scenario.robots, "main": main}
    return scenario.model_copy(update={"contact": contact, "robots": robots})
