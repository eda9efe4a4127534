"""Writes down what the steps of one run find out."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import RigidTransform

from cellctl.clock import utc_at
from cellctl.errors import CellError
from cellctl.force.contact.curve import ForceCurve, curve_statistics
from cellctl.geometry.pose import Array, pose_to_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.interfaces.stereo_camera import Image
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.result import MatingProgress, MatingResult
from cellctl.processes.deck_to_frame.mating.settings import MatingSettings
from cellctl.processes.deck_to_frame.poses.part_measurer import PartMeasurement, SeenPair
from cellctl.processes.deck_to_frame.poses.pose_correction import Judgement, Thresholds
from cellctl.processes.deck_to_frame.poses.seat_error import SeatError
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record.entries import (
    error_figures,
    gauge_holes,
    loop_pass,
    measurement_detail,
    residual_figure,
    rms_um,
    seat_limits_of,
    seat_record,
)
from cellctl.processes.deck_to_frame.record.failed_picture import (
    Expected,
    as_jpeg,
    draw_failed,
)
from cellctl.processes.deck_to_frame.record.keys import (
    BASE,
    DECK,
    FAILED,
    FLANGE,
    FLANGE_T_DECK,
    FORCE_WHILE_VERIFIED,
    FRAME,
    HEAD_1,
    LOOP,
    MATING,
    MEASURED_FROM,
    PEAK_FORCE,
)
from cellctl.processes.deck_to_frame.record.mating_record import (
    peaks_record,
    plan_record,
    result_limits,
    result_record,
)
from cellctl.processes.deck_to_frame.record.sources import (
    exposures,
    failed_from,
    measured_from,
    raw_images,
    rims,
    seen_exposures,
    seen_images,
    seen_taken,
    taken,
)
from cellctl.records.entered.gauges import GAUGE_HOLES
from cellctl.records.entries import Document, PoseOrigin, RecordedPose
from cellctl.records.figures import Limit, figure, split_document
from cellctl.records.files.curve_file import encode_curve
from cellctl.records.files.mcap_reading import MEDIA_TYPE
from cellctl.records.looks import documents_of_look
from cellctl.records.run_recorder import RunRecorder
from cellctl.vision.features.hole import Hole
from cellctl.vision.measurement import PairMeasurement, Side
from cellctl.vision.picture import annotate
from cellctl.workers import VisionWorkers


@dataclass(slots=True)
class DeckRecorder:
    """Puts what the steps of one run find out into the terms of the record."""

    recorder: RunRecorder
    workers: VisionWorkers
    curves: list[ForceCurve] = field(default_factory=list)
    iterations: int = 0
    """Passes of the measure-correct loop so far."""
    _settings: MatingSettings | None = None
    """Settings of the mating that was planned last."""
    _kept: int = 0
    _names: Counter[str] = field(default_factory=Counter)

    @property
    def run(self) -> int:
        """Number of the run."""
        return self.recorder.run

    async def measurement(self, kind: str, measured: PartMeasurement) -> None:
        """A measured part with its pictures, and where the main robot said it was meanwhile."""
        await self.recorder.measurement(
            kind,
            HEAD_1,
            FRAME if kind == FRAME else DECK,
            measured.pose.pose,
            residual_um=rms_um(measured),
            frames=measured.frames,
            detail=measurement_detail(measured),
        )
        await self.recorder.add(residual_figure(kind, measured))
        await self._reported(kind, measured)
        await self._images(kind, measured)

    async def failed_measurement(
        self,
        part: str,
        predicted: RigidTransform,
        seen: Sequence[SeenPair],
        fault: CellError,
        expected: Expected,
    ) -> None:
        """The images of a measurement that ended with a fault, and the last of each head as
        pictures; of one without any, nothing."""
        if not seen:
            return
        name = self._new_name(f"{FAILED}-{part}")
        images = seen_images(name, seen)
        source = failed_from(part, predicted, fault, list(images))
        await self.recorder.document(MEASURED_FROM, {name: source})
        await self.recorder.exposures(seen_exposures(name, seen))
        await self.recorder.add(*documents_of_look(name, seen_taken(name, seen), {}))
        for file, image in images.items():
            self.recorder.raw_image(file, image)
        last = {one.head: one for one in seen}
        for head, one in sorted(last.items()):
            images_of: tuple[tuple[Side, Image], ...] = (
                ("left", one.pair.left),
                ("right", one.pair.right),
            )
            for side, image in images_of:
                rims_there = expected[head, side]
                data = await self.workers.run(
                    draw_failed, image, rims_there, one.found, side, fault.number
                )
                await self.recorder.artefact(f"{name}-head-{head}-{side}.jpg", data, "image/jpeg")

    async def deck_on_flange(self, flange_T_deck: UncertainPose) -> None:
        """The deck's pose on the flange (eq. 4)."""
        await self.recorder.measurement(FLANGE_T_DECK, FLANGE, DECK, flange_T_deck)

    async def commanded(self, base_T_flange: RigidTransform) -> None:
        """Record where the main robot is sent to bring the deck to its target."""
        await self.recorder.pose("target", PoseOrigin.COMMANDED, BASE, FLANGE, base_T_flange)

    async def arrived(self, commanded: RigidTransform, reported: RigidTransform) -> None:
        """A move of the main robot over the station: where it was sent, where it says it is."""
        six = [[float(value) for value in pose_to_xyzabc(pose)] for pose in (commanded, reported)]
        detail = {"commanded_mm_deg": six[0]}
        pose = RecordedPose(
            "arrived", PoseOrigin.REPORTED, BASE, FLANGE, tuple(six[1]), detail=detail
        )
        await self.recorder.add(pose)

    async def iteration(
        self,
        number: int,
        judgement: Judgement,
        thresholds: Thresholds,
        measured: PartMeasurement,
        correction: Array | None,
    ) -> None:
        """One pass of the loop; the correction that will follow, if one will."""
        entry = loop_pass(number, judgement, thresholds, measured, correction)
        residual = residual_figure(LOOP, measured)
        await self.recorder.add(entry, *error_figures(entry), residual)
        # Only after the pass is in the record, so that a number is never used for a pass that
        # nobody can look up.
        self.iterations = number
        await self._reported(f"iteration-{number}", measured)
        await self._images(f"iteration-{number}", measured)

    async def verification(
        self,
        seat: SeatError,
        recipe: DeckRecipe,
        measured: PartMeasurement,
        force_n: float,
    ) -> None:
        """The seated deck: error against the seat, gap, rotation, offset at each pin hole, and the
        greatest force on it while it was measured."""
        await self.measurement("seated", measured)
        await self._document(
            {**seat_record(seat, recipe), f"{FORCE_WHILE_VERIFIED}_n": force_n},
            {
                **seat_limits_of(seat, recipe),
                FORCE_WHILE_VERIFIED: Limit(upper=recipe.mating.limit_force_n),
            },
        )

    async def gauge_holes(self, pins: Iterable[Hole], recipe: DeckRecipe) -> None:
        """The holes that a person may gauge, with the gauge that a good part lets through."""
        await self.recorder.document(GAUGE_HOLES, gauge_holes(pins, recipe))

    async def mating_plan(self, plan: MatingPlan) -> None:
        """What was derived before the approach."""
        self._settings = plan.settings
        await self._document(plan_record(plan))

    async def mating_result(self, result: MatingResult) -> None:
        """How the mating went."""
        limits = result_limits(self._settings) if self._settings else {}
        await self._document(result_record(result), limits)

    def mating_progress(self, progress: MatingProgress) -> None:
        """Collects the curve of each attempt; called from within the mating."""
        if progress.curve is not None:
            self.curves.append(progress.curve)

    def force_peaks(self) -> tuple[float, ...]:
        """Greatest magnitude of each component over all attempts; NaN before the first."""
        if not any(len(curve.wrench) for curve in self.curves):
            return (float("nan"),) * 6
        wrenches = np.concatenate([curve.wrench for curve in self.curves])
        return tuple(float(value) for value in np.abs(wrenches).max(axis=0))

    async def peak_of_a_cut_contact(self, limit_n: float) -> None:
        """How hard a contact has pressed that came to no result, which would say it."""
        curve = self.curves[-1] if self.curves else None
        if curve is not None and len(curve.wrench) > 1 and self._settings is not None:
            peaks = peaks_record(curve_statistics(curve.time_s, curve.wrench))
            await self._document(peaks, result_limits(self._settings))
        # Of all attempts, in place of that of the last one alone.
        if math.isfinite(peak_n := self.force_peaks()[2]):
            await self.recorder.add(figure(PEAK_FORCE, peak_n, "N", limit=Limit(upper=limit_n)))

    async def force_curves(self) -> None:
        """Keep the curve of every attempt, also of one that failed."""
        while self._kept < len(self.curves):
            curve = self.curves[self._kept]
            # Counted before it is written: a curve that the disk has refused is not tried again
            # when the next one is kept.
            self._kept += 1
            if len(curve.time_s):
                facts = {"attempt": str(self._kept)}
                begun = utc_at(float(curve.time_s[0]))
                # In a worker: compressing a curve of a minute would hold the interpreter lock,
                # which the event loop needs for its heartbeats.
                data = await self.workers.run(encode_curve, curve, begun, facts)
                await self.recorder.artefact(f"force-{self._kept}.mcap", data, MEDIA_TYPE)

    async def _images(self, kind: str, measured: PartMeasurement) -> None:
        name = self._new_name(kind)
        predicted = measured.predicted
        if predicted is not None:
            images = raw_images(name, measured.shots)
            # The document names the images before they are written: an image that is late or lost
            # shows as missing in a replay.
            source = measured_from(kind, measured, predicted, list(images))
            await self.recorder.document(MEASURED_FROM, {name: source})
            await self.recorder.exposures(exposures(name, measured.shots))
            images_taken = taken(name, measured.shots)
            await self.recorder.add(*documents_of_look(name, images_taken, rims(measured)))
            for file, image in images.items():
                self.recorder.raw_image(file, image)
        await self._pictures(name, measured)

    def _new_name(self, kind: str) -> str:
        """A kind that comes again, after a Hold, gets a number: no picture hides another."""
        self._names[kind] += 1
        return kind if self._names[kind] == 1 else f"{kind}-again-{self._names[kind]}"

    async def _pictures(self, kind: str, measured: PartMeasurement) -> None:
        for head, (pair, found) in enumerate(zip(measured.pairs, measured.heads, strict=True), 1):
            for side, image in (("left", pair.left), ("right", pair.right)):
                data = await self.workers.run(draw, image, found, side)
                await self.recorder.artefact(f"{kind}-head-{head}-{side}.jpg", data, "image/jpeg")

    async def _reported(self, key: str, measured: PartMeasurement) -> None:
        await self.recorder.pose(key, PoseOrigin.REPORTED, BASE, FLANGE, measured.base_T_flange)

    async def _document(
        self, document: Mapping[str, Any], limits: Mapping[str, Limit] | None = None
    ) -> None:
        """Figures of the mating, and what is no number beside them."""
        figures, rest = split_document(document, limits)
        # A plan and its result come at different times: what a later document does not repeat
        # stays, which is why empty ones need not be written.
        documents = [Document(MATING, rest)] if rest else []
        await self.recorder.add(*figures, *documents)


def draw(image: NDArray[np.uint8], found: PairMeasurement, side: str) -> bytes:
    """Annotated picture as JPEG; runs in a vision worker."""
    return as_jpeg(annotate(image, found, "left" if side == "left" else "right"))
