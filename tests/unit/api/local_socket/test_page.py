"""What the operator page is pushed, and what it may ask: around a cell in memory."""

import asyncio
import json
import os
from typing import Any

import numpy as np
import pytest

from cellctl.api.local_socket.live_feed import LiveFeed, as_line
from cellctl.api.local_socket.live_view import LiveView
from cellctl.api.local_socket.messages import (
    Answer,
    CommandRequest,
    ModeCommand,
    OnBehalf,
    PageCommand,
    PlainCommand,
    Refused,
    StartCommand,
    Taken,
    parse_request,
    to_line,
)
from cellctl.api.local_socket.page_desk import AT_A_PANEL, refusal
from cellctl.api.local_socket.reporter import Reporter
from cellctl.api.local_socket.terminal import Terminal
from cellctl.clock import Monotonic, now_s
from cellctl.command.refusal_notes import NOTED_A_MINUTE
from cellctl.errors.link import LinkLost
from cellctl.errors.local import NotThePage
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.runtime.cell_status import CellStatus
from tests.unit.command.test_arbiter import audit
from tests.unit.daemon_rig import DaemonRig

UID = os.getuid()


class Page:
    def __init__(self, rig: DaemonRig, given_s: Monotonic = now_s) -> None:
        cell = rig.bench.as_cell
        self.view = LiveView(cell, rig.unit, rig.arbiter, lambda: {"loop_late_s": 0.01})
        self.reporter = Reporter(cell, rig.unit, rig.arbiter, rig.archive, self.view)
        self._keys = 0
        self._rig = rig
        self._terminal = Terminal(
            cell.config,
            rig.unit.machine,
            rig.arbiter.submit,
            self.reporter,
            self.view,
            note_refusal=rig.arbiter.note_refusal,
            given_s=given_s,
        )

    def wanted(self, command: CommandRequest, **by: Any) -> PageCommand:
        self._keys += 1
        given: dict[str, Any] = {
            "person": "anna",
            "role": "operate",
            "panel": "panel-1",
            "decision": self.view.look(),
            "key": f"key-{self._keys:05d}",
        } | by
        request = PageCommand(on_behalf=OnBehalf(**given), command=command)
        assert parse_request(to_line(request)) == request, "survives the wire"
        return request

    async def ask(self, request: PageCommand, uid: int = UID) -> Answer:
        return await self._terminal.handle(request, uid)

    def snapshot(self) -> dict[str, Any]:
        unit = self._rig.unit
        status = unit.view.snapshot(unit.jobs.shown, unit.jobs.shown_result, unit.parts)
        parsed: dict[str, Any] = json.loads(as_line(self.view.snapshot(status)))
        return parsed


@pytest.fixture
def page(rig: DaemonRig) -> Page:
    return Page(rig)


async def test_a_part_is_made_and_the_audit_log_names_person_panel_and_reason(
    rig: DaemonRig, page: Page
) -> None:
    await page.ask(page.wanted(PlainCommand(request="reset")))
    await rig.to(State.IDLE)
    recipe = rig.bench.cell.config.recipes[0]
    start = StartCommand(serial="SAT-7", recipe=recipe.name, dry_run=True)
    wanted = page.wanted(start, reason="first part of the shift")
    assert isinstance(await page.ask(wanted), Taken)
    await rig.to(State.COMPLETED)
    actor, action, detail = (await rig.archive.do(audit))[-1]
    assert (actor, action) == ("page:anna@panel-1", "start")
    assert detail["reason"] == "first part of the shift"
    assert detail["key"] == wanted.on_behalf.key
    shown = page.snapshot()
    assert shown["run"]["serial"] == "SAT-7"
    assert shown["daemon"] == {"loop_late_s": 0.01}
    assert shown["guards"].keys() == rig.bench.cell.guards.keys()


async def test_the_same_key_is_obeyed_once(rig: DaemonRig, page: Page) -> None:
    wanted = page.wanted(PlainCommand(request="reset"))
    answers = await asyncio.gather(*(page.ask(wanted) for _ in range(50)))
    await rig.to(State.IDLE)
    assert set(answers) == {Taken(state="RESETTING")}
    assert await page.ask(wanted) == Taken(state="RESETTING"), "also when it has ended long ago"
    assert [action for _, action, _ in await rig.archive.do(audit)] == ["reset"]


async def test_a_key_belongs_to_one_command(rig: DaemonRig, page: Page) -> None:
    await rig.idle()
    await page.ask(page.wanted(PlainCommand(request="stop"), key="same-key"))
    with pytest.raises(NotThePage, match="same-key"):
        await page.ask(page.wanted(PlainCommand(request="abort"), key="same-key"))


