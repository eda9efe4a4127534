"""Light from one side is refused, where a measurement would be wrong without showing it."""

from dataclasses import replace

import numpy as np
import pytest

from cellctl.geometry.pose import pose_error
from cellctl.processes.antenna_module.faults.connector import LightFromOneSide
from cellctl.processes.antenna_module.vision.measure import measure_connector
from tests.rigs.antenna.pictures import CLEAN, HOLES, Conditions, trial
from tests.rigs.sweeps import sweep

SMALL = (35.0, 35.0)


def error_um(conditions: Conditions, seed: int = 4) -> float:
    given = trial(seed, replace(conditions, um_per_px=SMALL))
    found = measure_connector(given.pixels.plane, given.camera, given.plane, given.connector)
    moved, _ = pose_error(given.truth, found.camera_T_connector.pose)
    return float(np.linalg.norm(moved[:2])) * 1e6


@pytest.mark.parametrize("conditions", sweep((CLEAN, HOLES), (HOLES,)), ids=["pins", "holes"])
def test_a_ring_that_is_a_little_brighter_on_one_side_is_measured(conditions: Conditions) -> None:
    assert error_um(replace(conditions, one_sided=0.4)) < 4.0


@pytest.mark.parametrize("conditions", sweep((CLEAN, HOLES), (CLEAN,)), ids=["pins", "holes"])
@pytest.mark.parametrize(("one_sided", "arc_deg"), [(1.0, None), (0.0, 40.0)])
def test_a_lamp_at_one_side_is_refused(
    conditions: Conditions, one_sided: float, arc_deg: float | None
) -> None:
    with pytest.raises(LightFromOneSide):
        error_um(replace(conditions, one_sided=one_sided, arc_deg=arc_deg))


def test_large_chamfers_in_blurred_images_are_refused_as_well() -> None:
    with pytest.raises(LightFromOneSide):
        error_um(replace(CLEAN, name="d-sub-15", one_sided=1.0, noise_grey=4.0, blur_px=(2.0, 2.0)))
