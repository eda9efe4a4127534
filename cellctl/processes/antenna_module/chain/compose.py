"""The product of poses that a plan and a teaching share."""

from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.cell_figures import PlugCell
from cellctl.processes.antenna_module.chain.looks import Looks
from cellctl.processes.antenna_module.chain.schemes import (
    Scheme,
    approach,
    base_T_socket,
    constant_errors,
)
from cellctl.processes.antenna_module.chain.teaching.taught import TaughtSlot
from cellctl.processes.antenna_module.chain.termed_pose import Term, TermedPose


def target_pose(
    looks: Looks, cell: PlugCell, scheme: Scheme, correction: TermedPose, distance_m: float
) -> TermedPose:
    """``base_T_flange`` with the plug in its socket: base_T_socket · C · (flange_T_plug)⁻¹."""
    extra = TermedPose(RigidTransform.identity(), constant_errors(scheme, cell, distance_m))
    plug = scheme.flange_T_plug(looks, cell)
    return base_T_socket(looks, cell, scheme) * extra * correction * plug.inv()


def reached_socket_T_plug(
    target: TermedPose, looks: Looks, cell: PlugCell, scheme: Scheme
) -> TermedPose:
    """Where the plug comes to lie in its socket, with one more approach of the robot.

    An error of ``flange_T_plug`` moves the target, and with it the real plug, by itself; so the
    real plug hangs on the target by a pose without error.
    """
    last = approach(RigidTransform.identity(), cell)
    plug = TermedPose.exact(scheme.flange_T_plug(looks, cell).pose)
    socket = TermedPose.exact(base_T_socket(looks, cell, scheme).pose)
    return socket.inv() * target * last * plug


def taught_socket_T_plug(
    looks: Looks, base_T_flange: RigidTransform, play: Array, cell: PlugCell, scheme: Scheme
) -> TermedPose:
    """C of one taught plug: (base_T_socket)⁻¹ · base_T_flange · flange_T_plug.

    ``base_T_flange`` is read while the plug sits in its socket, where the gauge leaves it ``play``
    (6x6 covariance of socket_T_plug).
    """
    socket = base_T_socket(looks, cell, scheme)
    seated = approach(base_T_flange, cell) * scheme.flange_T_plug(looks, cell)
    return socket.inv() * seated * TermedPose(RigidTransform.identity(), {Term.CORRECTION: play})


def correction_of(slot: TaughtSlot | None) -> TermedPose:
    """The taught correction as a factor; the identity without one."""
    if slot is None:
        return TermedPose.exact(RigidTransform.identity())
    return TermedPose.of(Term.CORRECTION, slot.socket_T_plug)