async def test_nobody_else_speaks_for_a_person(page: Page) -> None:
    with pytest.raises(NotThePage, match="F717"):
        await page.ask(page.wanted(PlainCommand(request="stop")), UID + 4_000_000)


async def test_two_operators_press_at_once_and_one_is_told_that_the_cell_has_changed(
    rig: DaemonRig, page: Page
) -> None:
    await rig.idle()
    first = page.wanted(PlainCommand(request="stop"), person="anna")
    second = page.wanted(PlainCommand(request="reset"), person="boris")
    assert isinstance(await page.ask(first), Taken)
    answer = await page.ask(second)
    assert isinstance(answer, Refused)
    assert answer.code == RejectCode.SUPERSEDED
    last = page.snapshot()["last_command"]
    assert (last["who"], last["command"]) == ("page:anna@panel-1", "stop")
    await rig.unit.background.drain()
    noted = await rig.archive.do(audit)
    assert [(who, what, "refused" in detail) for who, what, detail in noted[-2:]] == [
        ("page:anna@panel-1", "stop", False),
        ("page:boris@panel-1", "reset", True),
    ]
    assert noted[-1][2]["refused"] == RejectCode.SUPERSEDED.text
    assert noted[-1][2]["reject_code"] == RejectCode.SUPERSEDED
    later = page.wanted(ModeCommand(mode="manual"), person="boris")
    assert isinstance(await page.ask(later), Refused)
    await rig.unit.background.drain()
    assert (await rig.archive.do(audit))[-1][2]["mode"] == "manual"


async def test_refusals_by_the_thousand_do_not_fill_the_audit_log(
    rig: DaemonRig, page: Page
) -> None:
    for _ in range(NOTED_A_MINUTE + 40):
        await page.ask(page.wanted(PlainCommand(request="stop"), role="view"))
    await rig.unit.background.drain()
    assert len(await rig.archive.do(audit)) == NOTED_A_MINUTE


async def test_the_last_command_is_named_whoever_gave_it(rig: DaemonRig, page: Page) -> None:
    assert page.snapshot()["last_command"] is None
    await rig.idle()
    given: list[tuple[CommandRequest, str]] = [
        (ModeCommand(mode="maintenance"), "mode"),
        (PlainCommand(request="stop"), "stop"),
        (PlainCommand(request="abort"), "abort"),
    ]
    for command, name in given:
        assert isinstance(await page.ask(page.wanted(command, role="maintain")), Taken)
        assert page.snapshot()["last_command"]["command"] == name
        await rig.until(lambda: rig.unit.machine.state is rig.unit.machine.state_requested)


@pytest.mark.parametrize("role", ["view", "operate", "maintain"])
@pytest.mark.parametrize("panel", ["", "panel-1"])
@pytest.mark.parametrize(
    "name", ["start", "reset", "unhold", "mode", "procedure", "hold", "clear", "stop", "abort"]
)
def test_who_may_do_what_where(role: Any, panel: str, name: str) -> None:
    by = OnBehalf(person="anna", role=role, panel=panel, decision=3, key="key-0001")
    code = refusal(name, by, 3)
    maintains = name in ("mode", "procedure")
    may = role == "maintain" or (role == "operate" and not maintains)
    if not may and not (name == "abort" and panel):
        assert code is RejectCode.ROLE_MISSING
    elif name in AT_A_PANEL and not panel:
        assert code is RejectCode.NOT_AT_A_PANEL
    else:
        assert code is RejectCode.NONE
        late = refusal(name, by, 4)
        allowed = RejectCode.NONE if name in ("stop", "abort") else RejectCode.SUPERSEDED
        assert late is allowed


async def test_the_snapshot_says_what_is_permitted_and_what_is_wrong(
    rig: DaemonRig, page: Page
) -> None:
    await rig.idle()
    idle = page.snapshot()
    assert {name for name, entry in idle["permitted"].items() if not entry["code"]} >= {
        "start",
        "stop",
        "abort",
        "mode",
    }
    assert idle["permitted"]["clear"]["reason"]
    await rig.unit.machine.fail(LinkLost("aux_1"))
    await rig.to(State.ABORTED)
    aborted = page.snapshot()
    assert aborted["state"] == "ABORTED"
    assert aborted["decision"] > idle["decision"]
    assert aborted["faults"][0]["number"] == LinkLost.number
    assert aborted["alarms"][0]["remedy"] == LinkLost.remedy
    assert not aborted["permitted"]["clear"]["code"]


