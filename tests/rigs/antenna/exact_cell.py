"""A cell without errors, of poses that have no symmetry: any wrong order or inverse shows."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.geometry.pose import Array, pose_from_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.processes.antenna_module.chain.cell_figures import (
    ArmFigures,
    CameraFigures,
    MountedCamera,
    PlugCell,
    isotropic,
)
from cellctl.processes.antenna_module.chain.looks import (
    Look,
    Looks,
    PlateLook,
    PlugLook,
    SocketLook,
)
from cellctl.processes.antenna_module.chain.plan import ContactPattern
from cellctl.processes.antenna_module.chain.teaching.teaching import TaughtPlug

JOINTS_RAD = np.radians([10.0, -40.0, 95.0, 5.0, 40.0, 20.0])
FLANGE_T_CAM1 = pose_from_xyzabc([81, 7, -42, 12, -3, 5])
BASE_T_CAM2 = pose_from_xyzabc([460, -260, 70, 33, 4, -6])
FLANGE_T_MARKS = pose_from_xyzabc([14, -9, 190, 20, 178, 3])
BASE_T_PLATE = pose_from_xyzabc([470, -250, 330, 8, 1, -2])
FLANGE_T_PLUG = pose_from_xyzabc([1.2, -0.7, 203, -17, 178, 1])
BASE_T_SOCKET = pose_from_xyzabc([480, 240, 220, 25, 1, -2])
F_PLUG = pose_from_xyzabc([455, -270, 515, 11, 178, -2])
F_SOCKET = pose_from_xyzabc([400, 235, 420, 14, 179, 3])
F_PLATE = pose_from_xyzabc([395, -262, 522, 14, 179, 3])
TARGET = BASE_T_SOCKET * FLANGE_T_PLUG.inv()
"""Where the flange must go."""
SEEN = isotropic(1e-6, 1e-5)
PATTERN = ContactPattern(
    ("left", "right", "top"), np.array([[-4.4e-3, 0.0], [4.4e-3, 0.0], [0.0, 1.3e-3]])
)


def seen(pose: RigidTransform, covariance: Array = SEEN) -> UncertainPose:
    """A measured pose without error."""
    return UncertainPose(pose, covariance)


def cell(**changes: object) -> PlugCell:
    """All calibrations exact."""
    made = PlugCell(
        cam1=MountedCamera("hand-eye 1", "camera 1", seen(FLANGE_T_CAM1)),
        cam2=MountedCamera("hand-eye 2", "camera 2", seen(BASE_T_CAM2)),
        arm=ArmFigures(5.5e-6, 1.7e-5, 0.26e-3, 24e-6),
        cameras=CameraFigures(5e-6, 4e-6, 1.7e-5),
        gripper="gripper 3",
        flange_T_marks=FLANGE_T_MARKS,
    )
    return replace(made, **changes)  # type: ignore[arg-type]


def looks(
    flange_T_plug: RigidTransform = FLANGE_T_PLUG,
    base_T_socket: RigidTransform = BASE_T_SOCKET,
    *,
    sockets: int = 1,
) -> Looks:
    """What the cameras see without error."""
    in_2 = BASE_T_CAM2.inv() * F_PLUG
    plug = PlugLook(
        F_PLUG,
        JOINTS_RAD,
        10.0,
        "camera 2",
        seen(in_2 * flange_T_plug),
        seen(in_2 * FLANGE_T_MARKS),
        "micro-d-15",
    )
    over = [F_SOCKET * pose_from_xyzabc([n, -n, 0, n, 0, 0]) for n in range(sockets)]
    socket_looks = tuple(
        SocketLook(
            flange,
            JOINTS_RAD,
            20.0,
            "camera 1",
            seen((flange * FLANGE_T_CAM1).inv() * base_T_socket),
            "micro-d-15 holes",
        )
        for flange in over
    )
    plate = PlateLook(
        Look(F_PLATE, JOINTS_RAD, 5.0, "camera 1"),
        seen((F_PLATE * FLANGE_T_CAM1).inv() * BASE_T_PLATE),
        seen(BASE_T_CAM2.inv() * BASE_T_PLATE),
        "camera 2",
    )
    return Looks(plug, socket_looks, plate)


def taught_plugs(
    count: int = 4, seated: RigidTransform | None = None, scatter_m: float = 0.0
) -> list[TaughtPlug]:
    """Plugs gripped a little differently, each seated in its socket up to a constant."""
    seated = RigidTransform.identity() if seated is None else seated
    plugs = []
    for n in range(count):
        grip = FLANGE_T_PLUG * pose_from_xyzabc([0.2 * n, -0.1 * n, 0, 0.3 * n, 0, 0])
        socket = BASE_T_SOCKET * pose_from_xyzabc([0.3 * n, 0.1 * n, 0, -0.2 * n, 0, 0])
        beside = RigidTransform.from_translation([scatter_m * (-1) ** n, 0, 0])
        plugged = socket * seated * beside * grip.inv()
        plugs.append(TaughtPlug(f"plug {n}", looks(grip, socket), plugged))
    return plugs


def distance(a: RigidTransform, b: RigidTransform) -> tuple[float, float]:
    """m and rad between two poses."""
    between = a.inv() * b
    return float(np.linalg.norm(between.translation)), float(between.rotation.magnitude())
