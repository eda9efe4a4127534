"""The task in numbers: what the drawing says, and what was measured of cell and process.

Source: section 1 of the study of insertion by touch.
"""

from dataclasses import dataclass

_MM = 1e-3
_CHAMFER_MARGIN_M = 0.1 * _MM
"""Part of the width of the chamfers that does not count: edges are not sharp."""
_ENTRY_MARGIN_M = 0.3 * _MM
"""A peg that is deeper than both chamfers by this has entered the bore (section 2, S4)."""
_SLOW_LOOP_N_S_M = 5e3
"""Stiffness times dead time above which a cell gets the longer of the two times."""


@dataclass(frozen=True, slots=True)
class KeyGeometry:
    """Keys that let a plug in at one angle about its axis only."""

    depth_m: float
    """Depth of the tip at which the keys meet the ends of their keyways."""
    window_rad: float
    """Half width of the angles that enter, and the play inside."""
    uncertainty_rad: float
    """The plug is turned by no more than this when it arrives, in 99 of 100 cases."""


@dataclass(frozen=True, slots=True)
class PartContacts:
    """Contacts or springs inside, which hold the part back on its way to the seat."""

    depth_m: float
    """Depth of the tip at which they begin."""
    full_m: float
    """Depth from which on all of them rub."""
    least_n: float
    most_n: float
    """Least and greatest force that they take together, from there to the seat."""


@dataclass(frozen=True, slots=True)
class FitGeometry:
    """Peg and hole by the drawing."""

    peg_radius_m: float
    clearance_m: float
    """Radial: bore radius less peg radius."""
    hole_chamfer_m: float
    peg_chamfer_m: float
    """Widths of chamfers at 45 degrees; 0 without."""
    depth_m: float
    """Depth of the seat below the face."""
    outer_radius_m: float | None = None
    """Radius of the raised plug that has the hole; None for a hole in a plate."""
    keys: KeyGeometry | None = None
    """The keys; None for a round part."""
    contacts: PartContacts | None = None
    """None for a part that nothing but friction holds back before its seat."""

    @property
    def bore_radius_m(self) -> float:
        """Radius of the hole."""
        return self.peg_radius_m + self.clearance_m

    @property
    def rim_radius_m(self) -> float:
        """Radius of the bottom circle of the peg."""
        return self.peg_radius_m - self.peg_chamfer_m

    @property
    def chamfered(self) -> bool:
        """True when hole or peg has a chamfer."""
        return self.hole_chamfer_m + self.peg_chamfer_m > 0

    @property
    def catch_radius_m(self) -> float:
        """An upright peg that stands within this radius of the axis finds its way in."""
        if not self.chamfered:
            return self.clearance_m
        chamfers_m = self.hole_chamfer_m + self.peg_chamfer_m
        return self.clearance_m + max(chamfers_m - _CHAMFER_MARGIN_M, 0.0)

    @property
    def entry_depth_m(self) -> float:
        """Depth below which the peg is between the walls."""
        return self.hole_chamfer_m + self.peg_chamfer_m + _ENTRY_MARGIN_M

    @property
    def rim_m(self) -> float | None:
        """Radius of the circle of peg centres at which the peg leaves the face of the plug."""
        return None if self.outer_radius_m is None else self.outer_radius_m + self.peg_radius_m


@dataclass(frozen=True, slots=True)
class CellFigures:
    """What decides how fast and how well a cell can feel."""

    stiffness_n_m: float
    """Stiffness of arm and contact in series, along the axis of the hole."""
    dead_time_s: float
    """Time from a force at the tip to a motion of the tip in answer."""
    uncertainty_m: float
    """Radius that holds 99 % of the errors of the coarse position."""
    repeatability_m: float
    height_sigma_m: float
    """Standard deviation of one reading of the height in contact, averaged as it is used."""
    force_sigma_n: float
    """Standard deviation of the mean of ten samples of one component of the force."""
    friction: float

    @property
    def loop_n_s_m(self) -> float:
        """Stiffness times dead time: it bounds every speed in contact."""
        return self.stiffness_n_m * self.dead_time_s


@dataclass(frozen=True, slots=True)
class ForceLimits:
    """What may be felt; N and N·m."""

    search_n: float
    insertion_n: float
    fault_n: float
    fault_n_m: float


@dataclass(frozen=True, slots=True)
class SearchTask:
    """One hole to be found by one cell."""

    fit: FitGeometry
    cell: CellFigures
    limits: ForceLimits

    @property
    def search_limit_s(self) -> float:
        """A loop that is slow by nature gets more time (section 1 of the study)."""
        return 60.0 if self.cell.loop_n_s_m <= _SLOW_LOOP_N_S_M else 110.0

    @property
    def search_radius_m(self) -> float:
        """A little more than the uncertainty, since its figure is an estimate itself."""
        return 1.15 * self.cell.uncertainty_m
