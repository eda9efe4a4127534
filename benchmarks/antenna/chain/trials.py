"""Teaching and plugging in a drawn cell, by every scheme with the same looks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import RigidTransform, Rotation

from benchmarks.antenna.chain.arms import DrawnArm, Grade
from benchmarks.antenna.chain.drawn_cell import (
    BIAS_M,
    CONTACT_PX,
    FLANGE_T_MARKS,
    FLANGE_T_PLUG,
    MARKS_M,
    PLATE_M,
    PLUG_STATION,
    SOCKET,
    DrawnCell,
    base_T_flange_over_socket,
    small,
)
from benchmarks.antenna.chain.optics import Sight
from cellctl.geometry.pose import Array, pose_error
from cellctl.processes.antenna_module.chain.cell_figures import (
    ArmFigures,
    CameraFigures,
    MountedCamera,
    PlugCell,
)
from cellctl.processes.antenna_module.chain.compose import correction_of, target_pose
from cellctl.processes.antenna_module.chain.looks import (
    Look,
    Looks,
    PlateLook,
    PlugLook,
    SocketLook,
)
from cellctl.processes.antenna_module.chain.plan import ContactPattern, compose_plan
from cellctl.processes.antenna_module.chain.schemes import Scheme
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection
from cellctl.processes.antenna_module.chain.teaching.teaching import (
    TaughtPlug,
    TeachLimits,
    teach_plug,
)

PITCH_M = 1.27e-3
_ROWS = [(i - 3.5, 0.5) for i in range(8)] + [(i - 3.0, -0.5) for i in range(7)]
CONTACTS_M = np.array([[x * PITCH_M, y * PITCH_M, 0.0] for x, y in _ROWS])
"""Micro-D, 8 and 7 contacts."""
PATTERN = ContactPattern(tuple(str(n + 1) for n in range(15)), CONTACTS_M[:, :2])
GAUGE_M, GAUGE_DEG = 5e-6, 0.01
DRIFT_OF_ARM_M_PER_K = 8e-6


@dataclass(frozen=True, slots=True)
class Conditions:
    """What is varied from row to row of the table."""

    teachings: int = 4
    socket_looks: int = 1
    kelvin: float = 0.0
    slot_m: float = 0.0
    """Distance from the taught slot to the one that is plugged."""


@dataclass(frozen=True, slots=True, eq=False)
class Situation:
    """One module in the gripper, and the socket that it is for: the truth, and the looks."""

    looks: Looks
    flange_T_plug: RigidTransform
    base_T_socket: RigidTransform


@dataclass(frozen=True, slots=True, eq=False)
class CellResult:
    """What came out in one cell, by scheme."""

    errors: Mapping[str, Array]
    """Shape (n, 3), see ``Bench.plug_error``."""
    predicted_p99_m: Mapping[str, float]
    """Error of one plug, from the propagated covariance."""


def believed_cell(cell: DrawnCell, grade: Grade, kelvin: float) -> PlugCell:
    """What a commissioning engineer would state of this cell."""
    noise = cell.arm.repeatability
    return PlugCell(
        cam1=MountedCamera("hand-eye 1", "camera 1", cell.flange_T_cam1),
        cam2=MountedCamera("hand-eye 2", "camera 2", cell.base_T_cam2),
        arm=ArmFigures(
            noise.position_m,
            noise.rotation_rad,
            grade.absolute_error_m,
            DRIFT_OF_ARM_M_PER_K * kelvin,
        ),
        cameras=CameraFigures(BIAS_M, 4e-6 * (kelvin > 0), float(np.radians(0.001)) * (kelvin > 0)),
        gripper=f"gripper, {grade.name}",
        flange_T_marks=FLANGE_T_MARKS,
    )


def look_at_both(
    cell: DrawnCell, rng: np.random.Generator, *, looks: int = 1, slot_m: float = 0.0
) -> Situation:
    """A module gripped within ± 1 mm and ± 1°, a socket within ± 1 mm and ± 0.5°."""
    flange_T_plug = FLANGE_T_PLUG * _placed(rng, 1.0)
    shift = RigidTransform.from_translation([0.0, slot_m, 0.0])
    base_T_socket = shift * SOCKET * _placed(rng, 0.5)
    plug = _see_plug(cell, flange_T_plug, rng)
    sockets = tuple(_see_socket(cell, base_T_socket, shift, rng) for _ in range(looks))
    return Situation(Looks(plug, sockets, _see_plate(cell, rng)), flange_T_plug, base_T_socket)


@dataclass(frozen=True, slots=True, eq=False)
class Bench:
    """One cell, what is believed of it, and the chance that acts on it."""

    cell: DrawnCell
    believed: PlugCell
    rng: np.random.Generator

    def teach(self, scheme: Scheme, situations: Sequence[Situation]) -> PlugCorrection:
        """Plug by hand as often as there are situations, each as exact as the gauge."""
        plugs = []
        for number, situation in enumerate(situations):
            plugged = situation.base_T_socket * small(self.rng, GAUGE_M, GAUGE_DEG)
            place = plugged * situation.flange_T_plug.inv()
            reported = self.cell.arm.reported(place, self.rng)
            plugs.append(TaughtPlug(f"plug {number + 1}", situation.looks, reported))
        # Wide limits: a row of the table shows what a scheme does, also where it scatters.
        limits = TeachLimits(len(plugs), 1.0, 1.0)
        return teach_plug({"slot": plugs}, self.believed, scheme, limits=limits)

    def plug_error(
        self, scheme: Scheme, situation: Situation, correction: PlugCorrection | None
    ) -> Array:
        """x, y (m) and yaw (rad) of plug in socket after the last approach, shape (3,)."""
        slot = None if correction is None else correction.slots[0]
        target = target_pose(situation.looks, self.believed, scheme, correction_of(slot), 0.0)
        place = self.cell.arm.place(target.pose, self.rng)
        socket_T_plug = situation.base_T_socket.inv() * place * situation.flange_T_plug
        shift, turn = pose_error(RigidTransform.identity(), socket_T_plug)
        return np.array([shift[0], shift[1], turn[2]])

    def run(self, schemes: Sequence[Scheme], conditions: Conditions, plugs: int) -> CellResult:
        """Teach cold, warm up, plug."""
        looks = conditions.socket_looks
        taught = [
            look_at_both(self.cell, self.rng, looks=looks) for _ in range(conditions.teachings)
        ]
        warm = replace(self, cell=self.cell.warmed(self.rng, conditions.kelvin))
        situations = [
            look_at_both(warm.cell, self.rng, looks=looks, slot_m=conditions.slot_m)
            for _ in range(plugs)
        ]
        errors, predicted = {}, {}
        luck = int(self.rng.integers(2**62))
        for scheme in schemes:
            # The same chance for every scheme, so that rows and schemes differ in nothing else.
            rng = np.random.default_rng(luck)
            cold, hot = replace(self, rng=rng), replace(warm, rng=rng)
            correction = cold.teach(scheme, taught) if scheme.taught else None
            each = [hot.plug_error(scheme, one, correction) for one in situations]
            errors[scheme.name] = np.array(each)
            plan = compose_plan(situations[0].looks, self.believed, scheme, PATTERN, correction)
            predicted[scheme.name] = plan.worst.p99_m
        return CellResult(errors, predicted)


def _placed(rng: np.random.Generator, yaw_deg: float) -> RigidTransform:
    x, y = rng.uniform(-1e-3, 1e-3, 2)
    tilt = rng.normal(0, 0.1, 2)
    turn = Rotation.from_euler("xyz", [*tilt, rng.uniform(-yaw_deg, yaw_deg)], degrees=True)
    return RigidTransform.from_components([x, y, rng.normal(0, 1e-4)], turn)


def _see_plug(cell: DrawnCell, flange_T_plug: RigidTransform, rng: np.random.Generator) -> PlugLook:
    commanded = PLUG_STATION * FLANGE_T_PLUG.inv()
    cam2_T_flange = cell.mounting.base_T_cam2.inv() * cell.arm.place(commanded, rng)
    optics, plane = cell.optics2, cell.cam2_T_plane
    cam2_T_plug, cam2_T_marks = (
        optics.look(Sight(cam2_T_flange * on_flange, points, plane(error), CONTACT_PX), rng)
        for on_flange, points, error in (
            (flange_T_plug, CONTACTS_M, 0),
            (cell.mounting.flange_T_marks, MARKS_M, 2),
        )
    )
    common = _common(cell.arm, commanded, "camera 2")
    return PlugLook(*common, cam2_T_plug, cam2_T_marks, "micro-d-15 pins")


def _see_socket(
    cell: DrawnCell, base_T_socket: RigidTransform, shift: RigidTransform, rng: np.random.Generator
) -> SocketLook:
    commanded = shift * base_T_flange_over_socket()
    base_T_cam1 = cell.arm.place(commanded, rng) * cell.mounting.flange_T_cam1
    cam1_T_socket = base_T_cam1.inv() * base_T_socket
    seen = cell.optics1.look(Sight(cam1_T_socket, CONTACTS_M, cell.cam1_T_plane, CONTACT_PX), rng)
    return SocketLook(*_common(cell.arm, commanded, "camera 1"), seen, "micro-d-15 holes")


def _see_plate(cell: DrawnCell, rng: np.random.Generator) -> PlateLook:
    # The same offset from the plug's place as camera I has from the socket's: what the arm's error
    # does over this distance then happens twice and drops out.
    commanded = PLUG_STATION * SOCKET.inv() * base_T_flange_over_socket()
    base_T_cam1 = cell.arm.place(commanded, rng) * cell.mounting.flange_T_cam1
    plate = cell.mounting.base_T_plate
    cam1_T_plate, cam2_T_plate = (
        base_T_camera.inv() * plate for base_T_camera in (base_T_cam1, cell.mounting.base_T_cam2)
    )
    by_1 = cell.optics1.look(Sight(cam1_T_plate, PLATE_M, cell.cam1_T_plane, CONTACT_PX), rng)
    by_2 = cell.optics2.look(Sight(cam2_T_plate, PLATE_M, cell.cam2_T_plane(), CONTACT_PX), rng)
    return PlateLook(Look(*_common(cell.arm, commanded, "camera 1")), by_1, by_2, "camera 2")


def _common(
    arm: DrawnArm, commanded: RigidTransform, camera: str
) -> tuple[RigidTransform, Array, float, str]:
    return commanded, arm.joints(commanded), 0.0, camera
