import sys
from dataclasses import replace
from math import nan
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
    assert not any((trap.inserted or trap.by_curve == "inserted") > trap.seated for trap in traps)
    # Of what the documentation tells, only a sensor that stays at a value leads to more force.
    hard = {trap.state for trap in traps if trap.force_n > trap.limit_n}
    assert hard <= {TrapState.STUCK}
    assert len(trap_campaign.table(traps).rows) == len(TrapState)


def test_lines_without_a_force_are_told() -> None:
    shown = trap_campaign.table([GOOD, replace(GOOD, state=TrapState.ON_FACE, force_n=nan)])
    assert list(shown.columns[4].cells) == ["19.7 (1)", "–"]
