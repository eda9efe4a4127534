"""Computes an assembly again from its record: measurements, passes, seat and force peaks."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl.calibration.store.snapshot import CalibrationSnapshot
from cellctl.errors.records.store import NotReplayable
from cellctl.errors.vision import OF_AN_IMAGE, HoleAmbiguous, HoleMissing, VisionError
from cellctl.force.contact.curve import curve_statistics
from cellctl.geometry.pose import MM, pose_from_xyzabc, pose_to_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.geometry.units import in_mm_deg
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.deck_to_frame.calibrations import CALIBRATIONS
from cellctl.processes.deck_to_frame.poses.deck_on_flange import deck_on_flange
from cellctl.processes.deck_to_frame.poses.geometry import CalibrationSet
from cellctl.processes.deck_to_frame.poses.part_measurer import (
    HeadGeometry,
    combined,
    deck_in_frame,
)
from cellctl.processes.deck_to_frame.poses.pose_correction import (
    assembly_error,
    target_M_T_D,
)
from cellctl.processes.deck_to_frame.poses.seat_error import seat_error
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record.entries import seat_record
from cellctl.processes.deck_to_frame.record.keys import (
    COMPONENTS,
    FAILED,
    FLANGE_T_DECK,
    FRAME,
    MEASURED_FROM,
)
from cellctl.processes.deck_to_frame.record.sources import IMAGES_PER_FRAME, predicted_pose
from cellctl.records.entries import Calibration, PoseOrigin, RecordedPose, RunRecord
from cellctl.records.figures import split_document
from cellctl.records.files.curve_file import is_curve, read_recording
from cellctl.records.files.raw_images import decode
from cellctl.records.replay.replayed import Replayed, compare
from cellctl.records.report.sections import ReadArtefact
from cellctl.vision.features.feature_file import FeatureFile, parse_features
from cellctl.vision.measure import measure_pair
from cellctl.vision.measurement import Method
from cellctl.vision.registration.part_pose import PartPose

POSE = (("X", "mm"), ("Y", "mm"), ("Z", "mm"), ("A", "°"), ("B", "°"), ("C", "°"))
FORCE_RESOLUTION = 1e-4
"""Force curves are written with four decimals."""
OF_ONE_PAIR = frozenset(fault.number for fault in (*OF_AN_IMAGE, HoleMissing, HoleAmbiguous))
"""Faults that the images of one head lead to by themselves."""
ROUNDING = 1e-9
"""Difference in mm and degrees that counts as rounding: the last digits depend on the number of
threads that compute, and recorded poses are written as angles."""


@dataclass(slots=True)
class Replay:
    """One run; the frame that was measured last counts for what follows."""

    record: RunRecord
    read: ReadArtefact
    recipe: DeckRecipe
    geometry: CalibrationSet
    features: Mapping[str, FeatureFile]
    """Feature files by part."""
    frame: PartPose | None = None
    _images: dict[str, str] = field(default_factory=dict)

    def lines(self) -> Iterator[Replayed]:
        """Compare every number of the run, in the order in which it was measured."""
        for name, source in self.record.document(MEASURED_FROM).items():
            there = {artefact.name for artefact in self.record.artefacts}
            wanted = source["images"]
            found_images = sum(image in there for image in wanted)
            yield Replayed(name, "raw images", "", len(wanted), found_images)
            # Raw images are kept while the run goes on and may be late; a measurement without all
            # of its images cannot come out the same.
            if found_images < len(wanted):
                continue
            if source["key"] == FAILED:
                yield self._fault_again(name, source)
                continue
            pose = self._measure(source)
            c1_T_part = pose.pose.pose
            recorded = RigidTransform.from_matrix(np.array(source["result"], float))
            yield from compare(name, POSE, _six(recorded), _six(c1_T_part), ROUNDING)
            sigmas = np.sqrt(np.diag(np.array(source["covariance"], float)))
            columns = [(f"σ {axis}", unit) for axis, unit in COMPONENTS]
            was, found = in_mm_deg(sigmas), in_mm_deg(pose.pose.sigma)
            yield from compare(name, columns, was.tolist(), found.tolist(), ROUNDING)
            yield from self._derived(name, source["key"], pose)
        yield from self._forces()

    @property
    def _heads(self) -> HeadGeometry:
        return HeadGeometry.of(self.geometry, self.recipe.pose_correction)

    @property
    def _method(self) -> Method:
        return self.recipe.pose_correction.method

    def _measure(self, source: Mapping[str, Any]) -> PartPose:
        features, predicted = self.features[source["part"]], predicted_pose(source)
        method = self._method
        heads = self._heads
        predictions = heads.camera_T_part(predicted)
        taken = []
        for images in self._frames(source["images"]):
            one, two = (
                measure_pair(
                    images[2 * index],
                    images[2 * index + 1],
                    (heads.head_1, heads.head_2)[index],
                    (features.seen_by(1), features.seen_by(2))[index],
                    camera_T_part=predictions[index],
                    method=method,
                )
                for index in (0, 1)
            )
            taken.append((one, two))
        return combined(features, taken, heads, method)[1]

    def _fault_again(self, name: str, source: Mapping[str, Any]) -> Replayed:
        """The fault that the images of a failed measurement lead to today.

        A fault that no image alone leads to is none here either: a head that moved, frames that do
        not suffice, holes of both heads that do not fit together.
        """
        features, heads = self.features[source["part"]], self._heads
        predictions = heads.camera_T_part(predicted_pose(source))
        artefacts = {artefact.name: artefact for artefact in self.record.artefacts}
        images = [decode(self.read(artefacts[file])) for file in source["images"]]
        found = 0
        for index, file in enumerate(source["images"][::2]):
            head = 1 if "-head-1-" in file else 2
            try:
                measure_pair(
                    images[2 * index],
                    images[2 * index + 1],
                    (heads.head_1, heads.head_2)[head - 1],
                    features.seen_by(1 if head == 1 else 2),
                    camera_T_part=predictions[head - 1],
                    method=self._method,
                )
            except VisionError as fault:
                found = fault.number
        was = source["fault"]
        expected = was if found or was in OF_ONE_PAIR else 0
        return Replayed(name, f"fault F{was}", "", expected, found)

    def _frames(self, names: Sequence[str]) -> Iterator[list[Image]]:
        artefacts = {artefact.name: artefact for artefact in self.record.artefacts}
        for begin in range(0, len(names), IMAGES_PER_FRAME):
            frame = names[begin : begin + IMAGES_PER_FRAME]
            yield [decode(self.read(artefacts[name])) for name in frame]

    def _derived(self, name: str, key: str, part: PartPose) -> Iterator[Replayed]:
        """What the run has concluded from a measurement."""
        if key == FRAME:
            self.frame = part
            return
        if key == "deck":
            base_T_flange = UncertainPose.exact(_pose(self._last_pose(key, PoseOrigin.REPORTED)))
            found = deck_on_flange(base_T_flange, self.geometry.base_T_c1, part.pose)
            was = self._last_pose(FLANGE_T_DECK, PoseOrigin.MEASURED).pose_mm_deg
            yield from compare(FLANGE_T_DECK, POSE, was, _six(found.pose), ROUNDING)
            return
        if self.frame is None:
            raise NotReplayable(f"{name} comes before the frame was measured")
        relative = deck_in_frame(self.frame, part, self._heads, self._method)
        thickness_m = self.recipe.deck_thickness_mm * MM
        if key == "seated":
            holes = self.features["deck"].holes
            figures, _ = split_document(
                seat_record(seat_error(relative.cautious, thickness_m, holes), self.recipe)
            )
            for entry in figures:
                yield Replayed(
                    name, entry.key, entry.unit, self.record.value(entry.key), entry.value, ROUNDING
                )
            return
        M_T_D = relative.part_1_T_part_2.pose
        error = assembly_error(target_M_T_D(thickness_m, self.recipe.stand_off_mm * MM), M_T_D)
        for passed in self.record.passes:
            if key == f"iteration-{passed.number}":
                was_error = [component.value for component in passed.components]
                columns = [(f"error {axis}", unit) for axis, unit in COMPONENTS]
                yield from compare(name, columns, was_error, in_mm_deg(error).tolist(), ROUNDING)

    def _last_pose(self, key: str, origin: PoseOrigin) -> RecordedPose:
        found = [pose for pose in self.record.poses if (pose.key, pose.origin) == (key, origin)]
        if not found:
            raise NotReplayable(f"no {origin} pose {key} in the record")
        return found[-1]

    def _forces(self) -> Iterator[Replayed]:
        """Peaks of the last contact, whose figures the record has."""
        curves = [one for one in self.record.artefacts if is_curve(one)]
        if not curves or self.record.value("peak_force") is None:
            return
        curve = read_recording(self.read(curves[-1])).curve
        found = curve_statistics(curve.time_s, curve.wrench)
        for key, unit, value in (
            ("peak_force", "N", found.peak_fz_n),
            ("peak_filtered_force", "N", found.peak_filtered_fz_n),
            ("peak_lateral", "N", found.peak_lateral_n),
            ("peak_moment", "N·m", found.peak_moment_n_m),
        ):
            recorded = self.record.value(key)
            yield Replayed(curves[-1].name, key, unit, recorded, value, FORCE_RESOLUTION)


def replay(
    record: RunRecord, read: ReadArtefact, calibrations: Mapping[str, Calibration]
) -> Iterator[Replayed]:
    """Compute a run anew; ``calibrations`` by their ids.

    Raises ``NotReplayable``, and the faults of vision for an image in which the holes are not found
    any more.
    """
    if not record.document(MEASURED_FROM):
        raise NotReplayable(f"run {record.head.number} has no raw images")
    features = {part: _features(record, read, part) for part in ("frame", "deck")}
    recipe = json.loads(_artefact(record, read, "recipe.json"))["recipe"]
    kinds = {kind.name: kind for kind in CALIBRATIONS}
    results = {}
    for name, identity in record.head.calibration_ids.items():
        if identity not in calibrations:
            raise NotReplayable(f"calibration {name} of this run is not in the store")
        if name in kinds:
            # As it lay in its file: the run store gives tuples in place of lists.
            written = json.loads(json.dumps(calibrations[identity].record))
            results[name] = kinds[name].result(written)
    geometry = CalibrationSet.of(CalibrationSnapshot(results, {}))
    yield from Replay(record, read, DeckRecipe.model_validate(recipe), geometry, features).lines()


def _features(record: RunRecord, read: ReadArtefact, part: str) -> FeatureFile:
    name = f"{part}_features.toml"
    return parse_features(_artefact(record, read, name), name)


def _artefact(record: RunRecord, read: ReadArtefact, name: str) -> bytes:
    for artefact in record.artefacts:
        if artefact.name == name:
            return read(artefact)
    raise NotReplayable(f"{name} is not in the record")


def _six(pose: RigidTransform) -> list[float]:
    return [float(value) for value in pose_to_xyzabc(pose)]


def _pose(entry: RecordedPose) -> RigidTransform:
    return pose_from_xyzabc(np.array(entry.pose_mm_deg, float))
