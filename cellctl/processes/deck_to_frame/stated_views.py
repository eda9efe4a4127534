"""What this process measures, for planning where the heads stand."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import cast

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.pose_record import pose_from_record
from cellctl.config.cell import CellConfig
from cellctl.config.stated.moves import StatedPlace
from cellctl.config.stated.views import StatedHead, StatedMeasurement, StatedPart
from cellctl.errors.config import HeadNotDescribed
from cellctl.geometry.pose import MM, Array, pose_from_xyzabc
from cellctl.procedures.stereo_head import flange_poses
from cellctl.processes.deck_to_frame.arms_in_roles import ArmsInRoles
from cellctl.processes.deck_to_frame.checks.plausible.stored import stored_record
from cellctl.processes.deck_to_frame.poses.pose_correction import Thresholds
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record_names import BOARD_TRANSFER_NAME
from cellctl.processes.deck_to_frame.roles import DECK_MEASURE, HEAD_1, HEAD_2, HOME, MEASURING
from cellctl.processes.deck_to_frame.settings import DeckSettings
from cellctl.vision.camera.stereo_head import StereoHead, stereo_head_from_json
from cellctl.vision.features.feature_file import FeatureFile, read_features
from cellctl.vision.features.hole import Hole

ROLES_OF_HEADS = (HEAD_1, HEAD_2)


def deck_measurements(
    cell: CellConfig, recipe: DeckRecipe, folder: Path
) -> Iterator[StatedMeasurement]:
    """Frame and deck from one pose of each head; the pose that counts is that at the stand-off."""
    arms = ArmsInRoles(cell, recipe)
    one, two = (_head(arms, folder, role) for role in ROLES_OF_HEADS)
    settings = recipe.pose_correction
    about = np.radians(settings.thresholds_deg)
    thresholds = Thresholds(settings.threshold_mm * MM, (about[0], about[1], about[2]))
    yield StatedMeasurement(
        f"recipe {recipe.id}, {recipe.name}",
        (one, two),
        tuple(_parts(arms, folder)),
        thresholds.vector,
        thresholds.uncertainty_share,
        _between_heads(cell, recipe, folder),
        settings.heads_sway_mm * MM,
        settings.frames,
        settings.max_frames,
    )


def _parts(arms: ArmsInRoles, folder: Path) -> Iterator[StatedPart]:
    recipe, main = arms.recipe, arms.main
    frame = read_features(folder / recipe.frame_features)
    deck = read_features(folder / recipe.deck_features)
    flange_T_deck = pose_from_xyzabc(recipe.flange_T_deck)
    seat_mm = recipe.deck_thickness_mm

    def part(
        label: str, features: FeatureFile, place: StatedPlace, base_T_part: RigidTransform
    ) -> StatedPart:
        return StatedPart(
            label, main, base_T_part, _seen(arms, features), _further(features), {main: place}
        )

    home, over = arms.taught(main, HOME), arms.taught(main, DECK_MEASURE)
    base_T_frame = pose_from_xyzabc(recipe.base_T_frame)
    yield part("frame", frame, home, base_T_frame)
    yield part(f"deck at {DECK_MEASURE}", deck, over, arms.flange_at(main, over) * flange_T_deck)
    # The verdict on the seat is measured, too; what counts for the loop comes last.
    for label, height_mm in (("seat", seat_mm), ("stand-off", seat_mm + recipe.stand_off_mm)):
        low = RigidTransform.from_translation([0.0, 0.0, height_mm * MM])
        yield part(
            f"deck at the {label}", deck, arms.frame_at(label, height_mm), base_T_frame * low
        )


def _seen(arms: ArmsInRoles, features: FeatureFile) -> Mapping[str, tuple[Hole, ...]]:
    names = [arms.recipe.device(role) for role in ROLES_OF_HEADS]
    return {names[0]: features.seen_by(1), names[1]: features.seen_by(2)}


def _further(features: FeatureFile) -> tuple[Hole, ...]:
    seen = {*features.head_1, *features.head_2}
    return tuple(hole for hole in features.holes if hole.name not in seen)


def _head(arms: ArmsInRoles, folder: Path, role: str) -> StatedHead:
    name = arms.recipe.device(role)
    config = arms.cell.stereo_cameras[name]
    if config.flange_T_camera is None:
        raise HeadNotDescribed(f"stereo_cameras.{name}: flange_T_camera is missing")
    mounted = pose_from_xyzabc(config.flange_T_camera)
    camera = _camera(arms.cell, folder, role)
    settings = cast(DeckSettings, arms.cell.processes[arms.recipe.process])
    # Procedures 101 and 102 tilt the head about its board from there.
    views = flange_poses(RigidTransform.identity(), mounted, settings.stereo_views)
    return StatedHead(name, arms.heads[name], MEASURING, camera, mounted, tuple(views[1:]))


def _camera(cell: CellConfig, folder: Path, role: str) -> StereoHead:
    record = stored_record(cell, folder, role)
    if record is None:
        raise HeadNotDescribed(f"{role}: {folder / cell.calibration_dir} has no calibration of it")
    try:
        return stereo_head_from_json(record)
    except (KeyError, TypeError, ValueError) as error:
        raise HeadNotDescribed(f"{role}: {error}") from error


def _between_heads(cell: CellConfig, recipe: DeckRecipe, folder: Path) -> Array:
    """As certain as the stored board transfer, which another pose needs again, and the drift."""
    settings = recipe.pose_correction
    drift = np.repeat([settings.heads_drift_mm * MM, np.radians(settings.heads_drift_deg)], 3)
    record = stored_record(cell, folder, BOARD_TRANSFER_NAME)
    calibrated = np.zeros((6, 6))
    if record is not None:
        calibrated = pose_from_record(record["c1_T_c2"]).covariance
    return np.asarray(calibrated + np.diag(drift**2))
