"""Sections of the scenario file that describe module, tray, socket, gripper and their contact."""

from typing import Literal, Self

from pydantic import model_validator

from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import (
    ChessboardPrint,
    DeviceName,
    Pair,
    Pose,
    Section,
    Spread,
    Springs,
    Three,
)


class Module(Springs):
    """An antenna module with its plug; its frame is that of the plug, z out of the connector."""

    connector: Literal["micro-d-15", "d-sub-15"]
    true_position_mm: float
    """Standard deviation of a contact's place, per axis."""
    tip: Literal["chamfer", "dome"] = "chamfer"
    mass_kg: float
    com_in_plug_mm: Three
    housing_mm: Pair
    height_mm: float
    """Height of the top, which camera I sees on the tray, above the plug's origin."""
    top_holes_mm: tuple[Pair, ...]
    """Places of the holes in its top, in the axes of the plug."""
    top_hole_diameter_mm: float


class Tray(Section):
    """Where a module lies with its plug down."""

    cell_T_plug_mm_deg: Pose
    placement: Spread
    size_mm: Pair
    below_top_mm: float
    """Depth of the tray's face below the module's top."""
    brightness: float
    """Relative to bare metal."""


class Socket(Section):
    """Module B: the panel with the socket, z upwards."""

    cell_T_socket_mm_deg: Pose
    placement: Spread
    true_position_mm: float
    panel_mm: Pair


class BenchGripper(Section):
    """The fingers on the flange, their marks, and how well they hold."""

    device: DeviceName
    """Which of the ``[grippers]``."""
    carried_by: DeviceName
    force_sensor: DeviceName
    flange_T_plug_mm_deg: Pose
    """Where the plug of a well gripped module is."""
    flange_T_marks_mm_deg: Pose
    marks_spread: Spread
    grip_range_mm: float
    """A module that is farther from its nominal place is not between the fingers."""
    play: Spread
    """Play of the module in the fingers, drawn at every grip."""
    slip_force_n: float
    """Axial force from which the module slips in the fingers."""
    slip_mm_s: float
    lateral_n_mm: float
    axial_n_mm: float
    """Springs behind the plug: fingers, compliance, arm."""
    mass_kg: float
    com_in_sensor_mm: Three


class CalibrationBoard(ChessboardPrint):
    """The chessboard, where the operator puts it for one or the other camera."""

    cell_T_board_mm_deg: Pose
    """Pose of the board on its stand on the table, face up."""
    flange_T_board_mm_deg: Pose
    """Pose before the fingers, face away from the flange: it hides them and their marks."""
    placement: Spread
    """How far it is put beside either of them."""


class ReferencePlate(Section):
    """A strip of clear glass with white dots, seen by camera I from above and by camera II from
    below. The dots are burnt into the glass: both cameras see the very same ones, and the marks of
    the gripper stay visible behind the strip. The glass itself is not drawn."""

    camera_T_plate_mm_deg: Pose
    """Nominal place before the fixed camera, z against its line of sight's end: away from it. The
    fitter pushes the strip into the edge of this camera's picture, wherever the camera stands."""
    placement: Spread
    dots_mm: tuple[Pair, ...]
    """Dots as camera I sees them, from above."""
    dot_diameter_mm: float


class OperatorHands(Section):
    """Somebody who plugs the held module at the panel of the arm, by feel."""

    gauge_sigma_mm: float
    """How far from stress-free the plug is left, per axis."""
    gauge_sigma_deg: float
    travel_mm_s: float
    """Speed of the way to above the socket."""
    plugging_mm_s: float
    farthest_mm: float
    """The plug has to be so near its socket: nobody jogs an arm through the whole cell."""
    patience_s: float
    """A plug that rests so long above its socket waits for the hands, while they stand by."""


class BenchScenario(Scenario):
    """The whole file. The arm carries one camera, the other one is fixed."""

    module: Module
    tray: Tray
    socket: Socket
    gripper: BenchGripper
    board: CalibrationBoard
    plate: ReferencePlate
    hands: OperatorHands

    @property
    def carried_camera(self) -> DeviceName:
        """Camera I, on the flange."""
        return next(name for name, one in self.cameras.items() if one.carried_by is not None)

    @property
    def fixed_camera(self) -> DeviceName:
        """Camera II, beside the arm."""
        return next(name for name, one in self.cameras.items() if one.carried_by is None)

    @model_validator(mode="after")
    def _one_camera_of_each_kind(self) -> Self:
        carriers = [camera.carried_by for camera in self.cameras.values()]
        if sorted(carriers, key=str) != sorted([None, self.gripper.carried_by], key=str):
            raise ValueError("one camera is carried by the arm of the gripper, one is fixed")
        return self
