"""The simulated cell: arms, parts, boards and sensor, advanced in time by its caller.

No I/O and no clock: every method takes or has been given the time, in seconds since switch-on, and
times never run backwards. Poses are true; ``cell`` is the base frame of the main robot.
"""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.faults import FaultBoard
from fakes.scenario import HeadName, Scenario
from fakes.world.boards import chessboard_view, target_board_pose
from fakes.world.frames import Array
from fakes.world.payload import STEP_S, Payload
from fakes.world.report import truth_report
from fakes.world.robot import RobotArm
from fakes.world.scene import CameraScene
from fakes.world.sensor import ForceReading
from fakes.world.snapshot import Placed, Snapshot
from fakes.world.targets import SeenTarget, seen_targets
from fakes.world.truth import draw, draw_parts
from fakes.world.views import camera_scene, measuring_camera_pose

_HISTORY = 1024


class World:
    """One cell: its devices by the scenario's hardware seed, all else by ``seed``."""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        self.scenario, self.seed = scenario, seed
        self.truth = draw(scenario, scenario.hardware_seed)
        self.arms = {
            name: RobotArm(robot, self.truth.robots[name], seed)
            for name, robot in scenario.robots.items()
        }
        self.faults = FaultBoard("world")
        self.placed = Placed()
        self.loads = 0
        self.time_s = 0.0
        self._tick = 0
        self._reading = ForceReading(scenario.force_sensor, self.truth.sensor, seed)
        self._history = np.zeros((_HISTORY, 6))
        self._flange = self.arms["main"].flange_matrix(0.0)
        self._exposures = 0
        if scenario.parts.loaded_at_start:
            self.load_parts()
        self.rebuild()

    # -- operator -------------------------------------------------------------------------------
    def load_parts(self) -> None:
        """Bring in the next frame and put the next deck into the gripper."""
        self.loads += 1
        parts = draw_parts(self.scenario, self.seed, self.loads)
        self.placed = replace(self.placed, parts=parts, frame=True, deck=True)
        self.rebuild()

    def set_present(self, *, frame: bool | None = None, deck: bool | None = None) -> None:
        """Take frame or deck of the loaded parts away, or bring them back."""
        self.placed = replace(
            self.placed,
            frame=self.placed.frame if frame is None else frame,
            deck=self.placed.deck if deck is None else deck,
        )
        self.rebuild()

    def place_target_board(self, head: HeadName, number: int) -> None:
        """Lay board P under a head; each number is another placement."""
        pose = target_board_pose(self.scenario, self.seed, head, number)
        self.placed = replace(self.placed, target_board=pose)

    def place_chessboard(self, head: HeadName, number: int) -> None:
        """Lay the chessboard where a head measures; each number is another placement."""
        view = chessboard_view(self.scenario, self.seed, head, number)
        station = measuring_camera_pose(self.snapshot(), head)
        self.placed = replace(self.placed, chessboard=station * view)

    def remove_boards(self) -> None:
        """Take both boards away."""
        self.placed = replace(self.placed, target_board=None, chessboard=None)

    def rebuild(self) -> None:
        """Take over a change of parts or of the faults of the world."""
        placed = self.placed
        self.payload = Payload(
            self.scenario,
            self.truth.sensor,
            placed.parts if placed.deck else None,
            self.faults,
            frame_present=placed.frame,
        )
        self.payload.advance(self._flange, moving=False)

    # -- time -----------------------------------------------------------------------------------
    def advance(self, to_s: float) -> None:
        """Let the time pass up to ``to_s``, in steps of one millisecond."""
        main = self.arms["main"]
        last = int(to_s / STEP_S)
        while self._tick < last:
            self._tick += 1
            self.time_s = self._tick * STEP_S
            moving = main.moving(self.time_s - STEP_S)
            if moving:
                self._flange = main.flange_matrix(self.time_s)
            self.payload.advance(self._flange, moving=moving)
            self._history[self._tick % _HISTORY] = self.payload.load

    def sensor_wrench(self, time_s: float) -> Array:
        """Raw reading at a time of the last second: Fx, Fy, Fz, Mx, My, Mz in N and N·m."""
        self.advance(time_s)
        tick = min(max(int(time_s / STEP_S), self._tick - _HISTORY + 1), self._tick)
        return self._reading.read(self._history[tick % _HISTORY], time_s)

    # -- views ----------------------------------------------------------------------------------
    def snapshot(self) -> Snapshot:
        """The world now."""
        deck = None
        if self.placed.parts is not None and self.placed.deck:
            deck = RigidTransform.from_matrix(self._flange) * self.payload.deck_in_flange()
        return Snapshot(
            scenario=self.scenario,
            seed=self.seed,
            truth=self.truth,
            time_s=self.time_s,
            placed=self.placed,
            flanges={name: arm.flange(self.time_s) for name, arm in self.arms.items()},
            cell_T_deck=deck,
            loads=self.loads,
            contact_force_n=self.payload.contact_force_n,
            peak_contact_force_n=self.payload.peak_contact_force_n,
        )

    def camera_scene(self, head: HeadName) -> CameraScene:
        """What a head sees now; every call is another exposure."""
        self._exposures += 1
        return camera_scene(self.snapshot(), head, self._exposures)

    def targets(self, frames: int) -> tuple[SeenTarget, ...]:
        """Targets that the large-field head sees now, averaged over a number of exposures."""
        self._exposures += 1
        return seen_targets(self.snapshot(), frames, self._exposures)

    def report(self) -> dict[str, Any]:
        """The truth in mm, degrees and N, as JSON values."""
        return truth_report(self.snapshot())
