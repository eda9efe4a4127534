"""The cells of the table: none is empty without a reason, a tenth is drawn, results are kept."""

from pathlib import Path

from benchmarks.faults import table
from benchmarks.faults.campaign import all_trials, chosen
from benchmarks.faults.kinds import FAULTS, demanded
from benchmarks.faults.observation import Effect
from benchmarks.faults.phases import PHASES
from tests.unit.benchmarks.faults.seen import CALM


def test_every_cell_is_tried_or_has_a_reason() -> None:
    keys = {trial.key for trial in all_trials()}
    for fault in FAULTS:
        for phase in PHASES:
            reason = fault.reason_not(phase)
            assert (f"{fault.key}/{phase.key}" in keys) == (reason is None)
            assert reason is None or len(reason) > 10


def test_keys_are_unique() -> None:
    assert len({fault.key for fault in FAULTS}) == len(FAULTS)
    assert len({phase.key for phase in PHASES}) == len(PHASES)


def test_a_tenth_is_the_same_for_the_same_seed() -> None:
    trials = all_trials()
    tenth = chosen(trials, [], 1)
    assert len(tenth) == -(-len(trials) // 10)
    assert tenth == chosen(trials, [], 1)
    assert tenth != chosen(trials, [], 2)


def test_only_takes_patterns() -> None:
    found = chosen(all_trials(), ["sensor-*/contact", "link-cut/verify"], None)
    assert {trial.phase.key for trial in found} == {"contact", "verify"}
    assert sum(trial.fault.key.startswith("sensor-") for trial in found) == len(found) - 1


def test_a_lost_line_stops_contact_at_once_and_elsewhere_lets_the_move_end() -> None:
    (fault,) = (fault for fault in FAULTS if fault.key == "line-dead")
    effects = {phase.key: demanded(fault, phase)[0] for phase in PHASES}
    assert effects["contact"] is effects["lift-off"] is Effect.AT_ONCE
    assert effects["measure-deck"] is effects["procedure-106"] is Effect.MOVE_ENDS


def test_results_are_read_as_they_were_written(tmp_path: Path) -> None:
    path = tmp_path / "faults.json"
    assert table.load(path) == {}
    table.save(path, {CALM.key: CALM})
    assert table.load(path) == {CALM.key: CALM}


def test_the_page_has_figures_or_a_reason_for_every_cell() -> None:
    page = table.markdown({CALM.key: CALM})
    (measured,) = (line for line in page.splitlines() if "as demanded |" in line)
    assert "41.0 / 50" in measured
    assert f"1 of {len(all_trials())} cells are measured; 1 of these" in page
    sections = page.split("\n## ")[1:]
    assert len(sections) == len(PHASES)
    for section, phase in zip(sections, PHASES, strict=True):
        assert section.startswith(phase.title)
        assert all(fault.title in section for fault in FAULTS)
    assert "Not tried, because" in page
    assert "Not measured yet" in page
