"""Teaching the plug correction: plugs that were put in by hand or under compliance."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from cellctl.calibration.checks import Checks, LimitCheck
from cellctl.calibration.solvers.pose_average import average
from cellctl.geometry.pose import MM, Array, pose_error
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.chain.cell_figures import PlugCell, isotropic
from cellctl.processes.antenna_module.chain.compose import taught_socket_T_plug
from cellctl.processes.antenna_module.chain.looks import Looks
from cellctl.processes.antenna_module.chain.requirements import require_one_set, require_one_wrist
from cellctl.processes.antenna_module.chain.schemes import Scheme, base_T_socket
from cellctl.processes.antenna_module.chain.teaching.made_with import MadeWith
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection, TaughtSlot
from cellctl.processes.antenna_module.faults.calibration import TeachScatter, TooFewTeachings
from cellctl.processes.antenna_module.faults.plugging import CalibrationsDoNotBelongTogether


@dataclass(frozen=True, slots=True, eq=False)
class TaughtPlug:
    """The looks before one plug, and where the flange was once it sat."""

    name: str
    looks: Looks
    base_T_flange: RigidTransform


@dataclass(frozen=True, slots=True)
class TeachLimits:
    """When a teaching is refused."""

    plugs: int = 4
    scatter_m: float = 15e-6
    """Per axis in the plane."""
    scatter_rad: float = float(np.radians(0.03))


@dataclass(frozen=True, slots=True)
class GaugePlay:
    """How exactly a plug sits in its socket while it is taught; standard deviations."""

    position_m: float = 5e-6
    rotation_rad: float = float(np.radians(0.01))


def teach_plug(
    plugs_by_slot: Mapping[str, Sequence[TaughtPlug]],
    cell: PlugCell,
    scheme: Scheme,
    *,
    play: GaugePlay | None = None,
    limits: TeachLimits | None = None,
    range_m: float = 0.2,
) -> PlugCorrection:
    """The mean correction of every slot with its covariance.

    ``range_m``: how far from its slot a correction holds. At 0.2 m an arm of 0.26 mm mean error
    adds 9 µm per axis, one of 0.82 mm 26 µm (``chain.schemes``).

    Raises ``TooFewTeachings``, ``TeachScatter``, ``CalibrationsDoNotBelongTogether``,
    ``WristConfigurationsDiffer`` or what ``Scheme`` raises for a look that is missing.
    """
    play, limits = play or GaugePlay(), limits or TeachLimits()
    covariance = isotropic(play.position_m, play.rotation_rad)
    every = [plug for plugs in plugs_by_slot.values() for plug in plugs]
    if not every:
        raise TooFewTeachings("no plug was taught")
    for plug in every:
        require_one_set(plug.looks, cell)
    wrist = require_one_wrist(look for plug in every for look in plug.looks.all())
    connectors = {(p.looks.plug.connector, p.looks.sockets[0].connector) for p in every}
    if len(connectors) > 1:
        raise CalibrationsDoNotBelongTogether("plugs of different connectors were taught together")
    (pair,) = connectors
    slots = []
    for name, plugs in plugs_by_slot.items():
        if len(plugs) < limits.plugs:
            raise TooFewTeachings(f"slot {name}: {len(plugs)}, at least {limits.plugs}")
        each = [
            taught_socket_T_plug(plug.looks, plug.base_T_flange, covariance, cell, scheme).total
            for plug in plugs
        ]
        sockets = [base_T_socket(plug.looks, cell, scheme).pose for plug in plugs]
        slot = _slot(name, each, sockets)
        _require_agreement(slot, plugs, each, limits)
        slots.append(slot)
    return PlugCorrection(
        made_with=MadeWith.of(scheme.name, cell, *pair),
        wrist=wrist,
        range_m=range_m,
        slots=tuple(slots),
        checks=_checks(slots, limits),
    )


def _slot(
    name: str, each: Sequence[UncertainPose], sockets: Sequence[RigidTransform]
) -> TaughtSlot:
    mean, _ = average(each)
    deltas = _deltas(mean, each)
    # The mean is taken from the same plugs.
    spare = len(each) - 1
    scatter_m = float(np.sqrt((deltas[:, :2] ** 2).sum() / (2 * spare)))
    scatter_rad = float(np.sqrt((deltas[:, 5] ** 2).sum() / spare))
    return TaughtSlot(
        name, _mean(sockets), mean, len(each), scatter_m, scatter_rad, deltas[:, [0, 1, 5]]
    )


def _deltas(mean: UncertainPose, each: Sequence[UncertainPose]) -> Array:
    """Distances of single plugs from the mean, shape (n, 6)."""
    return np.array([np.concatenate(pose_error(mean.pose, one.pose)) for one in each])


def _require_agreement(
    slot: TaughtSlot,
    plugs: Sequence[TaughtPlug],
    each: Sequence[UncertainPose],
    limits: TeachLimits,
) -> None:
    if slot.scatter_m <= limits.scatter_m and slot.scatter_rad <= limits.scatter_rad:
        return
    # Named for the operator, who may have plugged that one badly; distance and yaw count by the
    # share of their limits that they take.
    worst = plugs[int(np.argmax(_weighed(_deltas(slot.socket_T_plug, each), limits)))].name
    raise TeachScatter(
        f"slot {slot.name}: {slot.scatter_m * 1e6:.1f} µm (allowed {limits.scatter_m * 1e6:.0f}), "
        f"{np.degrees(slot.scatter_rad):.3f}° (allowed {np.degrees(limits.scatter_rad):.3f}); "
        f"farthest from the mean: {worst}"
    )


def _weighed(deltas: Array, limits: TeachLimits) -> Array:
    return np.asarray(
        np.linalg.norm(deltas[:, :2], axis=1) / limits.scatter_m
        + np.abs(deltas[:, 5]) / limits.scatter_rad
    )


def _mean(poses: Sequence[RigidTransform]) -> RigidTransform:
    rotation = Rotation.concatenate([pose.rotation for pose in poses]).mean()
    return RigidTransform.from_components(
        np.mean([pose.translation for pose in poses], axis=0), rotation
    )


def _checks(slots: Sequence[TaughtSlot], limits: TeachLimits) -> Checks:
    return tuple(
        check
        for slot in slots
        for check in (
            LimitCheck(f"slot {slot.name}: plugs", slot.plugs, limits.plugs, "", "min"),
            LimitCheck(
                f"slot {slot.name}: scatter", slot.scatter_m / MM, limits.scatter_m / MM, "mm"
            ),
            LimitCheck(
                f"slot {slot.name}: scatter of yaw",
                float(np.degrees(slot.scatter_rad)),
                float(np.degrees(limits.scatter_rad)),
                "°",
            ),
        )
    )
