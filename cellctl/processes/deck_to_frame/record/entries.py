"""Measurements and passes of the loop as entries of the record, in mm, µm and degrees."""

from dataclasses import asdict
from typing import Any

import numpy as np

from cellctl.geometry.pose import MM, Array
from cellctl.geometry.units import in_mm_deg
from cellctl.processes.deck_to_frame.poses.part_measurer import PartMeasurement
from cellctl.processes.deck_to_frame.poses.pose_correction import Judgement, Thresholds
from cellctl.processes.deck_to_frame.record.keys import (
    ANGLE_ERROR,
    COMPONENTS,
    LOOP,
    POSITION_ERROR,
)
from cellctl.records.entries import Figure, LoopPass, PassComponent
from cellctl.records.figures import Limit, figure


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
    """The worst axis of position and of angle; thresholds are the same for all three axes."""
    return (
        _worst(POSITION_ERROR, entry.components[:3]),
        _worst(ANGLE_ERROR, entry.components[3:]),
    )


def _worst(key: str, components: tuple[PassComponent, ...]) -> Figure:
    values = np.abs(np.array([component.value for component in components], dtype=float))
    # The greatest of numbers of which one is not a number is not a number: an unknown component
    # must not hide behind those that are known.
    return figure(
        key, float(values.max()), components[0].unit, limit=Limit(upper=components[0].limit)
    )


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
