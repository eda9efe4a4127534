"""A feature turned about the flange axis gives its offset, or is refused."""

import numpy as np
import pytest
from matplotlib.axes import Axes

from cellctl.errors.calibration import CalibrationRecordInvalid
from cellctl.geometry.pose import Array
from cellctl.processes.antenna_module.calibrations import TOOL_TURN
from cellctl.processes.antenna_module.chain.teaching.tool_turn import TurnStop, calibrate_tool_turn
from cellctl.processes.antenna_module.chain.teaching.turn_picture import turn_picture
from cellctl.processes.antenna_module.faults.calibration import TurnInvalid

AXIS_M, OFFSET_M = np.array([3.1e-3, -1.7e-3]), np.array([0.4e-3, 0.9e-3])


def stops(
    angles_deg: Array, sign: float = 1.0, noise_m: float = 0.0, seed: int = 1
) -> list[TurnStop]:
    rng = np.random.default_rng(seed)
    found = []
    for angle in np.radians(angles_deg):
        c, s = np.cos(sign * angle), np.sin(sign * angle)
        turned = np.array([[c, -s], [s, c]]) @ OFFSET_M
        found.append(TurnStop(float(angle), AXIS_M + turned + rng.normal(0, noise_m, 2)))
    return found


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_axis_and_offset_are_exact_without_noise(sign: float) -> None:
    result = calibrate_tool_turn(stops(np.arange(0.0, 360.0, 90.0), sign))
    np.testing.assert_allclose(result.axis_m, AXIS_M, atol=1e-12)
    np.testing.assert_allclose(result.offset_m, OFFSET_M, atol=1e-12)
    assert result.passed


@pytest.mark.parametrize(("count", "published_um"), [(4, 3.2), (8, 2.3), (12, 1.9)])
def test_the_offset_is_as_exact_as_published(count: int, published_um: float) -> None:
    angles = np.arange(count) * 360 / count
    errors = [
        calibrate_tool_turn(stops(angles, noise_m=5.53e-6, seed=seed)).offset_m - OFFSET_M
        for seed in range(200)
    ]
    assert np.sqrt(np.mean(np.square(errors))) * 1e6 == pytest.approx(published_um, rel=0.25)


def test_few_or_one_sided_angles_are_refused() -> None:
    with pytest.raises(TurnInvalid, match="2 angles"):
        calibrate_tool_turn(stops(np.array([0.0, 180.0])))
    with pytest.raises(TurnInvalid, match="gap"):
        calibrate_tool_turn(stops(np.array([0.0, 30.0, 60.0, 90.0])))


def test_a_feature_that_does_not_turn_with_the_joint_is_refused() -> None:
    right = stops(np.arange(0.0, 360.0, 45.0))
    order = [3, 0, 6, 1, 7, 4, 2, 5]
    shuffled = [
        TurnStop(one.angle_rad, right[other].seen_m)
        for one, other in zip(right, order, strict=True)
    ]
    with pytest.raises(TurnInvalid, match="residual"):
        calibrate_tool_turn(shuffled)


def test_noise_beyond_the_limit_does_not_pass() -> None:
    assert not calibrate_tool_turn(stops(np.arange(0.0, 360.0, 45.0), noise_m=60e-6)).passed


def test_the_record_is_read_back() -> None:
    result = calibrate_tool_turn(stops(np.arange(0.0, 360.0, 60.0), noise_m=5e-6))
    again = TOOL_TURN.result(result.to_record())
    assert again.to_record() == result.to_record()
    np.testing.assert_allclose(again.offset_m, result.offset_m, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("broken", [None, [], [1.0], [1.0, 2.0, 3.0], "x"])
def test_a_damaged_record_is_refused_by_name(broken: object) -> None:
    record = calibrate_tool_turn(stops(np.arange(0.0, 360.0, 60.0))).to_record()
    with pytest.raises(CalibrationRecordInvalid):
        TOOL_TURN.result({**record, "offset_mm": broken})


def test_the_picture_shows_every_look(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[tuple[float, ...]] = []
    real = Axes.plot

    def plot(self: Axes, x: object, y: object, *more: object, **how: object) -> object:
        drawn.append(tuple(np.atleast_1d(np.asarray(x, dtype=float)).tolist()))
        return real(self, x, y, *more, **how)  # type: ignore[arg-type]

    monkeypatch.setattr(Axes, "plot", plot)
    result = calibrate_tool_turn(stops(np.arange(0.0, 360.0, 60.0), noise_m=5e-6))
    assert turn_picture(result).startswith(b"\x89PNG")
    seen_mm = tuple((result.seen_m[:, 0] * 1e3).tolist())
    assert any(values == pytest.approx(seen_mm) for values in drawn if len(values) == len(seen_mm))
