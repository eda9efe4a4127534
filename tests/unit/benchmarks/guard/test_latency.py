"""How the benchmark judges: which samples a stall touches, and what counts as reached."""

import numpy as np
import pytest

from benchmarks.guard.latency import Row, evaluate, verdicts
from benchmarks.guard.stalls import touched


def test_touched_by_a_stall() -> None:
    stalls = np.array([[1.0, 5.0], [2.0, 3.0], [10.0, 11.0]])
    begin = np.array([0.0, 0.5, 4.0, 5.5, 9.0, 10.5, 12.0])
    end = np.array([0.9, 1.5, 4.1, 5.6, 12.0, 10.6, 13.0])
    expected = [False, True, True, False, True, True, False]
    assert touched(begin, end, stalls).tolist() == expected
    assert not touched(begin, end, np.empty((0, 2))).any()


def test_stalled_samples_are_left_out_of_clean_only() -> None:
    sent = np.arange(0.0, 10.0, 0.001)
    stopped = sent + 1e-4
    stopped[5000:5010] = 5.02
    row = evaluate(Row("gil", "guard", 9.0, ""), sent, stopped, np.array([[4.999, 5.02]]))
    assert row.clean_ms[3] == pytest.approx(0.1)
    assert row.raw_ms[3] == pytest.approx(20.0)
    assert 0.0 < row.stalled < 0.01
    assert row.samples == 8999


def result(design: str, tail_ms: float, **changes: float) -> Row:
    return Row(
        "gil",
        design,
        60.0,
        "",
        clean_ms=(0.1, 0.2, tail_ms, 9.0),
        **changes,  # type: ignore[arg-type]
    )


@pytest.mark.parametrize(
    ("guard", "plain_ms", "expected"),
    [
        (result("guard", 0.5), 50.0, [True, True]),
        (result("guard", 1.5), 50.0, [False, True]),
        (result("guard", 0.5), 5.0, [True, False]),
        (result("guard", 0.5, unanswered=1), 50.0, [False, True]),
        (result("guard", 1.5, stalled=0.2), 50.0, [None, True]),
    ],
)
def test_verdicts(guard: Row, plain_ms: float, expected: list[bool | None]) -> None:
    assert [held for _, held in verdicts([guard, result("plain", plain_ms)])] == expected
