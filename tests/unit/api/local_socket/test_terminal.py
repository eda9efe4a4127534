"""Requests reach the arbiter and come back answered, around a cell in memory."""

import os
import pwd
from datetime import timedelta

import numpy as np
import pytest

from cellctl.api.local_socket.live_view import PRESSES_N, LiveView
from cellctl.api.local_socket.messages import (
    AcknowledgeCommand,
    GivenCommand,
    ModeCommand,
    PlainCommand,
    ProcedureCommand,
    Refused,
    Request,
    RobotAnswer,
    RobotRequest,
    StartCommand,
    StatusAnswer,
    StatusRequest,
    Taken,
    parse_answer,
    to_line,
)
from cellctl.api.local_socket.report import StatusReport
from cellctl.api.local_socket.reporter import Reporter
from cellctl.api.local_socket.terminal import Terminal
from cellctl.api.local_socket.users import Users
from cellctl.cli.operator.daemon_client import ANSWER_S
from cellctl.clock import now_s
from cellctl.errors.link import DeviceAway, LinkLost, StaleData
from cellctl.errors.local import MessageMalformed
from cellctl.errors.records.store import StoreUnavailable
from cellctl.guard.report import GuardTrip, TripReason
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.state import State
from cellctl.packml.unit_command import MOST_AGE_S
from cellctl.records.store import RunStore
from tests.unit.calibration.store.shipped import renew_calibrations
from tests.unit.command.test_arbiter import audit
from tests.unit.daemon_rig import DaemonRig

UID = os.getuid()
ME = f"terminal:{pwd.getpwuid(UID).pw_name}"


class Operator:
    def __init__(self, rig: DaemonRig) -> None:
        cell = rig.bench.as_cell
        self._view = LiveView(cell, rig.unit, rig.arbiter, dict)
        reporter = Reporter(cell, rig.unit, rig.arbiter, rig.archive, self._view)
        self._terminal = Terminal(
            cell.config,
            rig.unit.machine,
            rig.arbiter.submit,
            reporter,
            self._view,
            note_refusal=rig.arbiter.note_refusal,
        )

    async def ask(self, request: Request, uid: int = UID) -> Taken | Refused:
        answer = await self._terminal.handle(request, uid)
        assert isinstance(answer, Taken | Refused)
        return answer

    async def plain(self, name: str) -> Taken | Refused:
        return await self.ask(PlainCommand.model_validate({"request": name}))

    async def status(self) -> StatusReport:
        answer = await self._terminal.handle(StatusRequest(), UID)
        assert isinstance(answer, StatusAnswer)
        assert parse_answer(to_line(answer)) == answer, "survives the wire"
        return answer.report


@pytest.fixture
def operator(rig: DaemonRig) -> Operator:
    return Operator(rig)


async def test_a_part_is_assembled(rig: DaemonRig, operator: Operator) -> None:
    assert await operator.plain("reset") == Taken(state="RESETTING")
    await rig.to(State.IDLE)
    assert (await operator.status()).ready
    recipe = rig.bench.cell.config.recipes[0]
    start = StartCommand(
        serial="SAT-7", mate_serial="FRAME-3", recipe=recipe.name, order="OP-3", dry_run=True
    )
    assert isinstance(await operator.ask(start), Taken)
    await rig.to(State.COMPLETED)
    report = await operator.status()
    assert (report.state, report.mode, report.result) == (
        "COMPLETED",
        "PRODUCTION",
        "done, no part",
    )
    assert report.last_run is not None
    assert (report.last_run.number, report.last_run.serial) == (1, "SAT-7")
    entries = await rig.archive.do(audit)
    assert [(actor, action) for actor, action, _ in entries] == [(ME, "reset"), (ME, "start")]
    assert entries[1][2]["options"] == 1
    assert entries[1][2]["mate_serial"] == "FRAME-3"


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        (PlainCommand(request="clear"), RejectCode.COMMAND_NOT_ALLOWED),
        (StartCommand(serial="lower"), RejectCode.SERIAL_INVALID),
        (StartCommand(serial=""), RejectCode.SERIAL_INVALID),
        (StartCommand(serial="S", mate_serial="lower"), RejectCode.SERIAL_INVALID),
        (StartCommand(serial="S", order="a b"), RejectCode.ORDER_INVALID),
        (StartCommand(serial="S", recipe="unknown"), RejectCode.RECIPE_UNKNOWN),
        (StartCommand(serial="S", recipe="101"), RejectCode.RECIPE_UNKNOWN),
        (ProcedureCommand(number=101, serial="P"), RejectCode.OTHER_MODE),
        (AcknowledgeCommand(number=999), RejectCode.ALARM_UNKNOWN),
    ],
)
async def test_refusals_have_the_lines_codes(
    rig: DaemonRig, operator: Operator, request_: Request, code: RejectCode
) -> None:
    await rig.idle()
    answer = await operator.ask(request_)
    assert isinstance(answer, Refused)
    name = request_.request
    assert (answer.code, answer.text, answer.state) == (code, code.text, "IDLE")
    assert rig.unit.machine.state is State.IDLE
    await rig.unit.background.drain()
    who, action, detail = (await rig.archive.do(audit))[-1]
    assert (who, action) == (ME, {"procedure": "start", "acknowledge": "set"}.get(name, name))
    assert (detail["refused"], detail["reject_code"], detail["state"]) == (code.text, code, "idle")
    typed = request_.recipe if isinstance(request_, StartCommand) else ""
    assert detail.get("recipe_named", "") == (typed if code is RejectCode.RECIPE_UNKNOWN else "")


