"""An antenna module is taken from its tray, looked at from below, and plugged."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenario import Scenario
from fakes.scenes.antenna_bench.gripping import ModulePlace
from fakes.scenes.antenna_bench.mating import EVERY_MS, PlugAtSocket, mount_of
from fakes.scenes.antenna_bench.parts import FAULTS, draw_parts, module_top, offsets_m, placed
from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.world.connector.insertion import PinState
from fakes.world.connector.made import gripper_marks
from fakes.world.flaws.warmth import warmed
from fakes.world.frames import MM, Array, from_written, stream, to_written
from fakes.world.payload import Payload
from fakes.world.scene import Seen
from fakes.world.truth import drawn_spread
from fakes.world.views import in_view
from fakes.world.world import Command, World

_GRAVITY = np.array([0.0, 0.0, -9.80665])
_KEPT_M = 1.5e-3
"""Depth from which the socket keeps a plug that is let go."""
_MARKS_FACE_M = (60e-3, 22e-3)


class AntennaBench(World[BenchScenario]):
    """Forces at the socket are quasi-static; inertia is that of the gripper alone."""

    scenario_model: ClassVar[type[Scenario]] = BenchScenario
    fault_texts: ClassVar[Mapping[str, str]] = FAULTS

    def __init__(self, scenario: BenchScenario, seed: int) -> None:
        super().__init__(scenario, seed)
        gripper = scenario.gripper
        self._flange_T_sensor = self.truth.force_sensors[gripper.force_sensor].flange_T_sensor
        nominal = from_written(scenario.force_sensors[gripper.force_sensor].flange_T_sensor_mm_deg)
        self._tool = Payload(
            scenario.module,
            self._flange_T_sensor,
            mass_kg=gripper.mass_kg,
            com_in_flange_m=nominal.apply(np.array(gripper.com_in_sensor_mm) * MM),
        )
        spread = drawn_spread(stream(scenario.hardware_seed, "marks"), gripper.marks_spread)
        self.flange_T_marks = from_written(gripper.flange_T_marks_mm_deg) * spread
        self._loads = self._warmings = self._ticks = 0
        self._contact_n = np.zeros(6)
        self._jaws_seen = -1.0
        self.load()

    def load(self) -> dict[str, Any]:
        """Lay the next module on the tray and bring the next panel."""
        self._loads += 1
        self.parts = draw_parts(self.scenario, self.seed, self._loads, self.faults)
        gripper = self.scenario.gripper
        self.module = ModulePlace(
            gripper, self.seed + self._loads, "tray", self.parts.cell_T_tray_plug,
            from_written(gripper.flange_T_plug_mm_deg),
        )  # fmt: skip
        mount = mount_of(gripper.lateral_n_mm, gripper.axial_n_mm)
        self.mating = PlugAtSocket(self.parts.pair, mount)
        return {"load": self._loads}

    def warm(self, kelvin: float) -> dict[str, Any]:
        """The arm's links take temperatures that differ by so much, from the next motion on."""
        self._warmings += 1
        arm = self.arms[self.scenario.gripper.carried_by]
        rng = stream(self.seed, "warmth", self._warmings)
        built = self.truth.robots[self.scenario.gripper.carried_by].links
        arm.truth = replace(arm.truth, links=warmed(built, rng, kelvin))
        return {"warmings": self._warmings}

    def commands(self) -> Mapping[str, Command]:
        """The hands of the operator on the control port."""
        return {"load": self.load, "warm": self.warm}

    # -- forces ---------------------------------------------------------------------------------
    def load_on(self, sensor: str, flange: Array, *, moving: bool) -> Array:
        """Gripper with its inertia; weight of the module; what the socket does to it."""
        if sensor != self.scenario.gripper.force_sensor:
            return np.zeros(6)
        self._tool.advance(flange, moving=moving)
        self._ticks += 1
        if self._ticks % EVERY_MS == 0 and (moving or self._something_changes()):
            self._contact_n = self._module_load(RigidTransform.from_matrix(flange))
        return np.asarray(self._tool.load + self._contact_n)

    def _something_changes(self) -> bool:
        """True while the arm stands and forces may change all the same: by jaws, or by a plug that
        still comes to rest in its socket."""
        position = self.jaws[self.scenario.gripper.device].last_position
        moved, self._jaws_seen = position != self._jaws_seen, position
        return moved or self.mating.response is not None

    def _module_load(self, cell_T_flange: RigidTransform) -> Array:
        """Wrench on the sensor, in its axes."""
        module, settings = self.module, self.scenario.module
        jaws = self.jaws[self.scenario.gripper.device]
        rests_at = self._rests_at(cell_T_flange)
        in_socket = self.mating.depth_m > _KEPT_M
        module.follow(jaws, cell_T_flange, rests_at=rests_at, in_socket=in_socket)
        if module.place != "gripper":
            return np.zeros(6)
        cell_T_plug = module.now(cell_T_flange)
        socket = self.parts.cell_T_socket
        wrench = self.mating.hold_at(socket.inv() * cell_T_plug)
        module.slip(float(wrench[2]), EVERY_MS * 1e-3)
        weight = settings.mass_kg * _GRAVITY
        com = cell_T_plug.apply(np.array(settings.com_in_plug_mm) * MM)
        sensor = cell_T_flange * self._flange_T_sensor
        origin = sensor.translation
        force = socket.rotation.apply(wrench[:3])
        torque = socket.rotation.apply(wrench[3:])
        torque = torque + np.cross(socket.translation - origin, force)
        torque = torque + np.cross(com - origin, weight)
        turned = sensor.rotation.inv()
        return np.concatenate([turned.apply(force + weight), turned.apply(torque)])

    def _rests_at(self, cell_T_flange: RigidTransform) -> RigidTransform:
        """True cell_T_plug: where the springs leave it."""
        cell_T_plug = self.module.now(cell_T_flange)
        if self.module.place != "gripper":
            return cell_T_plug
        socket = self.parts.cell_T_socket
        return socket * self.mating.rests_at(socket.inv() * cell_T_plug)

    # -- views ----------------------------------------------------------------------------------
    def bodies_before(self, camera_T_cell: RigidTransform) -> Iterator[Seen]:
        """Socket, plug and marks, or the top of the module on its tray, as far as in view."""
        flange = self.flange(self.scenario.gripper.carried_by)
        panel_m = np.array(self.scenario.socket.panel_mm) * MM
        housing_m = np.array(self.scenario.module.housing_mm) * MM
        socket = camera_T_cell * self.parts.cell_T_socket
        plug = camera_T_cell * self.module.now(flange)
        marks = camera_T_cell * flange * self.flange_T_marks
        if self.module.place != "socket" and in_view(socket, (panel_m[0], panel_m[1])):
            yield placed(self.parts.socket, socket)
        if self.module.place == "gripper" and in_view(plug, (housing_m[0], housing_m[1])):
            yield placed(self.parts.plug, plug)
        if in_view(marks, _MARKS_FACE_M):
            yield gripper_marks(marks)
        top = module_top(self.scenario, self.parts, plug)
        if self.module.place != "gripper" and in_view(top.camera_T_part, top.size_m):
            yield top

    # -- truth ----------------------------------------------------------------------------------
    def truth_report(self) -> dict[str, Any]:
        """Poses, the plug against its socket, pins by their state, forces of each contact."""
        flange = self.flange(self.scenario.gripper.carried_by)
        cell_T_plug = self.module.now(flange)
        held_at = self.parts.cell_T_socket.inv() * cell_T_plug
        rests_at = self.parts.cell_T_socket.inv() * self._rests_at(flange)
        offsets = np.linalg.norm(offsets_m(self.parts.pair, held_at), axis=1)
        names = [contact.name for contact in self.parts.plug.contacts]
        states = [PinState(state).name.lower() for state in self.mating.states]
        return {
            "load": self._loads,
            "module": self.module.place,
            "cell_T_flange_mm_deg": to_written(flange),
            "cell_T_camera_mm_deg": {
                name: to_written(self.camera_pose(name)) for name in self.truth.cameras
            },
            "cell_T_socket_mm_deg": to_written(self.parts.cell_T_socket),
            "cell_T_plug_mm_deg": to_written(cell_T_plug),
            "flange_T_marks_mm_deg": to_written(self.flange_T_marks),
            "socket_T_plug_mm_deg": to_written(rests_at),
            "offset_at_worst_contact_mm": float(offsets.max() / MM),
            "worst_contact": names[int(offsets.argmax())],
            "seated_depth_mm": -float(rests_at.translation[2] / MM),
            "pins": dict(zip(names, states, strict=True)),
            "bent": [pin.name for pin in self.parts.plug.contacts if any(pin.bend_m)],
            "missing": [pin.name for pin in self.parts.plug.contacts if not pin.present],
            "blocked": [hole.name for hole in self.parts.socket.contacts if hole.blocked],
            "peak_side_n": dict(zip(names, self.mating.peak_side_n.tolist(), strict=True)),
            "peak_axial_n": dict(zip(names, self.mating.peak_axial_n.tolist(), strict=True)),
        }
