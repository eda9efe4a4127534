"""Sections of the scenario file that describe the peg, its hole, and what holds both."""

from pydantic import Field

from fakes.scenario_file.scenario import Scenario
from fakes.scenario_file.sections import DeviceName, Pose, Section, Spread, Springs, Three


class KeySection(Section):
    """Keys that let the plug in at one yaw."""

    depth_mm: float
    window_deg: float
    """Half width of the yaw that enters."""


class FitSection(Section):
    """Shape of peg and hole; all chamfers at 45°."""

    peg_radius_mm: float = Field(gt=0)
    bore_radius_mm: float = Field(gt=0)
    hole_chamfer_mm: float = Field(default=0.0, ge=0)
    peg_chamfer_mm: float = Field(default=0.0, ge=0)
    depth_mm: float = Field(gt=0)
    """Depth below the face at which the bottom of the peg rests."""
    outer_radius_mm: float | None = None
    """Radius of the part with the hole if it stands proud of its panel; None for a wide plate."""
    proud_mm: float | None = None
    friction: float = Field(default=0.2, ge=0, le=1)
    contacts: tuple[tuple[float, float], ...] = ()
    """Depth (mm) and axial force (N) of the contacts inside, linear between."""
    keys: KeySection | None = None


class PegSection(Springs):
    """The peg in the fingers. The springs are those of the tool with its inertia."""

    carried_by: DeviceName
    force_sensor: DeviceName
    flange_T_tip_mm_deg: Pose
    """Centre of the bottom of a well gripped peg, z out of the fingers."""
    grip: Spread
    """How far the peg is beside it, drawn with every part."""
    grip_force_n: float = Field(gt=0)
    """Axial force at which the peg slips in the fingers."""
    mass_kg: float
    """Mass of everything that hangs behind the sensor."""
    com_in_sensor_mm: Three


class SocketSection(Section):
    """Where the hole is said to be, and how far from there it truly is."""

    cell_T_hole_mm_deg: Pose
    """Middle of the mouth on the face, z out of the hole: what the coarse position says."""
    lateral_p99_mm: float = Field(ge=0)
    """Radius within which 99 % of all holes truly lie; a normal draw."""
    height_spread_mm: float = Field(ge=0)
    tilt_spread_deg: float = Field(ge=0)
    """Half width of the tilt, about x and about y each."""
    yaw_spread_deg: float = Field(ge=0)


class CompliantArm(Section):
    """Stiffness of everything between the commanded pose and the tip of the peg."""

    lateral_n_m: float = Field(gt=0)
    axial_n_m: float = Field(gt=0)
    turning_nm_rad: float = Field(gt=0)
    yaw_nm_rad: float = Field(gt=0)


class SocketScenario(Scenario):
    """The whole file."""

    peg: PegSection
    fit: FitSection
    socket: SocketSection
    compliance: CompliantArm
