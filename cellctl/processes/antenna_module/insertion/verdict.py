"""Whether a plug is seated, or which fault its curve shows."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from math import isfinite, nan
from typing import Any

import numpy as np

from cellctl.calibration.checks import Checks, LimitCheck
from cellctl.geometry.pose import MM
from cellctl.processes.antenna_module.connector.connector import Connector, Kind
from cellctl.processes.antenna_module.faults.plugging import (
    PlugBentPin,
    PlugEarlyContact,
    PluggingError,
    PlugOverForce,
    PlugShortSeat,
    PlugSideForce,
)
from cellctl.processes.antenna_module.insertion.curve import InsertionCurve
from cellctl.processes.antenna_module.insertion.features import InsertionFeatures, features_of
from cellctl.processes.antenna_module.insertion.limits import InsertionLimits

_BESIDE_MIDDLE = 0.45
"""A resistance that acts farther from the middle than this share of the farthest contact, 2 mm for
a micro-D, comes from few contacts. With a sensor that is good to 0.002 N·m the place is known to
half a millimetre at the forces that trip."""


class InsertionVerdict(StrEnum):
    """How an insertion went."""

    SEATED = "seated"
    EARLY = "early"
    """Resistance before the springs, from many contacts: offset, or a foreign body."""
    SIDE = "side"
    """Side force or moment: offset, or a turned module."""
    SHORT = "short"
    """Seated at another depth, or not at all."""
    OVER = "over"
    BENT_PIN = "bent_pin"
    """Resistance before the springs, at one place of the connector."""


_FAULTS: Mapping[InsertionVerdict, type[PluggingError]] = {
    InsertionVerdict.EARLY: PlugEarlyContact,
    InsertionVerdict.SIDE: PlugSideForce,
    InsertionVerdict.SHORT: PlugShortSeat,
    InsertionVerdict.OVER: PlugOverForce,
    InsertionVerdict.BENT_PIN: PlugBentPin,
}


@dataclass(frozen=True, slots=True)
class InsertionJudgement:
    """The verdict with what led to it."""

    verdict: InsertionVerdict
    features: InsertionFeatures
    checks: Checks
    suspect: str | None
    """The contact that the moment points at; None when nothing points at one."""
    of_drawing: str
    """Whose contact that is. Plug and socket mirror each other: by the other's drawing the moment
    points at the other end of the row."""
    unfelt_seat: str | None = None
    """Why no seat was felt; None when one was."""

    @property
    def fault(self) -> PluggingError | None:
        """The numbered fault; None for a plug that is seated."""
        if self.verdict is InsertionVerdict.SEATED:
            return None
        words = [str(check) for check in self.checks if not check.passed]
        if self.unfelt_seat is not None:
            words.append(self.unfelt_seat)
        if self.suspect is not None:
            words.append(f"contact {self.suspect} of the {self.of_drawing}, by moments in its axes")
        return _FAULTS[self.verdict]("; ".join(words))

    def to_record(self) -> dict[str, Any]:
        """Plain data."""
        fault = self.fault
        return {
            "verdict": self.verdict.value,
            "fault": None if fault is None else fault.number,
            "features": self.features.to_record(),
            "limits": [_plain(check) for check in self.checks],
            "suspected_contact": self.suspect,
            "axes": self.of_drawing,
        }


def judge_insertion(
    curve: InsertionCurve, connector: Connector, limits: InsertionLimits | None = None
) -> InsertionJudgement:
    """The verdict of a whole curve; without ``limits`` with those of the connector's drawing.

    A contact that is missing is not among the faults: lots of contacts differ in force by more
    than six to one, so that no curve shows it.
    """
    limits = limits or InsertionLimits.of(connector)
    features = features_of(curve, limits)
    checks = _checks(features, limits)
    failed = {check.name for check in checks if not check.passed}
    suspect = _suspect(features, connector) if _EARLY in failed else None
    verdict = _verdict(failed, points_at_one=suspect is not None)
    return InsertionJudgement(
        verdict,
        features,
        checks,
        suspect if verdict is InsertionVerdict.BENT_PIN else None,
        f"{_SIDES[connector.kind]} {connector.name}",
        _unfelt_seat(features, limits) if features.seat_depth_m is None else None,
    )


_SIDES: Mapping[Kind, str] = {"pins": "plug", "holes": "socket"}
_EARLY, _EARLY_SIDE = "axial force before the springs", "side force before the springs"
_SIDE, _MOMENT, _PRESSURE = "side force", "moment about z", "centre of pressure"
_OVER, _SEAT = "axial force", "distance from the seat's depth"


def _checks(features: InsertionFeatures, limits: InsertionLimits) -> Checks:
    seat = features.seat_depth_m
    off_m = nan if seat is None else abs(seat - limits.seat_depth_m)
    return (
        LimitCheck(_EARLY, features.early_axial_n, limits.entry_axial_n, "N"),
        LimitCheck(_EARLY_SIDE, features.early_side_n, limits.entry_side_n, "N"),
        LimitCheck(_SIDE, features.side_n, limits.sliding_side_n, "N"),
        LimitCheck(_MOMENT, features.moment_z_n_m, limits.moment_z_n_m, "N·m"),
        LimitCheck(_PRESSURE, features.pressure_m / MM, features.pressure_limit_m / MM, "mm"),
        LimitCheck(_OVER, features.total_n, limits.greatest_n + limits.over_n, "N"),
        LimitCheck(_SEAT, off_m / MM, limits.seat_tolerance_m / MM, "mm"),
    )


def _unfelt_seat(features: InsertionFeatures, limits: InsertionLimits) -> str:
    return (
        f"no seat was felt: nowhere behind the springs did the force rise by "
        f"{limits.seat_rise_n:g} N within {limits.seat_within_m / MM:g} mm; greatest force "
        f"{features.total_n:.3g} N, deepest point {features.depth_m / MM:.4g} mm"
    )


def _plain(check: LimitCheck) -> dict[str, Any]:
    """JSON has no number for what was not measured."""
    return check.to_record() | {"value": check.value if isfinite(check.value) else None}


def _verdict(failed: set[str], *, points_at_one: bool) -> InsertionVerdict:
    if not failed:
        return InsertionVerdict.SEATED
    # The entry comes first: what goes wrong there explains what follows.
    if _EARLY in failed:
        # A module that is turned touches with one contact first, too, and shows by its moment.
        if points_at_one and _MOMENT not in failed:
            return InsertionVerdict.BENT_PIN
        sideways = _EARLY_SIDE in failed or _MOMENT in failed
        return InsertionVerdict.SIDE if sideways else InsertionVerdict.EARLY
    if _OVER in failed:
        return InsertionVerdict.OVER
    if failed & {_EARLY_SIDE, _SIDE, _MOMENT}:
        return InsertionVerdict.SIDE
    return InsertionVerdict.SHORT if _SEAT in failed else InsertionVerdict.SIDE


def _suspect(features: InsertionFeatures, connector: Connector) -> str | None:
    """The contact nearest to where the plug touched."""
    touch = features.early_pressure_m
    farthest_m = float(np.linalg.norm(connector.positions_m, axis=1).max())
    if touch is None or np.hypot(*touch) < _BESIDE_MIDDLE * farthest_m:
        return None
    distances = np.linalg.norm(connector.positions_m - np.array(touch), axis=1)
    return connector.contacts[int(distances.argmin())]