async def test_a_mode_that_is_set_already_is_reached(rig: DaemonRig, operator: Operator) -> None:
    for name in ("maintenance", "maintenance", "manual", "production"):
        answer = await operator.ask(ModeCommand.model_validate({"mode": name}))
        assert isinstance(answer, Taken), name
    assert (await operator.status()).mode == "PRODUCTION"


async def test_no_start_changes_the_mode(rig: DaemonRig, operator: Operator) -> None:
    start, procedure = StartCommand(serial="S"), ProcedureCommand(number=101, serial="P")
    others = (("production", procedure), ("maintenance", start), ("manual", start))
    await rig.idle()
    for mode, request in others:
        await operator.ask(ModeCommand.model_validate({"mode": mode}))
        answer = await operator.ask(request)
        assert isinstance(answer, Refused), mode
        assert answer.code == RejectCode.OTHER_MODE
        wanted = "maintenance" if request is procedure else "production"
        assert answer.remedy == f"`cellctl mode {wanted}` first"
        report = await operator.status()
        assert (report.state, report.mode) == ("IDLE", mode.upper())
        assert report.permitted[request.request] == RejectCode.OTHER_MODE.text
    assert await rig.runs() == []


async def test_a_start_during_a_procedure_is_refused_by_the_state(
    rig: DaemonRig, operator: Operator
) -> None:
    await operator.ask(ModeCommand(mode="maintenance"))
    answer = await operator.ask(StartCommand(serial="S"))
    assert isinstance(answer, Refused)
    assert answer.code == RejectCode.COMMAND_NOT_ALLOWED, "in Stopped another mode does not help"


async def test_who_is_in_control_is_shown(rig: DaemonRig, operator: Operator) -> None:
    assert (await operator.status()).control == "shared"
    rig.port.line_alive = True
    assert (await operator.status()).control == "line"
    refused = await operator.plain("reset")
    assert isinstance(refused, Refused)
    assert refused.code == RejectCode.LINE_IN_CONTROL


