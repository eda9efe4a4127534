"""Reads and checks everything that a run needs before anything moves."""

import asyncio
from dataclasses import dataclass

import numpy as np

from cellctl.calibration.solvers.hand_eye.hand_eye_result import HandEyeResult
from cellctl.calibration.store.kind import CalibrationKind, Kinds
from cellctl.calibration.store.snapshot import CalibrationSnapshot
from cellctl.calibration.store.store import CalibrationStore
from cellctl.cell.readiness import require_full_speed
from cellctl.clock import utc_now
from cellctl.errors.calibration import CalibrationMissing
from cellctl.geometry.pose import MM, pose_from_xyzabc
from cellctl.processes.antenna_module.calibrations import (
    CAMERA_1_INTRINSICS,
    CAMERA_2_INTRINSICS,
    FIXED_CAMERA,
    FLANGE_CAMERA,
    PLUG_CORRECTION,
    REFERENCE,
)
from cellctl.processes.antenna_module.chain.cell_figures import (
    RP_OVER_SIGMA,
    ArmFigures,
    CameraFigures,
    DrawingIdentities,
    MountedCamera,
    PlugCell,
)
from cellctl.processes.antenna_module.chain.reference.taught_reference import TaughtReference
from cellctl.processes.antenna_module.chain.schemes import SCHEMES, Scheme
from cellctl.processes.antenna_module.chain.teaching.made_with import MadeWith, ReferenceMadeWith
from cellctl.processes.antenna_module.chain.teaching.taught import PlugCorrection
from cellctl.processes.antenna_module.drawings import Drawings, Plate, read_drawings, read_plate
from cellctl.processes.antenna_module.faults.plugging import (
    CalibrationsDoNotBelongTogether,
    LooksIncomplete,
)
from cellctl.processes.antenna_module.recipe import AntennaRecipe
from cellctl.processes.antenna_module.settings import AntennaSettings
from cellctl.processes.antenna_module.stations import AntennaCell
from cellctl.runtime.jobs.factory import PLANNED
from cellctl.vision.camera.single_camera import SingleCamera


@dataclass(frozen=True, slots=True, eq=False)
class PluggingFacts:
    """Recipe, calibrations and drawings of one run."""

    cell: AntennaCell
    recipe: AntennaRecipe
    calibrations: CalibrationSnapshot
    """Everything that counts in the run, as it lies on disk."""
    camera_1: SingleCamera
    camera_2: SingleCamera
    plug_cell: PlugCell
    scheme: Scheme
    correction: PlugCorrection | None
    """What was taught for this recipe; None for a scheme that does without."""
    drawings: Drawings
    plate: Plate | None
    """The calibrated plate; None in a cell without one."""
    reference: TaughtReference | None
    """The taught reference; None in a cell without a plate, and while it is being taught."""

    @property
    def required_plate(self) -> Plate:
        """The plate, for those who look at it; raises ``LooksIncomplete`` in a cell without one."""
        if self.plate is None:
            raise LooksIncomplete("this cell has no reference plate")
        return self.plate


async def read_facts(
    cell: AntennaCell,
    recipe: AntennaRecipe,
    store: CalibrationStore,
    kinds: Kinds,
    *,
    teaching: bool = False,
) -> PluggingFacts:
    """Read and check everything; ``kinds`` are the calibrations that count in the run.

    ``teaching``: correction and reference are not needed, one of them is about to be made. Raises
    the faults of calibrations and drawings, ``CalibrationsDoNotBelongTogether``, and
    ``SpeedOverridden``.
    """
    require_full_speed(cell.arm.robot)
    kinds = [kind.for_recipe(recipe.id) for kind in kinds]
    # Looked at ahead of time, so that no calibration expires in the middle of the run.
    snapshot = await asyncio.to_thread(store.read_all, kinds, utc_now() + PLANNED)
    await _require_same_cameras(cell, snapshot, kinds)
    scheme = SCHEMES[recipe.scheme]
    kind = PLUG_CORRECTION.for_recipe(recipe.id)
    correction = snapshot.find(kind) if scheme.taught else None
    if scheme.taught and correction is None and not teaching:
        raise CalibrationMissing(f"{kind.name}: the scheme {scheme.name} needs taught plugs")
    drawings = read_drawings(recipe, cell.cell.folder)
    section = cell.settings.reference
    plate = None if section is None else read_plate(section, cell.cell.folder)
    plug_cell = plug_cell_of(snapshot, cell.settings, recipe, drawings, plate)
    if correction is not None and not teaching:
        # Now and not only when it is planned: by then a module hangs in the gripper.
        plug, socket = drawings.plug.name, drawings.socket.name
        correction.made_with.require(MadeWith.of(scheme.name, plug_cell, plug, socket))
    return PluggingFacts(
        cell=cell,
        recipe=recipe,
        calibrations=snapshot,
        camera_1=snapshot.get(CAMERA_1_INTRINSICS).camera,
        camera_2=snapshot.get(CAMERA_2_INTRINSICS).camera,
        plug_cell=plug_cell,
        scheme=scheme,
        correction=correction,
        drawings=drawings,
        plate=plate,
        reference=None if plate is None or teaching else _reference(snapshot, plug_cell),
    )


