"""Plates and boards that lie in the cell, and payloads behind the force sensors, as a scene."""

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.scenario_file.scenario import Scenario
from fakes.scenes.plate.bodies import LyingBoard, LyingPlate, draw_board, draw_plate
from fakes.scenes.plate.scenario import PlateScenario
from fakes.world.frames import MM, Array, from_written, to_written
from fakes.world.load.payload import Payload
from fakes.world.scene import Body
from fakes.world.views import in_view
from fakes.world.world import Command, World


class PlateScene(World[PlateScenario]):
    """Nothing in it can be touched: a force sensor feels weight and inertia only."""

    scenario_model: ClassVar[type[Scenario]] = PlateScenario

    def __init__(self, scenario: PlateScenario, seed: int) -> None:
        super().__init__(scenario, seed)
        self._payloads = {name: self._payload(name) for name in scenario.payloads}
        self._loads = 0
        self.load()

    def load(self) -> dict[str, Any]:
        """Lay the next plates and the boards into the cell, each a little beside its place."""
        self._loads += 1
        self.plates = {
            name: draw_plate(plate, self.seed, name, self._loads)
            for name, plate in self.scenario.plates.items()
        }
        self.boards = {
            name: draw_board(board, self.seed, name, self._loads)
            for name, board in self.scenario.boards.items()
        }
        return {"load": self._loads}

    def commands(self) -> Mapping[str, Command]:
        """The hands of the operator on the control port."""
        return {"load": self.load}

    def load_on(self, sensor: str, flange: Array, *, moving: bool) -> Array:
        """Weight and inertia of the payload behind a sensor."""
        payload = self._payloads.get(sensor)
        if payload is None:
            return np.zeros(6)
        payload.advance(flange, moving=moving)
        return payload.load

    def bodies_before(self, camera_T_cell: RigidTransform) -> Iterator[Body]:
        """Plates and boards, as far as they are in view."""
        bodies: tuple[LyingPlate | LyingBoard, ...] = (*self.plates.values(), *self.boards.values())
        for body in bodies:
            if in_view(camera_T_cell * body.cell_T_body, body.size_m):
                yield body.seen(camera_T_cell)

    def truth_report(self) -> dict[str, Any]:
        """True poses of flanges, cameras, plates with their holes, and boards; true loads."""
        return {
            "load": self._loads,
            "cell_T_flange_mm_deg": {name: to_written(self.flange(name)) for name in self.arms},
            "cell_T_camera_mm_deg": {
                name: to_written(self.camera_pose(name)) for name in self.truth.cameras
            },
            "plates": {name: _plate_report(plate) for name, plate in self.plates.items()},
            "cell_T_board_mm_deg": {
                name: to_written(board.cell_T_body) for name, board in self.boards.items()
            },
            "payload_kg": {
                name: payload.mass_kg for name, payload in self.scenario.payloads.items()
            },
            "load_n_nm": {name: payload.load.tolist() for name, payload in self._payloads.items()},
        }

    def _payload(self, sensor: str) -> Payload:
        settings = self.scenario.payloads[sensor]
        nominal = from_written(self.scenario.force_sensors[sensor].flange_T_sensor_mm_deg)
        payload = Payload(
            settings,
            self.truth.force_sensors[sensor].flange_T_sensor,
            mass_kg=settings.mass_kg,
            com_in_flange_m=nominal.apply(np.array(settings.com_in_sensor_mm) * MM),
        )
        payload.advance(self.sensors[sensor].flange, moving=False)
        return payload


def _plate_report(plate: LyingPlate) -> dict[str, Any]:
    centres = {
        hole.name: (plate.cell_T_body.apply([*hole.position_m, 0.0]) / MM).tolist()
        for hole in plate.holes
    }
    return {"cell_T_plate_mm_deg": to_written(plate.cell_T_body), "holes_mm": centres}
