import math

import pytest

from drivers.ftsensor.sri.config import SriConfig
from drivers.ftsensor.sri.protocol import Frame
from drivers.ftsensor.sri.sampler import Sampler
from drivers.ftsensor.sri.values import engineering, from_bridge, from_counts

POINT = (1.0, 2.0, 3.0, 0.1, 0.2, 0.3)
IDENTITY = [[float(i == j) for j in range(6)] for i in range(6)]


def sampler(**changes: object) -> Sampler:
    made = Sampler(SriConfig.model_validate({"transport": "tcp", **changes}))
    made.restart(engineering)
    return made


def test_gaps_are_counted_across_the_wrap() -> None:
    taker = sampler()
    for number in (65533, 65534, 1, 2):
        taker.take([Frame(number, (POINT,))], 0.0)
    assert (taker.samples, taker.lost) == (4, 2)


def test_a_step_back_is_a_new_count() -> None:
    taker = sampler()
    taker.take([Frame(500, (POINT,))], 0.0)
    taker.take([Frame(0, (POINT,))], 0.001)
    assert taker.lost == 0


def test_a_frame_that_comes_again_is_no_new_sample() -> None:
    taker = sampler()
    one = Frame(7, (POINT,))
    assert len(taker.take([one], 0.0)) == 1
    assert taker.take([one, one], 0.002) == []
    assert (taker.samples, taker.invalid, taker.lost) == (1, 2, 0)
    assert len(taker.take([Frame(8, (POINT,))], 0.003)) == 1


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_no_sample(bad: float) -> None:
    taker = sampler()
    assert taker.take([Frame(1, ((bad, *POINT[1:]),))], 0.0) == []
    assert (taker.invalid, taker.samples) == (1, 0)


def test_opposite_infinities_do_not_cancel() -> None:
    taker = sampler()
    assert taker.take([Frame(1, ((math.inf, -math.inf, *POINT[2:]),))], 0.0) == []


def test_range_and_sign() -> None:
    taker = sampler(range=(10.0, 10.0, 10.0, 1.0, 1.0, 1.0), inverted=True)
    within, beyond = taker.take([Frame(1, (POINT,)), Frame(2, ((11.0, *POINT[1:]),))], 0.0)
    assert within[3:9] == tuple(-value for value in POINT)
    assert (within.saturated, beyond.saturated, taker.saturated) == (False, True, 1)


def test_points_of_one_frame_are_spaced() -> None:
    taker = sampler(points=4)
    samples = taker.take([Frame(1, (POINT,) * 4)], 10.0)
    assert [s.time_s for s in samples] == pytest.approx([9.997, 9.998, 9.999, 10.0])
    assert {s.receive_time_s for s in samples} == {10.0}


def test_bridge_signals_go_through_the_matrix() -> None:
    matrix = [[2.0 * value for value in row] for row in IDENTITY]
    assert from_bridge(matrix)(POINT)[0] == pytest.approx([2.0 * value for value in POINT])


def test_counts_follow_the_published_formula() -> None:
    convert = from_counts(IDENTITY, [32768.0] * 6, [123.7] * 6, [5.0067] * 6)
    wrench, at_end = convert((32769.0, 32768.0, 32767.0, 40000.0, 1.0, 65534.0))
    one = 1000.0 / 65535 * 5 / 123.7 / 5.0067
    assert wrench == pytest.approx(
        [one, 0.0, -one, 7232 * one, -32767 * one, 32766 * one], rel=1e-9, abs=1e-12
    )
    assert not at_end
    assert convert((65535.0, 0.0, 1.0, 1.0, 1.0, 1.0))[1]
