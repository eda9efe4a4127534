"""An antenna module is taken from its tray, looked at from below, and plugged."""

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import Optics
from fakes.scenes.antenna_bench.bench import BenchWorld
from fakes.scenes.antenna_bench.boards import plate_dots, plate_size_m
from fakes.scenes.antenna_bench.mating import EVERY_MS, KEPT_M
from fakes.scenes.antenna_bench.operator import BenchOperator
from fakes.scenes.antenna_bench.parts import FAULTS, module_top, placed, tray_face
from fakes.scenes.antenna_bench.scenario import BenchScenario
from fakes.scenes.antenna_bench.truth import truth_of
from fakes.world.boards import chessboard_as_made
from fakes.world.connector.made import gripper_marks
from fakes.world.frames import MM, Array, from_written, inverse_matrix
from fakes.world.load.payload import Payload
from fakes.world.scene import Seen
from fakes.world.views import in_view
from fakes.world.world import Command

_GRAVITY = np.array([0.0, 0.0, -9.80665])
_MARKS_FACE_M = (60e-3, 22e-3)
_SEEN_BEYOND = 1.1
"""What lies so little beside the corner of the picture is drawn, for its edges."""


class AntennaBench(BenchWorld):
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
        self._board = chessboard_as_made(scenario.board, scenario.hardware_seed, seed)
        self._slope_max = max(_slope_max(optics) for optics in scenario.optics.values())
        self.operator = BenchOperator(self)
        self._ticks = 0
        self._contact_n = np.zeros(6)
        self._jaws_seen = -1.0

    def commands(self) -> Mapping[str, Command]:
        """The hands of the operator on the control port."""
        return {"load": self.load, "warm": self.warm, **self.operator.commands()}

    # -- forces ---------------------------------------------------------------------------------
    def load_on(self, sensor: str, flange: Array, *, moving: bool) -> Array:
        """Gripper with its inertia; weight of the module; what the socket does to it."""
        if sensor != self.scenario.gripper.force_sensor:
            return np.zeros(6)
        self.operator.advance(self._ticks)
        self._tool.advance(flange, moving=moving)
        self._ticks += 1
        if self._ticks % EVERY_MS == 0 and (moving or self._something_changes()):
            self._contact_n = self._module_load(flange)
        return np.asarray(self._tool.load + self._contact_n)

    def _something_changes(self) -> bool:
        """True while the arm stands and forces may change all the same: by jaws, or by a plug that
        still comes to rest in its socket."""
        position = self.jaws[self.scenario.gripper.device].last_position
        moved, self._jaws_seen = position != self._jaws_seen, position
        return moved or self.mating.response is not None

    def _module_load(self, flange: Array) -> Array:
        """Wrench on the sensor, in its axes; ``flange`` is the matrix cell_T_flange."""
        # Matrices here, because this is done hundreds of times a second: products of poses that
        # check themselves would take a third of a processor.
        module, settings = self.module, self.scenario.module
        jaws = self.jaws[self.scenario.gripper.device]
        in_socket = self.mating.depth_m > KEPT_M
        module.follow(jaws, flange, rests_at=self.rests_at, in_socket=in_socket)
        if module.place != "gripper":
            return np.zeros(6)
        plug = flange @ module.flange_T_plug.as_matrix()
        socket = self.parts.cell_T_socket.as_matrix()
        wrench = self.mating.hold_at(inverse_matrix(socket) @ plug)
        module.slip(float(wrench[2]), EVERY_MS * 1e-3)
        weight = settings.mass_kg * _GRAVITY
        com = plug[:3, :3] @ (np.array(settings.com_in_plug_mm) * MM) + plug[:3, 3]
        sensor = flange @ self._flange_T_sensor.as_matrix()
        origin = sensor[:3, 3]
        force, torque = socket[:3, :3] @ wrench[:3], socket[:3, :3] @ wrench[3:]
        torque = torque + np.cross(socket[:3, 3] - origin, force)
        torque = torque + np.cross(com - origin, weight)
        turned = sensor[:3, :3].T
        return np.concatenate([turned @ (force + weight), turned @ torque])

    # -- views ----------------------------------------------------------------------------------
    def bodies_before(self, camera_T_cell: RigidTransform) -> Iterator[Seen]:
        """A calibration board alone; else connectors, marks and dots, or tray and module, as far as
        in view."""
        flange = self.flange(self.scenario.gripper.carried_by)
        cell_T_board = self.operator.cell_T_board(flange)
        if cell_T_board is not None:
            board = camera_T_cell * cell_T_board
            # On the flange its plate hides fingers and plug; on its stand nothing else is near.
            if self._sees(board, self._board.size_m):
                yield self._board.seen(board)
                return
        panel_m = np.array(self.scenario.socket.panel_mm) * MM
        housing_m = np.array(self.scenario.module.housing_mm) * MM
        socket = camera_T_cell * self.parts.cell_T_socket
        plug = camera_T_cell * self.module.now(flange)
        marks = camera_T_cell * flange * self.flange_T_marks
        if self.module.place != "socket" and self._sees(socket, (panel_m[0], panel_m[1])):
            yield placed(self.parts.socket, socket)
        # A plug faces camera II from the fingers, and camera I where its module lies on its top.
        if self.module.place != "absent" and self._sees(plug, (housing_m[0], housing_m[1])):
            yield placed(self.parts.plug, plug)
        if self._sees(marks, _MARKS_FACE_M):
            yield gripper_marks(marks)
        dots = plate_dots(self.scenario, camera_T_cell * self.cell_T_plate)
        if self._sees(dots.camera_T_marks, plate_size_m(self.scenario)):
            yield dots
        top = module_top(self.scenario, self.parts, plug)
        tray = tray_face(self.scenario, camera_T_cell, self.seed)
        if self._sees(tray.camera_T_part, tray.size_m):
            yield tray
        lies = self.module.place not in ("gripper", "absent")
        if lies and self._sees(top.camera_T_part, top.size_m):
            yield top

    def _sees(self, camera_T_face: RigidTransform, size_m: tuple[float, float]) -> bool:
        return in_view(camera_T_face, size_m, self._slope_max)

    # -- truth ----------------------------------------------------------------------------------
    def truth_report(self) -> dict[str, Any]:
        """Devices as they are, the plug against its socket, pins by their state, forces."""
        return truth_of(self, self.operator.board_at)


def _slope_max(optics: Optics) -> float:
    """Tangent of the angle from the line of sight to a corner of the picture, and a little more."""
    return _SEEN_BEYOND * float(np.hypot(*optics.image_px)) / 2 / optics.focal_px
