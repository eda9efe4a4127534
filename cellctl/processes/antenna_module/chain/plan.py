"""Where the flange goes so that the plug stands before its socket, or why it may not go."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cellctl.calibration.pose_record import pose_to_record
from cellctl.errors.calibration import CalibrationMissing
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.chain.cell_figures import PlugCell
from cellctl.processes.antenna_module.chain.compose import (
    correction_of,
    reached_socket_T_plug,
    target_pose,
)
from cellctl.processes.antenna_module.chain.looks import Looks
from cellctl.processes.antenna_module.chain.requirements import (
    require_fresh,
    require_one_set,
    require_one_wrist,
    require_wrist,
)
from cellctl.processes.antenna_module.chain.schemes import Scheme, base_T_socket
from cellctl.processes.antenna_module.chain.teaching.made_with import MadeWith
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection, TaughtSlot
from cellctl.processes.antenna_module.chain.termed_pose import Term
from cellctl.processes.antenna_module.chain.worst_contact import (
    WorstContact,
    predict_worst_contact,
)
from cellctl.processes.antenna_module.faults.plugging import PlugUncertain


@dataclass(frozen=True, slots=True, eq=False)
class ContactPattern:
    """Contacts of the connector by its drawing."""

    names: tuple[str, ...]
    positions_m: Array
    """x and y in the frame of the connector, shape (k, 2)."""


@dataclass(frozen=True, slots=True)
class PlugTolerance:
    """When a plan is refused."""

    worst_contact_m: float = 50e-6
    """What the predicted 99th percentile of the worst contact may be: the tolerance of the fit that
    the paper states."""
    max_age_s: float = 60.0
    """Greatest age of a look."""


@dataclass(frozen=True, slots=True, eq=False)
class PlugPlan:
    """A target with what is known of its error."""

    scheme: str
    base_T_flange: UncertainPose
    """The target; the covariance is that of where the flange would have to be."""
    socket_T_plug: UncertainPose
    """Where the plug will lie, the last approach of the robot included."""
    terms_m: Mapping[Term, float]
    """Standard deviations by cause, per axis in the plane of the socket; their squares add."""
    worst: WorstContact
    slot: str | None
    """The taught slot whose correction was used."""
    distance_m: float
    """Distance from there to the socket."""

    def to_record(self) -> dict[str, Any]:
        """Plain data: poses in mm and degrees, distances in µm."""
        named = {
            Term.LOOK_PLUG, Term.LOOK_SOCKET, Term.APPROACH, Term.CORRECTION, Term.DRIFT,
        }  # fmt: skip
        return {
            "scheme": self.scheme,
            "base_T_flange": pose_to_record(self.base_T_flange),
            "socket_T_plug": pose_to_record(self.socket_T_plug),
            "p99_um": self.worst.p99_m * 1e6,
            "worst_contact": self.worst.name,
            "terms_um": {
                str(term): self.terms_m.get(term, 0.0) * 1e6
                for term in Term
                if term in named or term in self.terms_m
            },
            "slot": self.slot,
            "distance_mm": self.distance_m * 1e3,
        }


def plan_plug(
    looks: Looks,
    cell: PlugCell,
    scheme: Scheme,
    contacts: ContactPattern,
    *,
    now_s: float,
    correction: PlugCorrection | None = None,
    tolerance: PlugTolerance | None = None,
) -> PlugPlan:
    """Compose the target and predict the plug's error.

    Raises the faults of ``chain.requirements`` and of ``PlugCorrection``, ``CalibrationMissing``
    for a scheme without the correction that it needs, ``PlugUncertain``.
    """
    tolerance = tolerance or PlugTolerance()
    require_fresh(looks, now_s, tolerance.max_age_s)
    plan = compose_plan(looks, cell, scheme, contacts, correction)
    # Written so that a prediction that is not a number is refused too.
    if not plan.worst.p99_m <= tolerance.worst_contact_m:
        largest = max(plan.terms_m, key=lambda term: plan.terms_m[term])
        raise PlugUncertain(
            f"p99 of contact {plan.worst.name} {plan.worst.p99_m * 1e6:.0f} µm, allowed "
            f"{tolerance.worst_contact_m * 1e6:.0f} µm; largest term {largest} "
            f"{plan.terms_m[largest] * 1e6:.1f} µm"
        )
    return plan


def compose_plan(
    looks: Looks,
    cell: PlugCell,
    scheme: Scheme,
    contacts: ContactPattern,
    correction: PlugCorrection | None = None,
) -> PlugPlan:
    """The plan however uncertain it is and however old the looks are, for judging a scheme."""
    require_one_set(looks, cell)
    wrist = require_one_wrist(looks.all())
    slot, distance_m = _slot(looks, cell, scheme, correction, wrist)
    target = target_pose(looks, cell, scheme, correction_of(slot), distance_m)
    reached = reached_socket_T_plug(target, looks, cell, scheme)
    worst = predict_worst_contact(reached.total.covariance, contacts.positions_m, contacts.names)
    return PlugPlan(
        scheme=scheme.name,
        base_T_flange=target.total,
        socket_T_plug=reached.total,
        terms_m={term: _in_plane(covariance) for term, covariance in reached.terms.items()},
        worst=worst,
        slot=None if slot is None else slot.name,
        distance_m=distance_m,
    )


def _slot(
    looks: Looks,
    cell: PlugCell,
    scheme: Scheme,
    correction: PlugCorrection | None,
    wrist: tuple[int, ...],
) -> tuple[TaughtSlot | None, float]:
    if not scheme.taught:
        return None, 0.0
    if correction is None:
        raise CalibrationMissing(f"the scheme {scheme.name} needs a taught plug correction")
    plug, socket = looks.plug.connector, looks.sockets[0].connector
    correction.made_with.require(MadeWith.of(scheme.name, cell, plug, socket))
    require_wrist(wrist, correction.wrist)
    return correction.slot_for(base_T_socket(looks, cell, scheme).pose)


def _in_plane(covariance: Array) -> float:
    return float(np.sqrt(np.trace(covariance[:2, :2]) / 2))
