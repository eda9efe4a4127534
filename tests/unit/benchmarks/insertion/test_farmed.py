"""A campaign goes on where it was ended, and its lines say what was found."""

import json
import os
import signal
import time
from argparse import Namespace
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from benchmarks.insertion import cycle_campaign, fault_campaign, trap_campaign
from benchmarks.insertion.contact_traps import ContactTrap, TrapState
from benchmarks.insertion.cycles import CycleOutcome
from benchmarks.insertion.farmed import Line, farmed, jobs_of, kept
from benchmarks.insertion.fault_cycles import CycleFault
from cellctl.processes.peg_in_hole.plan.phases import CyclePhase
from cellctl.version import software
from fakes.scenes.socket.peaks import ForcePeaks
from tests.rigs.sweeps import sweep

Job = tuple[str, int]


def doubled(job: Job) -> int:
    """A result, for another process to find."""
    return 2 * job[1]


NUMBERS: Line[Job, int] = Line(
    lambda job, result: {"case": job[0], "seed": job[1], "result": result},
    lambda record: ((record["case"], record["seed"]), record["result"]),
)


def test_what_has_a_line_is_not_run_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "lines.json"
    begun = '{"case": "b", "seed": 3, "result": -1, "software": "another"}\n{"case": "a", "se'
    out.write_text(begun, "utf-8")
    jobs = jobs_of("ab", 3, 2)
    assert jobs == [("a", 3), ("b", 3), ("a", 4), ("b", 4)]
    found = Namespace(out=out, workers=1)
    assert farmed(doubled, jobs, "numbers", NUMBERS, found) == [6, -1, 8, 8]
    assert dict(kept(NUMBERS, out)) == {("b", 3): -1, ("a", 3): 6, ("a", 4): 8, ("b", 4): 8}
    assert farmed(doubled, jobs, "numbers", NUMBERS, found) == [6, -1, 8, 8]
    lines = out.read_text("utf-8").splitlines()
    assert len(lines) == 5
    assert json.loads(lines[-1])["software"] == software()
    assert f"1 numbers by another\n{out}: 3 numbers by {software()}" in capsys.readouterr().out


def ended_by_the_operator(job: Job) -> int:
    """Ctrl-C, or SIGTERM for jobs of b, in this process while the fourth job runs."""
    if job[1] == 3:
        time.sleep(0.5)
        os.kill(os.getppid(), signal.SIGINT if job[0] == "a" else signal.SIGTERM)
        time.sleep(0.5)
    return job[1]


@pytest.fixture
def interruptible() -> Iterator[None]:
    """Whoever starts the tests in the background of a shell has Ctrl-C ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
@pytest.mark.parametrize("by", sweep(("a", "b"), ("a",)))
def test_an_interrupted_campaign_keeps_what_it_has(tmp_path: Path, by: str) -> None:
    out = tmp_path / "lines.json"
    jobs = [(by, seed) for seed in range(40)]
    with pytest.raises(
        SystemExit, match=r"ended after \d+ of 40 numbers; the same command goes on"
    ):
        farmed(ended_by_the_operator, jobs, "numbers", NUMBERS, Namespace(out=out, workers=1))
    done = dict(kept(NUMBERS, out))
    assert (by, 0) in done
    assert len(done) < len(jobs)


PEAKS = {CyclePhase.SEARCH: ForcePeaks({1: 9.0, 3: 8.0, 20: 7.0}, {1: 0.1, 3: 0.1, 20: 0.1})}
CYCLE = CycleOutcome(7, called_good=True, seated=True, search_s=10.0, cycle_s=40.0, peaks=PEAKS)
FAULTY = CycleOutcome(7, fault="F591", height_m=1e-3, cycle_s=40.0)
TRAP = ContactTrap(TrapState.ON_FACE, 7, False, "F592", False, "not inserted", 12.5, 30.0, "")


@pytest.mark.parametrize(
    ("line", "job", "result", "figures"),
    [
        (cycle_campaign.LINE, ("pin", 7), CYCLE, lambda one: one.peaks[CyclePhase.SEARCH].force_n),
        (cycle_campaign.LINE, ("pin", 7), CYCLE, lambda one: (one.called_good, one.cycle_s)),
        (
            fault_campaign.LINE,
            (CycleFault.PEG_SLIP, 7),
            FAULTY,
            lambda one: (one.fault, one.height_m),
        ),
        (trap_campaign.LINE, (TrapState.ON_FACE, 7), TRAP, lambda one: one),
    ],
)
def test_a_line_is_read_as_it_was_written(
    line: Line[Any, Any], job: Any, result: Any, figures: Callable[[Any], Any]
) -> None:
    again, read = line.read(json.loads(json.dumps(line.written(job, result))))
    assert again == job
    assert figures(read) == figures(result)
