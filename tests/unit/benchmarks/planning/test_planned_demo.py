"""The planned cell is judged by the same parts in both cells."""

import io
from typing import Any

from rich.console import Console

from benchmarks.planning.planned_demo import above, table


def parts(lateral_mm: list[float], run_s: list[float]) -> list[dict[str, Any]]:
    return [
        {"passed": True, "lateral_mm": away, "run_s": time}
        for away, time in zip(lateral_mm, run_s, strict=True)
    ]


TAUGHT = parts([0.03, 0.08, 0.05, 0.04], [60.0, 61.0, 62.0, 60.0])


def test_what_every_part_shows_is_above_however_much_parts_differ() -> None:
    slower = parts([0.03, 0.08, 0.05, 0.04], [61.0, 62.1, 62.9, 61.0])
    assert above(TAUGHT, slower) == ["run_s"]
    assert above(slower, TAUGHT) == []


def test_scatter_is_not_above() -> None:
    scattered = parts([0.05, 0.06, 0.06, 0.05], [60.0, 61.0, 62.0, 60.0])
    assert above(TAUGHT, scattered) == []


def test_the_table_leaves_out_a_part_that_one_cell_has_not_made() -> None:
    failed = [{"passed": False}, *parts([0.08, 0.05, 0.04], [61.0, 62.0, 60.0])]
    console = Console(width=120, file=io.StringIO(), record=True)
    console.print(table(TAUGHT, failed))
    text = console.export_text()
    assert "planned, 3 of 4 good" in text
    assert "0.0500 / 0.0800" in text
    assert "+0.0000 ± 0.0000" in text
