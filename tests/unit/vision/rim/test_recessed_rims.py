"""Rims as machined: below the face, under a countersink or a chamfer that is a cone."""

from typing import Literal

import numpy as np
import pytest

from cellctl.vision.features.hole import Hole
from cellctl.vision.measure import measure_pair
from cellctl.vision.measurement import PairMeasurement
from fakes.render import api
from fakes.render.bodies.holes import rim_depth
from tests.rigs.metrology.scenes import HEAD_HOLES, stereo_head
from tests.rigs.sweeps import sweep

Errors = list[tuple[str, np.ndarray, float]]


def _errors(kind: Literal["deck", "frame"], options: api.RenderOptions, seed: int) -> Errors:
    """Kind, error in µm and normalised error squared of the holes that head 1 sees."""
    stereo = api.nominal_head()
    plate = api.nominal_plate(kind, tilt_deg=(1.0, -1.5, 2.0), seed=seed)
    images = api.render_pair(stereo, [plate], options, np.random.default_rng(seed), light_seed=seed)
    holes = [
        Hole(
            hole.name,
            hole.kind,
            hole.diameter_m,
            np.array([*hole.position_m, -rim_depth(hole, options)]),
            hole.countersink_m,
        )
        for hole in plate.holes
        if hole.name in HEAD_HOLES[0]
    ]
    found: PairMeasurement = measure_pair(
        *images, stereo_head(stereo), holes, camera_T_part=plate.camera_T_part
    )
    truth_m = api.hole_centres_m(plate, options)
    result: Errors = []
    for hole in found.holes:
        error_m = hole.position_m - truth_m[hole.name]
        squared = float(error_m @ np.linalg.solve(hole.covariance_m2, error_m))
        result.append((hole.kind, error_m * 1e6, squared))
    return result


@pytest.mark.parametrize("kind", sweep(("deck", "frame"), ("frame",)))
@pytest.mark.parametrize("recessed", [False, pytest.param(True, marks=pytest.mark.long)])
def test_rims_are_measured_where_they_are(kind: Literal["deck", "frame"], recessed: bool) -> None:
    options = api.RenderOptions(recessed_rims=recessed)
    for _, error_um, squared in _errors(kind, options, 2):
        assert np.abs(error_um[:2]).max() < 20.0
        assert abs(error_um[2]) < 35.0
        assert squared < 25.0
