"""What the documentation says of whole cycles stands in the lines that it keeps."""

from collections import defaultdict
from pathlib import Path

from benchmarks.insertion import cycle_campaign
from benchmarks.insertion.cycles import CycleOutcome
from benchmarks.insertion.farmed import kept
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase

_DOCS = Path(__file__).parents[4] / "docs"


def test_the_lines_in_the_documentation_can_be_gone_on_with_and_say_what_it_says() -> None:
    by_cell: dict[str, list[CycleOutcome]] = defaultdict(list)
    for (cell, _), outcome in kept(cycle_campaign.LINE, _DOCS / "insertion-cycles.jsonl"):
        by_cell[cell].append(outcome)
    page = (_DOCS / "insertion-by-touch.md").read_text("utf-8")
    assert set(by_cell) == {"pin", "connector", "b-50um", "b-20um", "c-10um"}
    for outcomes in by_cell.values():
        good = sum(one.called_good and one.seated for one in outcomes)
        assert f"{good} of {len(outcomes)} (" in page
        assert not any(one.called_good and not one.seated for one in outcomes)
        greatest_n = max(one.peak_n(CyclePhase.SEARCH, 20) for one in outcomes)
        assert f"{greatest_n:.1f} N" in page
    assert len(cycle_campaign.table(dict(by_cell)).columns) == 1 + len(by_cell)