async def test_a_stop_waits_for_no_directory_of_users(
    rig: DaemonRig, operator: Operator, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def never(*_: object) -> None:
        raise AssertionError("a Stop must not look up names")

    await rig.idle()
    monkeypatch.setattr(Users, "look_up", never)
    assert isinstance(await operator.ask(PlainCommand(request="stop"), 4_000_000), Taken)
    await rig.to(State.STOPPED)
    await rig.unit.background.drain()
    assert (await rig.archive.do(audit))[-1][:2] == ("terminal:4000000", "stop")


async def test_a_command_counts_from_when_it_was_given(rig: DaemonRig, operator: Operator) -> None:
    """A daemon that stood still may read a Stop first that was given after a Reset."""
    await rig.idle()
    given_s = now_s()
    await operator.plain("stop")
    await rig.to(State.STOPPED)
    resets = rig.states.count(State.RESETTING)
    reset = PlainCommand(request="reset")
    answer = await operator.ask(GivenCommand(given_s=given_s, command=reset))
    assert isinstance(answer, Refused)
    assert answer.code == RejectCode.SUPERSEDED
    assert rig.states.count(State.RESETTING) == resets
    assert isinstance(await operator.ask(GivenCommand(given_s=now_s(), command=reset)), Taken)


def test_a_terminal_waits_as_long_as_the_daemon_may_begin_what_it_asks_for() -> None:
    assert ANSWER_S >= MOST_AGE_S


async def test_an_unknown_user_is_a_number() -> None:
    users = Users()
    await users.look_up(4_000_000)
    assert users.name(4_000_000) == "4000000"
    assert f"terminal:{users.name(UID)}" == ME


async def test_faults_and_alarms_come_with_their_remedy(rig: DaemonRig, operator: Operator) -> None:
    await rig.idle()
    await rig.unit.machine.fail(LinkLost("aux_1"))
    await rig.to(State.ABORTED)
    await rig.unit.background.drain()
    report = await operator.status()
    assert [fault.text for fault in report.faults] == [str(LinkLost("aux_1"))]
    assert [(alarm.number, alarm.text) for alarm in report.alarms] == [
        (202, str(LinkLost("aux_1")))
    ]
    assert report.alarms[0].remedy == LinkLost.remedy
    assert report.faults[0].since == report.alarms[0].since is not None
    assert isinstance(await operator.ask(AcknowledgeCommand(number=202)), Taken)
    report = await operator.status()
    assert report.alarms == ()
    assert len(report.faults) == 1, "acknowledging releases nothing"


async def test_what_is_broken_is_said_and_not_raised(
    rig: DaemonRig, operator: Operator, monkeypatch: pytest.MonkeyPatch
) -> None:
    def gone(*_: object) -> None:
        raise StoreUnavailable("disk gone")

    rig.bench.cell.aux_2.faults["state"] = StaleData("2 s")
    rig.bench.cell.unanswered["head_1"] = DeviceAway("head_1: no answer within 2 s")
    rig.bench.cell.guard.trip = GuardTrip(TripReason.RAW_LIMIT, 1.0, "Fz 60 N", 2, 60.0)
    (rig.bench.calibrations.path / "head_1.json").unlink()
    monkeypatch.setattr(RunStore, "runs", gone)
    report = await operator.status()
    assert "F207" in report.links["robots.aux_2"]
    assert report.links["robots.main"] == ""
    assert "no answer within 2 s" in report.links["stereo_cameras.head_1"]
    assert report.links["stereo_cameras.head_2"] == ""
    assert report.guard_trip == "raw limit: Fz 60 N"
    assert "disk gone" in report.records
    assert "F632" in report.calibrations[0].problem
    assert [item.problem for item in report.calibrations[1:5]] == [""] * 4


async def test_a_dry_run_that_came_to_its_end_is_not_called_bad(
    rig: DaemonRig, operator: Operator
) -> None:
    await rig.idle()
    (recipe,) = rig.bench.as_cell.config.recipes
    start = StartCommand(serial="SAT-7", recipe=recipe.name, dry_run=True)
    assert isinstance(await operator.ask(start), Taken)
    await rig.to(State.COMPLETED)
    report = await operator.status()
    assert report.result == "done, no part"
    assert report.last_run is not None
    assert (report.last_run.result, report.last_run.ended_as) == ("bad", "done, no part")


async def test_the_touch_that_a_step_waits_for_is_told_as_what_it_is(
    rig: DaemonRig, operator: Operator
) -> None:
    rig.bench.cell.guard.trip = GuardTrip(TripReason.TOUCH, 1.0, "touch after 12 ms")
    report = await operator.status()
    assert (report.guard_trip, report.guard_touch) == ("touch: touch after 12 ms", "")
    rig.unit.board.update(contact=True)
    report = await operator.status()
    assert (report.guard_trip, report.guard_touch) == ("", "touch: touch after 12 ms")


async def test_a_refusal_names_what_the_cell_has(rig: DaemonRig, operator: Operator) -> None:
    await rig.idle()
    answer = await operator.ask(StartCommand(serial="S", recipe="unknown"))
    assert isinstance(answer, Refused)
    assert answer.known == tuple(f"{one.id} {one.name}" for one in rig.bench.as_cell.config.recipes)
    assert {"start", "mode", "stop"} <= {*answer.permitted}
    assert not {"unhold", "procedure"} & {*answer.permitted}
    await operator.ask(ModeCommand(mode="maintenance"))
    answer = await operator.ask(ProcedureCommand(number=9999, serial="P"))
    assert isinstance(answer, Refused)
    assert any(name.startswith("101 ") for name in answer.known)


async def test_the_status_has_forces_and_what_is_permitted(
    rig: DaemonRig, operator: Operator
) -> None:
    report = await operator.status()
    assert report.permitted["reset"] == ""
    assert report.permitted["unhold"] == RejectCode.COMMAND_NOT_ALLOWED.text
    (force,) = report.forces
    assert force.compensated
    assert [axis.axis for axis in force.wrench] == ["Fx", "Fy", "Fz", "Mx", "My", "Mz"]
    assert report.data_dir == str(rig.archive.path)


async def test_an_arm_that_presses_is_said_where_nothing_moves(
    rig: DaemonRig, operator: Operator
) -> None:
    guard = rig.bench.cell.guard
    guard.raw = np.tile([0.0, 12.0, -32.0, 0.0, 0.0, 0.0], (len(guard.raw), 1))
    (force,) = (await operator.status()).forces
    wrench = [axis.value or 0.0 for axis in force.wrench[:3]]
    assert force.presses_n == pytest.approx(np.linalg.norm(wrench))
    assert force.presses_n is not None
    assert force.presses_n > PRESSES_N
    await rig.unit.machine.command(Command.ABORT)
    await rig.to(State.ABORTED)
    assert (await operator.status()).forces[0].presses_n is not None
    guard.gravity_compensated = False
    assert (await operator.status()).forces[0].presses_n is None, "with the weight it says nothing"
    guard.gravity_compensated = True
    await rig.idle()
    assert (await operator.status()).forces[0].presses_n is None, "Idle: Reset has lifted off"


async def test_in_the_sensor_s_own_axes_only_the_magnitude_is_said(
    rig: DaemonRig, operator: Operator
) -> None:
    guard = rig.bench.cell.guard
    guard.raw = np.tile([0.0, 12.0, -52.0, 0.0, 0.0, 0.0], (len(guard.raw), 1))
    await guard.set_wrench_frame(None)
    (force,) = (await operator.status()).forces
    assert force.presses_n == pytest.approx(np.hypot(12.0, 52.0))
    assert {axis.value for axis in force.wrench} == {None}


async def test_a_force_that_the_zero_of_a_reset_hides_is_shown_with_it(
    rig: DaemonRig, operator: Operator
) -> None:
    """Stopped half way, 17 N were hidden and 6 N have gone: 11 N are still pressed with."""
    guard = rig.bench.cell.guard
    guard.hidden_axial_n = 17.0
    guard.raw = np.tile([0.0, 0.0, -6.0, 0.0, 0.0, 0.0], (len(guard.raw), 1))
    (force,) = (await operator.status()).forces
    assert force.wrench[2].value == pytest.approx(11.0)
    assert force.presses_n == pytest.approx(11.0)


async def test_what_a_compensation_leaves_of_a_load_is_no_contact(
    rig: DaemonRig, operator: Operator
) -> None:
    # Of 200 kg 2 % are 39 N. As after a Stop in Held, after a free move and before any tare.
    guard = rig.bench.cell.guard
    guard.raw = np.tile([0.0, 12.0, -32.0, 0.0, 0.0, 0.0], (len(guard.raw), 1))
    assert (await operator.status()).forces[0].presses_n is not None
    await guard.set_wrench_frame(None)
    assert (await operator.status()).forces[0].presses_n is None
    guard.in_part_frame, guard.hidden_axial_n = True, None  # as a guard that was started anew
    assert (await operator.status()).forces[0].presses_n is None


async def test_an_expired_calibration_is_called_so(rig: DaemonRig, operator: Operator) -> None:
    renew_calibrations(rig.bench.calibrations.path, timedelta(minutes=-1))
    report = await operator.status()
    assert report.calibrations[0].problem == "expired"
    assert report.calibrations[0].made is not None


async def test_a_robot_is_listened_to_through_the_daemon(
    rig: DaemonRig, operator: Operator
) -> None:
    terminal = operator._terminal
    answer = await terminal.handle(RobotRequest(name="main", seconds=0.5), UID)
    assert isinstance(answer, RobotAnswer)
    assert parse_answer(to_line(answer)) == answer, "survives the wire"
    assert answer.cell == rig.bench.as_cell.config.name
    assert answer.heard["reports"]["count"] > 3
    assert len(answer.heard["state"]["joints_deg"]) == 6
    with pytest.raises(MessageMalformed, match="this cell has main"):
        await terminal.handle(RobotRequest(name="leg", seconds=0.5), UID)
