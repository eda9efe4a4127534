"""Four ways from a look at the plug to ``flange_T_plug``, by name.

All then go the same way: ``base_T_flange = base_T_socket · correction · (flange_T_plug)⁻¹``.
``absolute`` is the published chain (reference to the plug and the socket by both hand-eye
calibrations). The others put differences in the place of absolute readings.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.solvers.pose_average import average
from cellctl.geometry.pose import Array
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.chain.cell_figures import PlugCell, isotropic
from cellctl.processes.antenna_module.chain.looks import Looks, SocketLook
from cellctl.processes.antenna_module.chain.termed_pose import Term, TermedPose, only_plane
from cellctl.processes.antenna_module.faults.plugging import LooksIncomplete, SocketImplausible

_MAX_DISAGREEMENT = 25.0
"""Reduced chi square of several looks at one socket. Looks of one socket agree within a few
sigma; 25 means five sigma in all directions, which is another socket or a panel that moved."""


@dataclass(frozen=True, slots=True)
class Scheme:
    """One way to the plug."""

    name: str
    flange_T_plug: Callable[[Looks, PlugCell], TermedPose]
    taught: bool
    """Whether it needs the correction from taught plugs."""
    cam1_cancels: bool
    """Whether an error of flange_T_cam1 drops out: because it was as wrong while teaching, or
    because the camera looks at the plate and at the socket in one orientation."""
    kinematic_share: float
    """Share of the arm's mean absolute error that stays, standard deviation per axis, at a taught
    slot. A hand-eye calibration absorbs what is common to its poses, a correction all but the
    scatter of grip and socket. An estimate from other simulated arms than those of
    benchmarks/antenna, which shows how well the prediction made with it holds."""
    arm_drifts: bool
    """Whether what warming moves the robot at camera II against the socket stays in the result."""


def approach(base_T_flange: RigidTransform, cell: PlugCell) -> TermedPose:
    """A pose that the robot reports, with its repeatability."""
    noise = cell.arm.approach_covariance
    return TermedPose.of(Term.APPROACH, UncertainPose(base_T_flange, noise))


def base_T_socket(looks: Looks, cell: PlugCell, scheme: Scheme) -> TermedPose:
    """The socket, as the mean of all looks at it.

    Raises ``LooksIncomplete`` without one, ``SocketImplausible`` when they contradict each other.
    """
    if not looks.sockets:
        raise LooksIncomplete("no look at the socket")
    seen = [_one_socket(look, cell, scheme) for look in looks.sockets]
    mean, disagreement = average([one.total for one in seen])
    if disagreement > _MAX_DISAGREEMENT:
        raise SocketImplausible(f"{len(seen)} looks, reduced chi square {disagreement:.0f}")
    # The looks weigh nearly the same. Only what is drawn anew with every look gets less.
    shared = {Term.HAND_EYE}
    terms = {
        term: np.mean([one.terms[term] for one in seen], axis=0)
        / (1 if term in shared else len(seen))
        for term in seen[0].terms
    }
    return TermedPose(mean.pose, terms)


def _one_socket(look: SocketLook, cell: PlugCell, scheme: Scheme) -> TermedPose:
    mounted = TermedPose.of(Term.HAND_EYE, cell.cam1.pose)
    if scheme.cam1_cancels:
        mounted = TermedPose.exact(mounted.pose)
    seen = TermedPose.of(Term.LOOK_SOCKET, look.camera_T_socket)
    return approach(look.base_T_flange, cell) * mounted * seen


def _absolute(looks: Looks, cell: PlugCell) -> TermedPose:
    camera = TermedPose.of(Term.HAND_EYE, cell.cam2.pose)
    return _from_fixed_camera(looks, cell, camera)


def _golden(looks: Looks, cell: PlugCell) -> TermedPose:
    return _from_fixed_camera(looks, cell, TermedPose.exact(cell.cam2.pose.pose))


def _from_fixed_camera(looks: Looks, cell: PlugCell, base_T_cam2: TermedPose) -> TermedPose:
    seen = TermedPose.of(Term.LOOK_PLUG, looks.plug.camera_T_plug)
    return approach(looks.plug.base_T_flange, cell).inv() * base_T_cam2 * seen


def _reticle(looks: Looks, cell: PlugCell) -> TermedPose:
    """Camera II stands where camera I sees it, by the plate that both see."""
    plate = looks.plate
    if plate is None:
        raise LooksIncomplete("no look of both cameras at the reference plate")
    seen_by_1 = TermedPose.of(Term.LOOK_PLUG, only_plane(plate.cam1_T_plate))
    seen_by_2 = TermedPose.of(Term.LOOK_PLUG, only_plane(plate.cam2_T_plate))
    on_flange = TermedPose.exact(cell.cam1.pose.pose)
    base_T_plate = approach(plate.by_flange_camera.base_T_flange, cell) * on_flange * seen_by_1
    return _from_fixed_camera(looks, cell, base_T_plate * seen_by_2.inv())


def _difference(looks: Looks, cell: PlugCell) -> TermedPose:
    """Marks and plug in one picture: neither the robot's place nor the camera's enters."""
    marks = looks.plug.camera_T_marks
    if marks is None:
        raise LooksIncomplete("no gripper marks in the picture of the plug")
    cam2_T_marks = TermedPose.of(Term.LOOK_PLUG, only_plane(marks))
    cam2_T_plug = TermedPose.of(Term.LOOK_PLUG, looks.plug.camera_T_plug)
    return TermedPose.exact(cell.flange_T_marks) * cam2_T_marks.inv() * cam2_T_plug


DIFFERENCE = Scheme(
    "difference",
    _difference,
    taught=True,
    cam1_cancels=True,
    kinematic_share=0.005,
    arm_drifts=False,
)
ABSOLUTE = Scheme(
    "absolute",
    _absolute,
    taught=False,
    cam1_cancels=False,
    kinematic_share=0.12,
    arm_drifts=True,
)
GOLDEN = Scheme(
    "golden",
    _golden,
    taught=True,
    cam1_cancels=True,
    kinematic_share=0.005,
    arm_drifts=True,
)
RETICLE = Scheme(
    "reticle",
    _reticle,
    taught=False,
    cam1_cancels=True,
    kinematic_share=0.077,
    arm_drifts=False,
)

SCHEMES: Mapping[str, Scheme] = {
    scheme.name: scheme for scheme in (DIFFERENCE, ABSOLUTE, GOLDEN, RETICLE)
}
"""All schemes by their names; the first is the default."""


def constant_errors(scheme: Scheme, cell: PlugCell, distance_m: float) -> Mapping[Term, Array]:
    """Covariances, in the axes of the socket, of what no look and no calibration carries.

    ``distance_m`` is from the socket to the taught slot; 0 without a correction.
    """
    share = scheme.kinematic_share + _KINEMATIC_PER_M * distance_m
    # Each of the two cameras has drifted by itself.
    drift_m = cell.cameras.drift_m * np.sqrt(2)
    if scheme.arm_drifts:
        drift_m = float(np.hypot(drift_m, cell.arm.drift_m))
    terms = {
        Term.KINEMATICS: isotropic(share * cell.arm.absolute_error_m, 0.0),
        Term.DRIFT: isotropic(drift_m, cell.cameras.drift_rad),
    }
    if not scheme.taught:
        # Constant in every look, so a taught correction contains it.
        terms[Term.LOOK_SOCKET] = isotropic(cell.cameras.feature_bias_m, 0.0)
        terms[Term.LOOK_PLUG] = isotropic(cell.cameras.feature_bias_m, 0.0)
    return terms


_KINEMATIC_PER_M = 0.165
"""Growth of that share with the distance from the taught slot: simulated arms of 0.26 and 0.82 mm
mean error agree on it within 5 % (9 and 26 µm per axis at 200 mm)."""