def _reference(snapshot: CalibrationSnapshot, plug_cell: PlugCell) -> TaughtReference:
    """Raises ``CalibrationMissing`` or ``CalibrationsDoNotBelongTogether``."""
    reference = snapshot.find(REFERENCE)
    if reference is None:
        raise CalibrationMissing(f"{REFERENCE.name}: none that is valid, procedure 205 teaches it")
    reference.made_with.require(ReferenceMadeWith.of(plug_cell))
    return reference


def plug_cell_of(
    snapshot: CalibrationSnapshot,
    settings: AntennaSettings,
    recipe: AntennaRecipe,
    drawings: Drawings,
    plate: Plate | None,
) -> PlugCell:
    """What the chain works with; raises ``CalibrationsDoNotBelongTogether``."""
    arm, cameras = settings.arm, settings.cameras
    return PlugCell(
        cam1=_mounted(snapshot, FLANGE_CAMERA, snapshot.get(CAMERA_1_INTRINSICS).camera),
        cam2=_mounted(snapshot, FIXED_CAMERA, snapshot.get(CAMERA_2_INTRINSICS).camera),
        arm=ArmFigures(
            repeatability_m=arm.rp_mm / RP_OVER_SIGMA * MM,
            repeatability_rad=float(np.radians(arm.rp_deg)),
            absolute_error_m=arm.absolute_error_mm * MM,
            drift_m=arm.drift_mm * MM,
        ),
        cameras=CameraFigures(
            cameras.feature_bias_mm * MM,
            cameras.drift_mm * MM,
            float(np.radians(cameras.drift_deg)),
        ),
        gripper=drawings.gripper.name,
        flange_T_marks=pose_from_xyzabc(recipe.flange_T_marks),
        drawings=DrawingIdentities(
            plug=drawings.plug.places_id,
            socket=drawings.socket.places_id,
            gripper=drawings.gripper.places_id,
            plate_above="" if plate is None else plate.above.places_id,
            plate_below="" if plate is None else plate.below.places_id,
        ),
    )


def _mounted(
    snapshot: CalibrationSnapshot, kind: CalibrationKind[HandEyeResult], camera: SingleCamera
) -> MountedCamera:
    """Hand-eye calibration and intrinsics, which must have been made with one another."""
    result = snapshot.get(kind)
    if result.camera_id != camera.id:
        raise CalibrationsDoNotBelongTogether(
            f"{kind.name} was made with intrinsics {(result.camera_id or 'unknown')[:12]}, "
            f"those in use are {camera.id[:12]}"
        )
    return MountedCamera(snapshot.ids[kind.name], camera.id, result.camera)


async def _require_same_cameras(
    cell: AntennaCell, snapshot: CalibrationSnapshot, kinds: Kinds
) -> None:
    """Raise when a camera was exchanged since its calibration."""
    # Asked of the devices: an exchanged camera answers with its own number whatever the file says.
    serial_numbers = {
        CAMERA_1_INTRINSICS.name: await cell.camera_1.serial_number(),
        CAMERA_2_INTRINSICS.name: await cell.camera_2.serial_number(),
    }
    for kind in kinds:
        if kind.name in serial_numbers:
            snapshot.require_instrument(kind, serial_numbers[kind.name])
