"""The device that moved is named."""

import numpy as np
import pytest

from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.chain.reference.reference_check import (
    ReferenceReading,
    require_reference,
)
from cellctl.processes.antenna_module.faults.calibration import (
    ArmMoved,
    FixedCameraMoved,
    FlangeCameraMoved,
    GripperMarksMoved,
    ReferenceMoved,
    ReferencePlateMoved,
)

D, E = np.array([12e-6, -16e-6]), np.array([-20e-6, 5e-6])
NONE = np.zeros(2)


def reading(
    places: list[Array], sigma_m: float = 2.4e-6, seed: int | None = None
) -> ReferenceReading:
    noise = np.zeros((4, 2))
    if seed is not None:
        noise = np.random.default_rng(seed).normal(0, sigma_m, (4, 2))
    axis, marks, plate_1, plate_2 = np.stack(places) + noise
    return ReferenceReading(axis, marks, plate_1, plate_2, sigma_m)


TAUGHT = reading([NONE] * 4)
CASES = [
    ([-D, NONE, NONE, -D], FixedCameraMoved),
    ([NONE, D, NONE, NONE], GripperMarksMoved),
    ([NONE, NONE, D, D], ReferencePlateMoved),
    ([NONE, NONE, -D, NONE], FlangeCameraMoved),
    ([D, NONE, E, NONE], ArmMoved),
    ([D, D, E, NONE], ReferenceMoved),
]


@pytest.mark.parametrize(("places", "fault"), CASES)
def test_20_um_are_found_and_the_device_is_named(
    places: list[Array], fault: type[ReferenceMoved]
) -> None:
    named = []
    for seed in range(60):
        with pytest.raises(ReferenceMoved) as caught:
            require_reference(TAUGHT, reading(places, seed=seed))
        named.append(type(caught.value) is fault)
    assert np.mean(named) >= 0.95


def test_noise_alone_is_no_fault() -> None:
    for seed in range(150):
        require_reference(TAUGHT, reading([NONE] * 4, sigma_m=2e-6, seed=seed))
