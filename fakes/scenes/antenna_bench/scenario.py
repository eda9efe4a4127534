"""Sections of the scenario file that describe module, tray, socket, gripper and their contact."""

from typing import Literal

from fakes.scenario import Scenario
from fakes.sections import DeviceName, Pair, Pose, Section, Spread, Springs, Three


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
    """From the plug's origin up to the top, which camera I sees on the tray."""
    top_holes_mm: tuple[Pair, ...]
    """Places of the holes in its top, in the axes of the plug."""
    top_hole_diameter_mm: float


class Tray(Section):
    """Where a module lies with its plug down."""

    cell_T_plug_mm_deg: Pose
    placement: Spread


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
    """Of the module in the fingers, drawn at every grip."""
    slip_force_n: float
    """Axial force from which the module slips in the fingers."""
    slip_mm_s: float
    lateral_n_mm: float
    axial_n_mm: float
    """Springs behind the plug: fingers, compliance, arm."""
    mass_kg: float
    com_in_sensor_mm: Three


class BenchScenario(Scenario):
    """The whole file."""

    module: Module
    tray: Tray
    socket: Socket
    gripper: BenchGripper
