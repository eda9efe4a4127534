"""Writes down what the steps of one run find out."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cellctl.clock import utc_now
from cellctl.force.contact.curve import ForceCurve
from cellctl.geometry.pose import MM, Array, pose_to_xyzabc
from cellctl.geometry.uncertain import UncertainPose
from cellctl.geometry.units import in_mm_deg
from cellctl.processes.deck_to_frame.mating.plan import MatingPlan
from cellctl.processes.deck_to_frame.mating.record import plan_record, result_record
from cellctl.processes.deck_to_frame.mating.result import MatingProgress, MatingResult
from cellctl.processes.deck_to_frame.measuring import PartMeasurement
from cellctl.processes.deck_to_frame.pose_correction import Judgement, Thresholds
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.recording import MEDIA_TYPE, encode_curve
from cellctl.records.store import RunStore
from cellctl.vision.measurement import PairMeasurement
from cellctl.vision.picture import annotate
from cellctl.workers import VisionWorkers

JPEG_QUALITY = 85


@dataclass(slots=True)
class Journal:
    """One run's way into the store."""

    archive: AsyncRunStore
    workers: VisionWorkers
    run: int
    curves: list[ForceCurve] = field(default_factory=list)
    iterations: int = 0
    """Passes of the measure-compensate loop so far."""
    _kept: int = 0
    _names: Counter[str] = field(default_factory=Counter)

    async def measurement(self, kind: str, measured: PartMeasurement) -> None:
        """A measured part with its pictures."""
        await self.archive.do(
            RunStore.add_measurement,
            self.run,
            kind,
            pose_mm_deg=pose_to_xyzabc(measured.c1_T_part).tolist(),
            sigma_mm_deg=in_mm_deg(measured.pose.pose.sigma).tolist(),
            residual_um=rms_um(measured),
            frames=measured.frames,
            detail=measurement_detail(measured),
        )
        await self._pictures(kind, measured)

    async def deck_on_flange(self, flange_T_deck: UncertainPose) -> None:
        """The deck's pose on the flange (eq. 4)."""
        await self.archive.do(
            RunStore.add_measurement,
            self.run,
            "flange_T_deck",
            pose_mm_deg=pose_to_xyzabc(flange_T_deck.pose).tolist(),
            sigma_mm_deg=in_mm_deg(flange_T_deck.sigma).tolist(),
            residual_um=0.0,
            frames=0,
        )

    async def iteration(
        self,
        number: int,
        judgement: Judgement,
        thresholds: Thresholds,
        measured: PartMeasurement,
        correction: Array | None,
    ) -> None:
        """One pass of the loop; the correction that will follow, if one will."""
        await self.archive.do(
            RunStore.add_iteration,
            self.run,
            number,
            error_mm_deg=in_mm_deg(judgement.error).tolist(),
            sigma_mm_deg=in_mm_deg(judgement.sigma).tolist(),
            threshold_mm_deg=in_mm_deg(thresholds.vector).tolist(),
            frames=measured.frames,
            residual_um=rms_um(measured),
            converged=judgement.converged,
            correction_mm_deg=() if correction is None else in_mm_deg(correction).tolist(),
        )
        self.iterations = number
        await self._pictures(f"iteration-{number}", measured)

    async def verification(
        self, error: Array, offsets_mm: Mapping[str, float], measured: PartMeasurement
    ) -> None:
        """The seated deck: error against the seat, and the offset at each pin hole."""
        await self.measurement("seated", measured)
        await self.archive.do(
            RunStore.set_mating,
            self.run,
            {
                "seated_error_mm_deg": in_mm_deg(error).tolist(),
                "pin_offsets_mm": dict(offsets_mm),
            },
        )

    async def mating_plan(self, plan: MatingPlan) -> None:
        """What was derived before the approach."""
        await self.archive.do(RunStore.set_mating, self.run, plan_record(plan))

    async def mating_result(self, result: MatingResult) -> None:
        """How the mating went."""
        await self.archive.do(RunStore.set_mating, self.run, result_record(result))

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

    async def force_curves(self) -> None:
        """Keep the curve of every attempt, also of one that failed."""
        while self._kept < len(self.curves):
            curve = self.curves[self._kept]
            self._kept += 1
            if len(curve.time_s):
                facts = {"attempt": str(self._kept)}
                data = await self.workers.run(encode_curve, curve, utc_now(), facts)
                await self._artefact(f"force-{self._kept}.mcap", data, MEDIA_TYPE)

    async def _pictures(self, kind: str, measured: PartMeasurement) -> None:
        """A kind that comes again, after a Hold, gets a number: no picture hides another."""
        self._names[kind] += 1
        if self._names[kind] > 1:
            kind = f"{kind}-again-{self._names[kind]}"
        for head, (pair, found) in enumerate(zip(measured.pairs, measured.heads, strict=True), 1):
            for side, image in (("left", pair.left), ("right", pair.right)):
                data = await self.workers.run(draw, image, found, side)
                await self._artefact(f"{kind}-head-{head}-{side}.jpg", data, "image/jpeg")

    async def _artefact(self, name: str, data: bytes, media_type: str) -> None:
        await self.archive.do(RunStore.add_artefact, self.run, name, data, media_type)


def draw(image: NDArray[np.uint8], found: PairMeasurement, side: str) -> bytes:
    """Annotated picture as JPEG; runs in a vision worker."""
    import cv2

    picture = annotate(image, found, "left" if side == "left" else "right")
    _, data = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY])
    return bytes(data)


def rms_um(measured: PartMeasurement) -> float:
    """Root mean square distance of the holes from their registered places, µm."""
    squares = (measured.pose.residuals_m**2).sum(axis=1)
    return float(np.sqrt(squares.mean()) / MM * 1e3)


def measurement_detail(measured: PartMeasurement) -> dict[str, Any]:
    """Holes and residuals as plain data."""
    return {
        "holes": {
            hole.name: {
                "head": head,
                "position_mm": (hole.position_m / MM).tolist(),
                "sigma_mm": (np.sqrt(np.diag(hole.covariance_m2)) / MM).tolist(),
                "diameter_mm": hole.diameter_m / MM,
                "left_px": hole.left_px.tolist(),
                "right_px": hole.right_px.tolist(),
            }
            for head, pair in enumerate(measured.heads, start=1)
            for hole in pair.holes
        },
        "residuals_mm": {
            name: (residual / MM).tolist()
            for name, residual in zip(measured.pose.names, measured.pose.residuals_m, strict=True)
        },
        "outliers": list(measured.pose.outliers),
        "misfit": asdict(measured.pose.misfit),
    }
