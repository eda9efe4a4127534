"""A deck in the gripper of a robot, over the frame that it is to be mated with, as a scene."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
from scipy.spatial.transform import RigidTransform

from fakes.faults import FaultBoard
from fakes.scenario_file.scenario import Scenario
from fakes.scenes.deck_on_frame.boards import (
    board_discs,
    chessboard_view,
    measuring_flange,
    target_board_pose,
)
from fakes.scenes.deck_on_frame.contact import rim
from fakes.scenes.deck_on_frame.gauges import pin_offsets
from fakes.scenes.deck_on_frame.parts import PartsTruth, draw_parts, grip_slips
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.views import plates, seen_target_board
from fakes.world.boards import chessboard_as_made
from fakes.world.frames import MM, Array, from_written, to_written
from fakes.world.load.contact import Touch
from fakes.world.load.payload import Payload
from fakes.world.scene import Body
from fakes.world.targets import UP, Target
from fakes.world.truth import ForceSensorTruth
from fakes.world.world import Command, World

FAULTS = {
    "foreign_body": "a body of `height_mm` lies on the frame at `x_mm`, `y_mm`",
    "pin_catch": "a chamfer of `slope_deg` at `x_mm`, `y_mm` catches `height_mm` above the frame",
    "held_dowel": "a dowel at `x_mm`, `y_mm` jams `height_mm` above the seat and holds the deck "
    "with `stiffness_n_m` until it is 2 mm away",
    "no_frame": "there is no frame under the deck",
}


@dataclass(frozen=True, slots=True)
class Placed:
    """What the operator has put into the cell; poses of boards in the cell."""

    parts: PartsTruth | None = None
    frame: bool = True
    deck: bool = True
    target_board: RigidTransform | None = None
    chessboard: RigidTransform | None = None


class DeckOnFrame(World[DeckScenario]):
    """Frame, deck, gripper, and the boards of the calibrations."""

    scenario_model: ClassVar[type[Scenario]] = DeckScenario
    fault_texts: ClassVar[Mapping[str, str]] = FAULTS

    def __init__(self, scenario: DeckScenario, seed: int) -> None:
        super().__init__(scenario, seed)
        self.placed = Placed()
        self.loads = 0
        self._moved = False
        self._slips: Iterator[RigidTransform] = iter(())
        self._chessboard = chessboard_as_made(scenario.chessboard, scenario.hardware_seed, seed)
        if scenario.parts.loaded_at_start:
            self.load_parts()
        self.rebuild()

    # -- operator -------------------------------------------------------------------------------
    def load_parts(self) -> None:
        """Bring in the next frame and put the next deck into the gripper."""
        self.loads += 1
        self._slips = grip_slips(self.scenario, self.seed, self.loads)
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

    def place_target_board(
        self, head: str, number: int, joints_deg: Sequence[float] | None = None
    ) -> None:
        """Lay board P under a head, where it measures (``measuring_flange``); each number is
        another placement."""
        flange = measuring_flange(self.scenario, self._head(head), joints_deg)
        pose = target_board_pose(self.scenario, self.seed, head, number, flange)
        self.placed = replace(self.placed, target_board=pose)

    def place_chessboard(
        self, head: str, number: int, joints_deg: Sequence[float] | None = None
    ) -> None:
        """Lay the chessboard where a head measures (``measuring_flange``); each number is another
        placement."""
        view = chessboard_view(self.scenario, self.seed, self._head(head), number)
        flange_T_camera = self.truth.cameras[head].mount_T_camera
        station = measuring_flange(self.scenario, head, joints_deg) * flange_T_camera
        self.placed = replace(self.placed, chessboard=station * view)

    def remove_boards(self) -> None:
        """Take both boards away."""
        self.placed = replace(self.placed, target_board=None, chessboard=None)

    def rebuild(self) -> None:
        """Take over a change of parts or of the faults of the world."""
        placed = self.placed
        self.payload = deck_payload(
            self.scenario,
            self.truth.force_sensors[self.scenario.payload.behind],
            placed.parts if placed.deck else None,
            self.faults,
            frame_present=placed.frame,
        )
        self.payload.advance(self.sensors[self.scenario.payload.behind].flange, moving=False)

    def commands(self) -> Mapping[str, Command]:
        """The hands of the operator on the control port."""
        return {
            "load": self._load,
            "present": self.set_present,
            "reset_peak": self._reset_peak,
            "place_target_board": _placing(self.place_target_board),
            "place_chessboard": _placing(self.place_chessboard),
            "remove_boards": self.remove_boards,
        }

    def faults_changed(self) -> None:
        """Bodies and chamfers are part of what the deck can touch."""
        self.rebuild()

    # -- physics and views ----------------------------------------------------------------------
    def load_on(self, sensor: str, flange: Array, *, moving: bool) -> Array:
        """Gripper and deck behind their sensor; any other sensor carries nothing."""
        if sensor != self.scenario.payload.behind:
            return np.zeros(6)
        if moving and not self._moved:
            self._slip()
        self._moved = moving
        self.payload.advance(flange, moving=moving)
        return self.payload.load

    def cell_T_deck(self) -> RigidTransform | None:
        """True pose of the deck; None when there is no deck in the gripper."""
        parts = self.placed.parts
        if parts is None or not self.placed.deck:
            return None
        flange = self.sensors[self.scenario.payload.behind].flange
        return RigidTransform.from_matrix(flange) * self.payload.deflected(parts.flange_T_deck)

    def bodies_before(self, camera_T_cell: RigidTransform) -> Iterator[Body]:
        """Parts, then boards."""
        placed = self.placed
        if placed.parts is not None:
            yield from plates(
                self.scenario,
                placed.parts,
                camera_T_cell,
                frame=placed.frame,
                cell_T_deck=self.cell_T_deck(),
            )
        if placed.target_board is not None:
            pose = camera_T_cell * placed.target_board
            yield seen_target_board(self.scenario, self.seed, pose)
        if placed.chessboard is not None:
            yield self._chessboard.seen(camera_T_cell * placed.chessboard)

    def targets_for(self, tracker: str) -> Iterator[Target]:  # noqa: ARG002  every one sees them
        """The discs of board P."""
        cell_T_board = self.placed.target_board
        if cell_T_board is not None:
            for disc in board_discs(self.scenario.target_board):
                yield Target(disc.name, cell_T_board, np.array([*disc.position_m, 0.0]), UP)

    def truth_report(self) -> dict[str, Any]:
        """True poses, pin holes, contact forces."""
        camera_1, camera_2 = (self.camera_pose(name) for name in self.scenario.stereo_cameras)
        (tracker,) = self.truth.trackers.values()
        report: dict[str, Any] = {
            "load": self.loads,
            "base_T_flange_mm_deg": to_written(self.flange(self.scenario.deck_robot)),
            "base_T_c1_mm_deg": to_written(camera_1),
            "base_T_c2_mm_deg": to_written(camera_2),
            "c1_T_c2_mm_deg": to_written(camera_1.inv() * camera_2),
            "base_T_c_mm_deg": to_written(tracker.cell_T_tracker),
            "contact_force_n": self.payload.contact_force_n,
            "peak_contact_force_n": self.payload.peak_contact_force_n,
        }
        parts, cell_T_deck = self.placed.parts, self.cell_T_deck()
        if parts is not None:
            report["base_T_frame_mm_deg"] = to_written(parts.cell_T_frame)
            report["flange_T_deck_mm_deg"] = to_written(parts.flange_T_deck)
            report["deck_thickness_mm"] = parts.deck_thickness_m / MM
            report["contact_stiffness_n_m"] = parts.contact_stiffness_n_m
        if parts is not None and cell_T_deck is not None:
            frame_T_deck = parts.cell_T_frame.inv() * cell_T_deck
            report["base_T_deck_mm_deg"] = to_written(cell_T_deck)
            report["frame_T_deck_mm_deg"] = to_written(frame_T_deck)
            report["pins"] = pin_offsets(parts, frame_T_deck)
        return report

    def _slip(self) -> None:
        """The arm jerks into motion; a deck that frame or pins hold stays where it is."""
        parts = self.placed.parts
        slip = next(self._slips, None)
        if parts is None or slip is None or self.payload.contact_force_n > 0:
            return
        parts = replace(parts, flange_T_deck=parts.flange_T_deck * slip)
        if self.payload.regrip(parts.flange_T_deck):
            self.placed = replace(self.placed, parts=parts)

    def _load(self) -> dict[str, Any]:
        self.load_parts()
        return {"load": self.loads}

    def _reset_peak(self) -> None:
        self.payload.peak_contact_force_n = 0.0

    def _head(self, name: str) -> str:
        if name not in self.scenario.stereo_cameras:
            raise ValueError(
                f"unknown head {name!r}; known: {sorted(self.scenario.stereo_cameras)}"
            )
        return name


def deck_payload(
    scenario: DeckScenario,
    sensor: ForceSensorTruth,
    parts: PartsTruth | None,
    faults: FaultBoard,
    *,
    frame_present: bool,
) -> Payload:
    """Gripper and, with ``parts``, a deck behind the sensor; over a frame if there is one."""
    settings = scenario.payload
    com_mm = settings.com_in_sensor_mm if parts else settings.gripper_com_in_sensor_mm
    nominal = from_written(scenario.force_sensors[settings.behind].flange_T_sensor_mm_deg)
    touch = None
    if parts is not None and frame_present and not faults.active("no_frame"):
        touch = Touch(
            flange_T_body=parts.flange_T_deck,
            cell_T_other=parts.cell_T_frame,
            points=rim(scenario, parts, faults),
            damping_ratio=scenario.contact.damping_ratio,
            friction=scenario.contact.friction,
        )
    return Payload(
        settings,
        sensor.flange_T_sensor,
        mass_kg=settings.gripper_kg + (settings.deck_kg if parts else 0.0),
        com_in_flange_m=nominal.apply(np.array(com_mm) * MM),
        touch=touch,
    )


def _placing(place: Callable[[str, int, Sequence[float] | None], None]) -> Command:
    """A command that puts a board under a head; another number is another placement."""

    def command(head: str, number: int = 0, joints_deg: Sequence[float] | None = None) -> None:
        place(head, int(number), joints_deg)

    return command
