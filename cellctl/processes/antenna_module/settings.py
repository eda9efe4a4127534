"""Settings of the process for all of its recipes: ``[processes.antenna-module]``."""

from typing import Annotated

from pydantic import Field

from cellctl.config.base import Section
from cellctl.processes.antenna_module.recipe import Place

_Small = Annotated[float, Field(ge=0, le=10)]
_Shift = Annotated[float, Field(ge=0, le=200)]


class ArmSection(Section):
    """How well the robot repeats and reaches poses, from its data sheet or measured."""

    rp_mm: _Small
    """RP of ISO 9283."""
    rp_deg: _Small
    """Standard deviation of the flange's angles from approach to approach."""
    absolute_error_mm: _Small
    """Mean distance between commanded and reached positions."""
    drift_mm: _Small
    """What warming moves one place against another since the calibration, per axis."""


class CamerasSection(Section):
    """What stays wrong in every look."""

    feature_bias_mm: _Small = 0.005
    """Light and chamfers move all contacts of a kind by this, per axis, always alike."""
    drift_mm: _Small = 0.004
    drift_deg: _Small = 0.001


class ReferenceSection(Section):
    """The plate beside camera II, and how often the cell is compared with what was taught."""

    plate_above: str
    """Drawing of the plate's dots as camera I sees them, relative to the cell file."""
    plate_below: str
    """The same dots as camera II sees them."""
    base_T_plate: Place
    """Its z points to camera I."""
    looks: Annotated[int, Field(ge=4, le=16, multiple_of=2)] = 4
    """At the marks and as many at the plate. A check that is in doubt looks twice as often. Even,
    because the marks are looked at about 0° and about half a turn in turn."""
    taught_looks: Annotated[int, Field(ge=8, le=32, multiple_of=2)] = 16
    every_h: Annotated[float, Field(ge=0, le=87_600)] = 1.0
    """A run whose last check is older begins with one; 0: every run."""


class AntennaSettings(Section):
    """Figures of the cell, and settings of the calibration procedures."""

    arm: ArmSection
    cameras: CamerasSection = CamerasSection()
    board: Annotated[str, Field(pattern=r"^\d+x\d+$", examples=["9x6"])] = "9x6"
    """Inner corners of the calibration chessboard, columns x rows."""
    square_mm: Annotated[float, Field(gt=0, le=100)] = 4.0
    views: Annotated[int, Field(ge=15, le=100)] = 36
    """Poses round the board for intrinsics and hand-eye."""
    tilt_deg: Annotated[float, Field(ge=5, le=30)] = 20.0
    turn_deg: Annotated[float, Field(ge=10, le=60)] = 40.0
    depth_mm: Annotated[float, Field(ge=5, le=60)] = 20.0
    shift_mm: tuple[_Shift, _Shift] = (18.0, 6.0)
    """How far the middle of the board goes to either side in the picture, along its width and its
    height. Corners of the board must stay in the picture, turned and nearer too."""
    board_distance_mm: Annotated[float, Field(ge=50, le=1000)] = 250.0
    """From camera I to the board on the table, at ``board_look``."""
    flange_T_board_mm: Annotated[float, Field(ge=0, le=1000)] = 205.0
    """From the flange to the board that hangs on it, along z of the flange."""
    taught_plugs: Annotated[int, Field(ge=4, le=50)] = 8
    """Plugs of one teaching. Four are the fewest, and leave about one plug in 300 beyond 50 µm on
    an arm that repeats to 0.02 mm and has warmed up by 3 K (docs/plugging.md, Teaching)."""
    checked_plugs: Annotated[int, Field(ge=0, le=10)] = 2
    """Further plugs after them, which the correction must agree with."""
    reference: ReferenceSection | None = None
    """None in a cell without a plate: nobody notices there what moves after the calibration."""
    validity_days: Annotated[int, Field(ge=1, le=3650)] = 30
