"""Every line of a run says which run and which step, whoever logs it."""

import io
import json
import logging
import threading
from dataclasses import dataclass
from typing import Any

import pytest

from cellctl import log
from cellctl.errors.link import LinkLost
from cellctl.packml.state import State
from tests.unit.daemon_rig import DaemonRig

pytestmark = pytest.mark.usefixtures("restored_logging")


@dataclass(frozen=True)
class Logged:
    """A unit, and what it has logged."""

    rig: DaemonRig
    stream: io.StringIO

    @property
    def lines(self) -> list[dict[str, Any]]:
        return [json.loads(line) for line in self.stream.getvalue().splitlines()]


def index_of(told: list[dict[str, Any]], **wanted: object) -> int:
    return next(index for index, line in enumerate(told) if wanted.items() <= line.items())


@pytest.fixture
def logged(rig: DaemonRig, monkeypatch: pytest.MonkeyPatch) -> Logged:
    # The stream is not that of pytest, which closes its own before the unit has ended.
    stream = io.StringIO()
    monkeypatch.setattr("sys.stderr", stream)
    log.configure()
    log.always(rig.unit.log_facts)
    return Logged(rig, stream)


async def test_lines_of_a_good_run(logged: Logged) -> None:
    contact = logged.rig.contact
    contact.may_end.clear()
    await logged.rig.started()
    await contact.reached.wait()
    # A driver does this in a thread of its own, which knows nothing of runs.
    driver = threading.Thread(target=lambda: logging.getLogger("drivers.robot").info("late"))
    driver.start()
    driver.join()
    contact.may_end.set()
    await logged.rig.to(State.COMPLETED)
    told = logged.lines
    begin, end = index_of(told, event="state", state="EXECUTE"), index_of(told, event="run closed")
    within = told[begin : end + 1]
    assert {line.get("run") for line in within} == {1}
    first = index_of(within, event="step begins")
    last = max(index for index, line in enumerate(within) if line["event"] == "step begins")
    steps = [line.get("step") for line in within[first : last + 1]]
    assert None not in steps
    assert len(set(steps)) > 3
    (late,) = (line for line in within if line["event"] == "late")
    assert (late["run"], late["step"], late["module"]) == (1, "mate", "drivers.robot")
    done = told[index_of(told, event="state", state="COMPLETED")]
    assert "run" not in done


async def test_the_fault_that_ends_a_run_is_told_with_its_step(logged: Logged) -> None:
    logged.rig.contact.may_end.clear()
    await logged.rig.started()
    await logged.rig.contact.reached.wait()
    # The fault comes from outside the step, as from the watch of the links.
    await logged.rig.unit.machine.fail(LinkLost("main"))
    await logged.rig.to(State.ABORTED)
    told = logged.lines
    fault = told[index_of(told, event="fault")]
    assert (fault["number"], fault["run"], fault["step"]) == (LinkLost.number, 1, "mate")
    assert told[index_of(told, event="state", state="ABORTING")]["run"] == 1