async def test_the_touch_that_a_step_waits_for_is_no_trip(rig: DaemonRig, page: Page) -> None:
    rig.bench.cell.guard.trip = GuardTrip(TripReason.TOUCH, 1.0, "touch after 12 ms")
    (force,) = page.snapshot()["forces"]
    assert "touch after 12 ms" in force["trip"]
    assert force["touch"] == ""
    rig.unit.board.update(contact=True)
    (force,) = page.snapshot()["forces"]
    assert force["trip"] == "", "the metrics read this"
    assert "touch after 12 ms" in force["touch"]


async def test_a_force_of_which_nothing_has_come_for_seconds_is_not_shown(
    rig: DaemonRig, page: Page
) -> None:
    (force,) = page.snapshot()["forces"]
    assert not force["stale"]
    assert force["wrench"][2]["value"] is not None
    rig.bench.cell.guard.silent_s = 25.0
    (force,) = page.snapshot()["forces"]
    assert force["stale"]
    assert force["age_s"] == pytest.approx(25.0, abs=5.0)
    assert [axis["value"] for axis in force["wrench"]] == [None] * 6
    assert force["presses_n"] is None


async def test_permitted_is_what_the_command_path_answers(rig: DaemonRig, page: Page) -> None:
    recipe = rig.bench.cell.config.recipes[0]
    for line_alive in (False, True):
        rig.port.line_alive = line_alive
        for name in ("hold", "unhold", "reset", "clear"):
            code = page.snapshot()["permitted"][name]["code"]
            answer = await page.ask(page.wanted(PlainCommand.model_validate({"request": name})))
            assert (answer.code if isinstance(answer, Refused) else 0) == code, name
            await rig.until(lambda: rig.unit.machine.state is rig.unit.machine.state_requested)
        code = page.snapshot()["permitted"]["start"]["code"]
        if code:
            start = StartCommand(serial="S", recipe=recipe.name)
            answer = await page.ask(page.wanted(start))
            assert isinstance(answer, Refused)
            assert answer.code == code


async def test_the_description_has_no_value_that_json_lacks(page: Page) -> None:
    described = await page.reporter.description()
    assert json.loads(as_line(described)) == described
    assert described["recipes"]


class SlowWriter:
    """A connection whose other end may stop reading."""

    def __init__(self) -> None:
        self.lines: list[dict[str, Any]] = []
        self.reads = asyncio.Event()

    def write(self, data: bytes) -> None:
        self.lines += [json.loads(line) for line in data.splitlines()]

    async def drain(self) -> None:
        await self.reads.wait()


async def test_a_follower_that_does_not_read_delays_nobody_and_is_dropped(
    rig: DaemonRig, page: Page
) -> None:
    feed = LiveFeed(page.view, page.reporter.description, unread_s=0.2)
    slow, quick = SlowWriter(), SlowWriter()
    quick.reads.set()
    tasks = [asyncio.create_task(feed.follow(one)) for one in (slow, quick)]  # type: ignore[arg-type]
    await asyncio.sleep(0)
    for _ in range(20):
        feed.publish(CellStatus())
        await asyncio.sleep(0)
        await asyncio.sleep(0)
    await rig.until(lambda: any(line["kind"] == "description" for line in quick.lines))
    snapshots = [line for line in slow.lines if line["kind"] == "snapshot"]
    assert len(snapshots) <= 1, "the rest was replaced by newer ones"
    assert sum(line["kind"] == "snapshot" for line in quick.lines) >= 10
    with pytest.raises(TimeoutError):
        await tasks[0]
    tasks[1].cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


async def test_an_arm_that_pressed_when_its_sensor_fell_silent_may_press_still(
    rig: DaemonRig, page: Page
) -> None:
    guard = rig.bench.cell.guard
    guard.raw = np.tile([0.0, 0.0, -38.0, 0.0, 0.0, 0.0], (len(guard.raw), 1))
    guard.silent_s = 25.0
    await rig.unit.machine.command(Command.ABORT)
    await rig.to(State.ABORTED)
    (force,) = page.snapshot()["forces"]
    assert force["stale"]
    assert [axis["value"] for axis in force["wrench"]] == [None] * 6
    assert force["presses_n"] == pytest.approx(38.0)


async def test_a_command_that_comes_again_after_a_restart_is_not_obeyed_again(
    rig: DaemonRig,
) -> None:
    """The daemon that knew its key is gone, and this one is in the same state."""
    page = Page(rig)
    wanted = page.wanted(PlainCommand(request="reset"))
    assert isinstance(await page.ask(wanted), Taken)
    await rig.to(State.IDLE)
    await rig.restart()
    again = Page(rig)
    again.snapshot()
    answer = await again.ask(wanted)
    assert isinstance(answer, Refused)
    assert answer.code == RejectCode.SUPERSEDED
    assert rig.states == []
