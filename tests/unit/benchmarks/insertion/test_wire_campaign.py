"""A verdict that differs is found, and so is one that both agree on and that is not true."""

import numpy as np
import pytest

from benchmarks.insertion.cycles import CycleOutcome
from benchmarks.insertion.wire_campaign import Trial, table, trial
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase
from fakes.scenes.socket.peaks import ForcePeaks

RESULT = {
    "result": "good",
    "seated": True,
    "short_mm": 0.02,
    "force_20_ms_n": 21.0,
    "force_3_ms_n": 22.0,
}


def cycle(*, good: bool = True, force_n: float = 20.0) -> CycleOutcome:
    peaks = ForcePeaks({1: force_n, 3: force_n, 20: force_n}, {1: 0.0, 3: 0.0, 20: 0.0})
    softer = ForcePeaks({1: 1.0, 3: 1.0, 20: 1.0}, {1: 0.0, 3: 0.0, 20: 0.0})
    outcome = CycleOutcome(7, called_good=good, seated=good, height_m=-0.01199)
    outcome.peaks = {CyclePhase.INSERTION: peaks, CyclePhase.SEARCH: softer}
    return outcome


def test_figures_are_those_of_the_whole_cycle_and_of_the_seat() -> None:
    found = trial("pin", RESULT, cycle())
    assert found.agrees
    assert found.without["short_mm"] == pytest.approx(0.01)
    assert found.without["force_20_ms_n"] == 20.0
    assert found.wire["force_3_ms_n"] == 22.0


@pytest.mark.parametrize(
    ("result", "good"),
    [
        ({**RESULT, "result": "not good", "seated": False}, True),
        (RESULT, False),
        ({**RESULT, "seated": False}, True),
        ({"seed": 7, "passed": False, "fault": "no result"}, True),
    ],
)
def test_what_does_not_agree(result: dict[str, object], good: bool) -> None:
    assert not trial("pin", result, cycle(good=good)).agrees


def test_a_part_that_neither_inserts_agrees_and_stays_out_of_the_figures() -> None:
    out = trial("pin", {**RESULT, "result": "not good", "seated": False}, cycle(good=False))
    assert out.agrees
    several: list[Trial] = [trial("pin", RESULT, cycle(force_n=force)) for force in (19.0, 20.0)]
    shown = table("pin", [*several, out])
    assert "2 of 3" in str(shown.columns[0].header)
    medians = [str(cell) for cell in shown.columns[2].cells]
    assert medians[1] == f"{np.median([19.0, 20.0]):.3f} / 20.000"
