"""The simulated cell: arms, cameras, trackers and force sensors, advanced in time by its caller.

No I/O and no clock: every method takes or has been given the time, in seconds since switch-on, and
times never run backwards. Poses are true; ``cell`` is the frame in which the scenario places the
bases of its robots.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from typing import Any, ClassVar, Generic, TypeVar

from scipy.spatial.transform import RigidTransform

from fakes.faults import FaultBoard
from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import RingLamp
from fakes.world.flaws.arm import ArmFlaws
from fakes.world.flaws.camera import CameraFlaws
from fakes.world.flaws.sensor import SensorFlaws
from fakes.world.frames import Array, stream, stream_seed
from fakes.world.gripper import PneumaticJaws
from fakes.world.load.mounted_sensor import STEP_S, MountedSensor
from fakes.world.load.sensor import ForceReading
from fakes.world.robot import RobotArm
from fakes.world.scene import CameraScene, Seen
from fakes.world.targets import SeenTarget, Target, flange_targets, seen_targets
from fakes.world.truth import draw, stream_keys

S_co = TypeVar("S_co", bound=Scenario, covariant=True)

Command = Callable[..., Mapping[str, Any] | None]
"""Something that the hands of an operator do; returns what the control port answers."""


class World(ABC, Generic[S_co]):
    """The devices of one cell by the scenario's hardware seed, all else by ``seed``.

    A scene is a class derived from this one: it adds the bodies.
    """

    scenario_model: ClassVar[type[Scenario]]
    """Sections of the scenario file of this scene."""
    fault_texts: ClassVar[Mapping[str, str]] = {}
    """Faults of the bodies by name, with their meaning."""

    def __init__(self, scenario: S_co, seed: int) -> None:
        self.scenario, self.seed = scenario, seed
        self.truth = draw(scenario, scenario.hardware_seed)
        self.arms = {
            name: RobotArm(robot, self.truth.robots[name], seed, ArmFlaws.of(scenario, name, seed))
            for name, robot in scenario.robots.items()
        }
        self._camera_flaws = {
            name: CameraFlaws.of(scenario, name, seed) for name in scenario.all_cameras()
        }
        self.jaws = {
            name: PneumaticJaws(
                travel_s=gripper.travel_ms / 1000, part_present=gripper.part_present
            )
            for name, gripper in scenario.grippers.items()
        }
        self.faults = FaultBoard("world", self.fault_texts)
        self.time_s = 0.0
        self._tick = 0
        self._exposures = 0
        self.sensors = {
            name: MountedSensor(
                name,
                self.arms[sensor.mounted_on],
                ForceReading(
                    sensor,
                    self.truth.force_sensors[name],
                    seed,
                    stream_keys(scenario.force_sensors, name),
                ),
                SensorFlaws.of(scenario, name),
            )
            for name, sensor in scenario.force_sensors.items()
        }

    # -- what a scene says ----------------------------------------------------------------------
    @abstractmethod
    def load_on(self, sensor: str, flange: Array, *, moving: bool) -> Array:
        """Let one millisecond pass for what hangs behind a force sensor; returns its true load.

        Called once for each sensor in every step. ``flange`` is the true cell_T_flange at the end
        of that millisecond, 4x4: the very same array as before while the robot stands. The load is
        Fx, Fy, Fz (N), Mx, My, Mz (N·m) in the axes of the sensor as it is mounted.
        """

    @abstractmethod
    def bodies_before(self, camera_T_cell: RigidTransform) -> Iterable[Seen]:
        """Whatever a camera at this pose can see."""

    def targets_for(self, tracker: str) -> Iterable[Target]:  # noqa: ARG002  for scenes that care
        """Targets that a tracker may find, beside those on the flanges."""
        return ()

    @abstractmethod
    def truth_report(self) -> dict[str, Any]:
        """True poses and forces at this moment in mm, degrees and N, as JSON values."""

    def commands(self) -> Mapping[str, Command]:
        """What the control port can ask for in this scene, by name."""
        return {}

    def faults_changed(self) -> None:
        """Take over a change of the injected faults of the bodies."""

    # -- time -----------------------------------------------------------------------------------
    def advance(self, to_s: float) -> None:
        """Let the time pass up to ``to_s``, in steps of one millisecond."""
        last = int(to_s / STEP_S)
        while self._tick < last:
            self._tick += 1
            self.time_s = self._tick * STEP_S
            for sensor in self.sensors.values():
                # Arm before load: what hangs on the flange moves with the end of this millisecond.
                moving = sensor.follow(self.time_s)
                load = self.load_on(sensor.name, sensor.flange, moving=moving)
                sensor.keep(self._tick, load)

    def sensor_wrench(self, sensor: str, time_s: float) -> Array:
        """Raw reading at a time of the last second: Fx, Fy, Fz, Mx, My, Mz in N and N·m."""
        self.advance(time_s)
        return self.sensors[sensor].read(time_s, self._tick)

    # -- views ----------------------------------------------------------------------------------
    def flange(self, robot: str) -> RigidTransform:
        """True cell_T_flange of an arm now."""
        return self.arms[robot].flange(self.time_s)

    def camera_pose(self, camera: str) -> RigidTransform:
        """True cell_T_camera; of a stereo head the pose of its left camera."""
        mount_T_camera = self.truth.cameras[camera].mount_T_camera
        drift = self._camera_flaws[camera].drift
        if drift is not None:
            # The drift stands on the camera's side: it moves on its mount, and the mount stays.
            mount_T_camera *= RigidTransform.from_matrix(drift.at(self.time_s))
        carrier = self.scenario.all_cameras()[camera].carried_by
        return mount_T_camera if carrier is None else self.flange(carrier) * mount_T_camera

    def camera_scene(self, camera: str) -> CameraScene:
        """What a camera or stereo head sees now; every call is another exposure."""
        self._exposures += 1
        truth, single = self.truth.cameras[camera], self.scenario.cameras.get(camera)
        return CameraScene(
            camera=camera,
            time_s=self.time_s,
            optics=truth.optics,
            bodies=tuple(self.bodies_before(self.camera_pose(camera).inv())),
            light_seed=truth.light_seed,
            noise_seed=stream_seed(self.seed, "exposure", camera, self._exposures),
            exposure=self._camera_flaws[camera].exposure(self._exposures, self.time_s),
            lamp=RingLamp() if single is None else single.lamp,
        )

    def targets(self, tracker: str, frames: int) -> tuple[SeenTarget, ...]:
        """Targets that a tracker sees now, averaged over a number of exposures."""
        self._exposures += 1
        settings, truth = self.scenario.trackers[tracker], self.truth.trackers[tracker]
        carried = flange_targets(self.flange(settings.targets_on), truth.flange_targets_m)
        candidates = (*carried, *self.targets_for(tracker))
        rng = stream(self.seed, "targets", self._exposures)
        return seen_targets(settings, truth.cell_T_tracker, candidates, frames, rng)

    def report(self) -> dict[str, Any]:
        """The truth in mm, degrees and N, as JSON values."""
        return {
            "seed": self.seed,
            "hardware_seed": self.truth.seed,
            "time_s": self.time_s,
            **self.truth_report(),
        }
