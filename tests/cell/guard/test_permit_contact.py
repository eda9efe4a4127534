"""The PC's contact in the permit loop, on the whole cell: it stops the arm whatever the jobs do.

Each test takes the other ways to a stop away from the controller of the main arm, so that only the
contact is left.
"""

import json
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from fakes.demo.control import Control
from tests.rigs.whole_cell.outside_plc import OutsidePlc
from tests.rigs.whole_cell.own_cell import OwnCell, Program

pytestmark = [pytest.mark.timeout(200)]

MAINTENANCE = 2
IDENTIFY_PAYLOAD = 106
"""Its moves are long."""
MAIN_CONTACT = "0"
"""Output of the coupler, as the control port names it."""
STANDS_S = 3.0
"""Watchdog of the coupler, dead time of the arm, braking, and a busy PC; the dead man of an
unconfirmed stop comes later."""


@dataclass
class Moving:
    """The main arm of a cell in a move."""

    plc: OutsidePlc
    control: Control
    fake: Program
    daemon: Program

    def contact_closed(self) -> bool:
        outputs = self.control.request("outputs", device="permit")["outputs"]
        return bool(outputs[MAIN_CONTACT])

    def moves(self) -> bool:
        before = self._place()
        time.sleep(0.2)
        return max(abs(a - b) for a, b in zip(self._place(), before, strict=True)) > 0.5

    def stands_by_the_contact(self) -> None:
        self.plc_free_until("an open contact", lambda: not self.contact_closed())
        self.plc_free_until("standstill", lambda: not self.moves())
        # What the controller logs when one of its background jobs has stopped the arm.
        assert "main, stop" not in self.fake.stderr

    def plc_free_until(self, what: str, reached: Callable[[], bool]) -> None:
        """Wait without asking the daemon, which may stand still itself."""
        deadline = time.monotonic() + STANDS_S
        while not reached():
            assert time.monotonic() < deadline, f"no {what} in {STANDS_S} s"

    def _place(self) -> list[float]:
        flange: list[float] = self.control.request("truth")["truth"]["base_T_flange_mm_deg"]
        return flange


@pytest.fixture
def jobs(tmp_path: Path) -> Iterator[OwnCell]:
    cell = OwnCell.make(tmp_path, "deck-jobs")
    yield cell
    cell.kill_all()


@contextmanager
def in_a_move(jobs: OwnCell) -> Iterator[Moving]:
    fake = jobs.fake()
    fake.ready()
    daemon = jobs.daemon()
    daemon.ready()
    with OutsidePlc(jobs.modbus_port) as plc, jobs.control() as control:
        moving = Moving(plc, control, fake, daemon)
        plc.start_heartbeat()
        assert not moving.contact_closed()
        plc.command("Clear")
        plc.command("Reset", mode=MAINTENANCE)
        plc.done(60)
        assert moving.contact_closed()
        assert plc.command("Start", mode=MAINTENANCE, recipe=IDENTIFY_PAYLOAD, serial="LOOP.1") == 0
        plc.until("a move", lambda: plc.state == "Execute" and moving.moves(), 60)
        yield moving


@pytest.mark.parametrize("command", ["Stop", pytest.param("Abort", marks=pytest.mark.long)])
def test_a_command_stops_an_arm_whose_jobs_overhear_it(jobs: OwnCell, command: str) -> None:
    with in_a_move(jobs) as moving:
        moving.control.request("inject", device="main", name="ignore_stop")
        assert moving.plc.command(command) == 0
        moving.stands_by_the_contact()


def test_a_trip_of_the_guard_stops_an_arm_whose_jobs_overhear_it(jobs: OwnCell) -> None:
    with in_a_move(jobs) as moving:
        moving.control.request("inject", device="main", name="ignore_stop")
        moving.control.request("inject", device="force", name="silent")
        moving.stands_by_the_contact()
        moving.daemon.logged("guard has stopped the robot", 10)


@pytest.mark.figures  # beside the trip of the guard
def test_a_frozen_daemon_leaves_the_arm_to_the_watchdog_of_the_coupler(jobs: OwnCell) -> None:
    with in_a_move(jobs) as moving:
        moving.daemon.process.send_signal(signal.SIGSTOP)
        moving.control.request("inject", device="main", name="frozen_stat")
        moving.stands_by_the_contact()
        moving.control.request("clear", device="main")
        moving.daemon.process.send_signal(signal.SIGCONT)
        # Whatever the daemon finds when it goes on, the contact stays open until somebody resets.
        moving.plc.until("the end", lambda: moving.plc.state in ("Aborted", "Stopped"), 30)
        assert not moving.contact_closed()
        assert not moving.moves()
        assert moving.plc.command("Clear") == 0
        moving.plc.done(30)
        assert moving.plc.command("Reset", mode=MAINTENANCE) == 0
        moving.plc.done(60)
        assert moving.contact_closed()


@pytest.mark.long
@pytest.mark.timeout(400)
def test_the_deck_is_assembled_with_the_contacts_in_the_loops(jobs: OwnCell) -> None:
    out = jobs.folder / "run"
    demo = jobs.demo(out, "--seed", "1", "--quiet")
    assert demo.end(300) == 0, demo.stdout + demo.stderr
    demo.nobody_left()
    assert json.loads((out / "result.json").read_text(encoding="utf-8"))["passed"]
