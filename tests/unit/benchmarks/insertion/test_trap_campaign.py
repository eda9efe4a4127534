import sys
from dataclasses import replace
from math import isnan
from pathlib import Path

import pytest

from benchmarks.insertion import trap_campaign
from benchmarks.insertion.contact_traps import ContactTrap, TrapState
from benchmarks.insertion.farmed import kept

KEPT = Path(__file__).parents[4] / "docs" / "insertion-traps.jsonl"
GOOD = ContactTrap(
    TrapState.INSERTED, 1, inserted=True, fault="", seated=True, by_curve="inserted", force_n=19.7,
    limit_n=30.0, curve="",
)  # fmt: skip


@pytest.mark.parametrize(
    ("trap", "code"),
    [
        (GOOD, 0),
        (replace(GOOD, seated=False), 1),
        (replace(GOOD, seated=False, inserted=False), 1),
        (replace(GOOD, force_n=38.9), 1),
        (replace(GOOD, force_n=38.9, inserted=False, by_curve="not inserted", fault="F592"), 1),
        (replace(GOOD, inserted=False, by_curve="not inserted", fault="F592"), 0),
    ],
)
def test_a_false_verdict_and_a_force_over_the_limit_fail(
    trap: ContactTrap,
    code: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(trap_campaign, "farmed", lambda *_: [trap])
    monkeypatch.setattr(sys, "argv", ["trap_campaign"])
    assert trap_campaign.main() == code
    if trap.force_n > trap.limit_n:
        assert "38.9 N of 30" in capsys.readouterr().out


def test_the_lines_in_the_documentation_can_be_gone_on_with() -> None:
    traps = [trap for _, trap in kept(trap_campaign.LINE, KEPT)]
    assert len(traps) > 100
    assert not any(trap.found for trap in traps)
    table = trap_campaign.table([*traps, GOOD])
    column = list(table.columns[4].cells)
    assert column[0] == "19.7 (1)"
    assert "–" in column or not any(isnan(trap.force_n) for trap in traps)
