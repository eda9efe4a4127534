"""Measurements and passes of the loop as entries of the record, in mm, µm and degrees."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from cellctl.geometry.pose import MM, Array
from cellctl.geometry.units import in_mm_deg
from cellctl.processes.deck_to_frame.poses.part_measurer import PartMeasurement
from cellctl.processes.deck_to_frame.poses.pose_correction import Judgement, Thresholds
from cellctl.processes.deck_to_frame.poses.seat_error import SeatError
from cellctl.processes.deck_to_frame.recipe import DeckRecipe
from cellctl.processes.deck_to_frame.record.keys import (
    ANGLE_ERROR,
    COMPONENTS,
    GAP_BY_VISION,
    LOOP,
    PIN_OFFSETS,
    POSITION_ERROR,
    SEAT_ROTATION,
    SEATED_ERROR,
    SEATED_SIGMA,
    UNCERTAINTY,
    WORST_RESIDUAL,
)
from cellctl.processes.deck_to_frame.record.worst_component import expanded, worst_component
from cellctl.records.entries import Figure, LoopPass, PassComponent
from cellctl.records.figures import KNOWN_TO, Limit, figure
from cellctl.vision.features.hole import Hole
from cellctl.vision.registration.chi_square import ChiSquare
from cellctl.vision.registration.part_pose import RESIDUAL_LIMIT_M


def loop_pass(
    number: int,
    judgement: Judgement,
    thresholds: Thresholds,
    measured: PartMeasurement,
    correction: Array | None,
) -> LoopPass:
    """Error, uncertainty, threshold and correction of every component, in mm and degrees."""
    corrections = [None] * 6 if correction is None else in_mm_deg(correction).tolist()
    columns = zip(
        COMPONENTS,
        in_mm_deg(judgement.error).tolist(),
        in_mm_deg(judgement.sigma).tolist(),
        in_mm_deg(thresholds.vector).tolist(),
        corrections,
        strict=True,
    )
    return LoopPass(
        loop=LOOP,
        number=number,
        components=tuple(PassComponent(*head, *values) for head, *values in columns),
        converged=judgement.converged,
        residual_um=rms_um(measured),
        frames=measured.frames,
    )


def error_figures(entry: LoopPass) -> tuple[Figure, ...]:
    """Position and angle about the axis that uses up most of its threshold, and how well they are
    known."""
    return (
        *_worst(POSITION_ERROR, worst_component(entry.components[:3])),
        *_worst(ANGLE_ERROR, worst_component(entry.components[3:])),
    )


def _worst(key: str, worst: PassComponent) -> Iterator[Figure]:
    size = None if worst.value is None else abs(worst.value)
    yield figure(key, size, worst.unit, limit=Limit(upper=worst.limit))
    yield figure(f"{key}{KNOWN_TO}", expanded(worst), worst.unit)


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
        "heads_moved_mm_deg": in_mm_deg(measured.pose.movement).tolist(),
        "fit": fit_verdict(measured.pose.misfit),
    }


def fit_verdict(misfit: ChiSquare) -> dict[str, Any]:
    """Whether the stated uncertainties explain the residuals, and what follows where they do not.

    A part that is a few micrometres off its drawing fails this test of uncertainties: it is not a
    bad part for that, its residuals have a limit of their own. But the standard deviations of its
    pose grow by ``sigma_factor``.
    """
    verdict = "explained" if misfit.explained else "not explained"
    return {
        "verdict": f"{verdict} by the stated uncertainties",
        "chi2": misfit.chi2,
        "chi2_limit": misfit.limit,
        "freedom": misfit.freedom,
        "sigma_factor": float(np.sqrt(misfit.growth)),
    }


def residual_figure(kind: str, measured: PartMeasurement) -> Figure:
    """The hole that lies farthest from its registered place, of those that were registered."""
    distances_m = np.linalg.norm(measured.pose.residuals_m, axis=1)
    used = [name not in measured.pose.outliers for name in measured.pose.names]
    return figure(
        f"{WORST_RESIDUAL}.{kind}",
        float(distances_m[used].max()) / MM * 1e3,
        "µm",
        limit=Limit(upper=RESIDUAL_LIMIT_M / MM * 1e3),
    )


def seat_record(seat: SeatError, recipe: DeckRecipe) -> dict[str, Any]:
    """The seated deck as plain data, in mm and degrees, with expanded uncertainties."""
    rotation = seat.rotation(recipe.seated_limits_deg)
    return {
        f"{SEATED_ERROR}_mm_deg": in_mm_deg(seat.error).tolist(),
        f"{SEATED_SIGMA}_mm_deg": in_mm_deg(np.sqrt(np.diag(seat.covariance))).tolist(),
        f"{PIN_OFFSETS}_mm": dict(seat.offsets_mm),
        f"{GAP_BY_VISION}_mm": seat.gap_mm,
        f"{SEAT_ROTATION}_deg": rotation.value_deg,
        f"{PIN_OFFSETS}_{UNCERTAINTY}_mm": dict(seat.offset_uncertainties_mm),
        f"{GAP_BY_VISION}_{UNCERTAINTY}_mm": seat.gap_uncertainty_mm,
        f"{SEAT_ROTATION}_{UNCERTAINTY}_deg": rotation.uncertainty_deg,
    }


def gauge_holes(pins: Iterable[Hole], recipe: DeckRecipe) -> dict[str, Any]:
    """Limits of the plug gauge by hole: the offset that the recipe allows narrows the passage."""
    return {
        hole.name: {
            "least_mm": hole.diameter_m / MM - recipe.seated_limit_mm,
            "most_mm": hole.diameter_m / MM,
        }
        for hole in pins
    }


def seat_limits_of(seat: SeatError, recipe: DeckRecipe) -> Mapping[str, Limit]:
    """Limits of acceptance of ``seat_record``: those of the recipe less the uncertainty."""
    gap_mm = recipe.seated_gap_limit_mm - seat.gap_uncertainty_mm
    return {
        **{
            f"{PIN_OFFSETS}.{name}": Limit(upper=recipe.seated_limit_mm - uncertainty_mm)
            for name, uncertainty_mm in seat.offset_uncertainties_mm.items()
        },
        GAP_BY_VISION: Limit(-gap_mm, gap_mm),
        SEAT_ROTATION: Limit(upper=seat.rotation(recipe.seated_limits_deg).acceptance_deg),
        **{
            f"{SEATED_ERROR}.r{rotation.axis}": Limit(
                -rotation.acceptance_deg, rotation.acceptance_deg
            )
            for rotation in seat.rotations(recipe.seated_limits_deg)
        },
    }
