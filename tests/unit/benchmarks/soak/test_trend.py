"""What is called flat, and what is called a leak."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks.soak.__main__ import table, write_figures
from benchmarks.soak.cell import Cycle
from benchmarks.soak.chart import draw
from benchmarks.soak.trend import BOUNDS, LEAST, Looked, Trend, Verdict, judged_from, trends
from tests.rigs.kept import Kept

CYCLE_S = 68.0


def looked(
    cycles: int,
    *,
    leak_kb: float = 0.0,
    handles: float = 0.0,
    seed: int = 1,
    process: str = "p",
    warm_cycles: float = 2.0,
) -> Looked:
    """A process of 200 MB whose memory scatters by 1 MB, with a warm-up and a leak a cycle."""
    rng = np.random.default_rng(seed)
    numbers = np.arange(cycles)
    warm_kb = 30_000 * (1 - np.exp(-numbers / warm_cycles))
    memory_kb = 200_000 + warm_kb + rng.normal(0.0, 1_000, cycles) + leak_kb * numbers
    kept = [
        Kept(40 + int(handles * number), 12, int(kb))
        for number, kb in zip(numbers, memory_kb, strict=True)
    ]
    return Looked(process, (CYCLE_S * (numbers + 1)).tolist(), kept)


def verdicts(one: Looked) -> dict[str, Verdict]:
    return {trend.quantity: trend.verdict for trend in trends(one)}


@pytest.mark.parametrize("seed", range(20))
def test_an_hour_tells_a_leak_from_scatter(seed: int) -> None:
    assert set(verdicts(looked(53, seed=seed)).values()) == {Verdict.FLAT}
    # A megabyte a part is 53 MB an hour.
    assert verdicts(looked(53, leak_kb=1_000, seed=seed))["memory_kb"] is Verdict.GROWS


def test_the_slope_is_that_which_was_put_in() -> None:
    (memory,) = trends(looked(53, leak_kb=500), {"memory_kb": 20_000})
    true = 500 * 3600 / CYCLE_S
    assert memory.low < true < memory.high
    assert memory.slope == pytest.approx(true, rel=0.1)


def test_a_few_minutes_decide_nothing_about_memory() -> None:
    found = verdicts(looked(8, warm_cycles=0.3))
    assert found["memory_kb"] is Verdict.UNDECIDED
    assert found["threads"] is Verdict.FLAT


def test_a_handle_that_is_kept_is_found() -> None:
    assert verdicts(looked(53, handles=0.2))["descriptors"] is Verdict.GROWS


def test_a_step_is_no_trend() -> None:
    one = looked(53)
    stepped = [
        Kept(kept.descriptors, kept.threads, kept.memory_kb + (8_000 if index > 45 else 0))
        for index, kept in enumerate(one.kept)
    ]
    assert trends(Looked("p", one.time_s, stepped))[0].verdict is Verdict.FLAT


def test_too_few_cycles_are_refused() -> None:
    with pytest.raises(ValueError, match="too few"):
        trends(looked(judged_from(5) + LEAST - 1))


def test_picture_figures_and_table(tmp_path: Path) -> None:
    both = [looked(20, process="daemon"), looked(20, leak_kb=3_000, process="page")]
    found: list[Trend] = [trend for one in both for trend in trends(one)]
    write_figures(tmp_path, [Cycle(68.0, good=True, said="")], both)
    draw(both, found, tmp_path / "soak.png")
    assert (tmp_path / "soak.png").stat().st_size > 20_000
    kept = json.loads((tmp_path / "soak.json").read_text(encoding="utf-8"))["kept"]
    assert [len(one["kept"]) for one in kept] == [20, 20]
    assert table(found).row_count == 2 * len(BOUNDS)
