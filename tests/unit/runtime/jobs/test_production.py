"""Whole runs through unit and line: good parts, stops, aborts, holds, and what is on record."""

import asyncio
from pathlib import Path

import numpy as np
import pytest

from cellctl.calibration.store.store import CalibrationStore
from cellctl.daemon.disk_watch import DiskWatch
from cellctl.errors.calibration import CalibrationInvalidated, CalibrationNotStored
from cellctl.errors.force import GuardDied
from cellctl.errors.line import LineLostInContact
from cellctl.errors.link import LinkLost
from cellctl.errors.records.store import RecordNotWritten, RunInterrupted
from cellctl.errors.robot import StopFailed
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.packml.command import Command
from cellctl.packml.reject import RejectCode
from cellctl.packml.result import Result
from cellctl.packml.state import State
from cellctl.processes.deck_to_frame.faults import ContactEarly
from cellctl.processes.deck_to_frame.process import DeckToFrame
from cellctl.records.entries import RunRecord, Verdict
from cellctl.records.figures import Limit
from cellctl.records.parts import mate_serial
from cellctl.records.required.required_figures import REQUIRED, not_measured, required
from cellctl.records.store import RunStore
from tests.unit.cell.bench import Bench
from tests.unit.daemon_rig import DaemonRig
from tests.unit.processes.deck_to_frame.rig import curve

LIMIT_FORCE_N = 50.0
GOOD_RUN = [
    State.RESETTING, State.IDLE, State.STARTING, State.EXECUTE, State.COMPLETING, State.COMPLETED,
]  # fmt: skip


def pin_offsets_mm(record: RunRecord) -> list[float]:
    found = record.newest_figures.items()
    return [entry.value or 0.0 for key, entry in found if key.startswith("pin_offsets.")]


async def test_a_good_part(rig: DaemonRig) -> None:
    seq = await rig.started(serial="SAT-7", mate_serial="FRAME-3", order="OP-3")
    await rig.to(State.COMPLETED)
    assert rig.states == GOOD_RUN
    assert rig.port.ended[seq] is Result.GOOD
    record = await rig.record()
    head = record.head
    assert (head.serial, head.operator, head.result, head.mode) == (
        "SAT-7", "OP-3", "good", "production",
    )  # fmt: skip
    assert mate_serial(record) == "FRAME-3"
    assert [entry.key for entry in record.measurements] == [
        "frame", "deck", "flange_T_deck", "seated",
    ]  # fmt: skip
    assert record.passes[-1].converged
    assert record.document("mating")["outcome"] == "seated"
    assert max(pin_offsets_mm(record)) < 0.05
    assert [(phase.number, phase.label) for phase in record.phases] == [
        (10, "measure frame"), (20, "measure deck"), (30, "pre-assembly"), (40, "correct pose"),
        (50, "mate"), (60, "verify"),
    ]  # fmt: skip
    assert record.phases[-1].ended is not None
    judged = {entry.key: entry.verdict for entry in record.figures if entry.verdict}
    assert set(judged.values()) == {Verdict.PASS}
    assert {"position_error", "angle_error", "peak_force", "pin_offsets.P1"} <= set(judged)
    assert rig.bench.cell.guard.asked[:2] == ["acknowledge", "set_gravity_compensation"]
    status = rig.shown()
    assert (status.run_number, status.run_result, status.serial) == (1, Result.GOOD, "SAT-7")
    assert status.cycle_counter == 1
    assert status.step == 0
    assert not status.error


async def test_a_part_is_not_good_by_a_calibration_that_is_withdrawn_meanwhile(
    rig: DaemonRig,
) -> None:
    rig.contact.may_end.clear()
    seq = await rig.started()
    await rig.contact.reached.wait()
    # As `cellctl calibrate invalidate` does it beside the daemon.
    known = rig.unit.calibrations
    beside = CalibrationStore(known.path, known.kinds)
    beside.invalidate([beside.named("head_1")], "a fork lift has met it")
    rig.contact.may_end.set()
    await rig.to(State.STOPPED)
    assert rig.port.ended[seq] is Result.STOPPED
    head = (await rig.record()).head
    assert (head.result, head.fault_number) == ("stopped", CalibrationInvalidated.number)
    assert "fork lift" in (head.fault or "")


async def test_a_figure_beyond_its_limit_is_no_good_part(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    judge = Limit.judge

    def too_strict(limit: Limit, value: float | None) -> Verdict | None:
        # The process itself goes on: it trusts its steps, of which one forgot to look.
        return Verdict.FAIL if limit.upper == LIMIT_FORCE_N else judge(limit, value)

    monkeypatch.setattr(Limit, "judge", too_strict)
    seq = await rig.started(serial="SAT-7")
    await rig.to(State.STOPPED)
    record = await rig.record()
    assert (record.head.result, record.head.fault_number) == ("bad", 811)
    assert "peak force" in (record.head.fault or "")
    assert rig.port.ended[seq] is not Result.GOOD
    assert rig.shown().run_result is Result.BAD
    assert rig.shown().cycle_counter == 0


async def test_several_parts_in_a_row(rig: DaemonRig) -> None:
    for number in (1, 2, 3):
        await rig.started(serial=f"SAT-{number}")
        await rig.to(State.COMPLETED)
        moves = rig.bench.cell.main.moves
        assert rig.contact.matings == number
        if number > 1:
            assert any(move.speed == pytest.approx(2e-3) for move in moves), "lifted off slowly"
        moves.clear()
    heads = [len(head.robot.moves) for head in rig.bench.cell.heads]  # type: ignore[attr-defined]
    assert heads == [1, 1], "in place since the first part"
    assert [run.result for run in await rig.runs()] == ["good"] * 3
    assert rig.shown().cycle_counter == 3
    await rig.restart()
    assert rig.shown().cycle_counter == 3


async def test_a_start_that_is_refused_leaves_the_order_alone(rig: DaemonRig) -> None:
    rig.contact.may_end.clear()
    await rig.started(serial="SAT-1")
    code = await rig.take(Command.START, serial="SAT-2")
    assert code is RejectCode.COMMAND_NOT_ALLOWED
    rig.contact.may_end.set()
    await rig.to(State.COMPLETED)
    assert [run.serial for run in await rig.runs()] == ["SAT-1"]


async def test_a_dry_run_ends_without_contact_and_without_a_good_part(rig: DaemonRig) -> None:
    seq = await rig.started(options=1)
    await rig.to(State.COMPLETED)
    assert rig.contact.matings == 0
    record = await rig.record()
    assert (record.head.mode, record.head.result) == ("dry run", "bad")
    assert record.passes[-1].converged
    assert rig.port.ended[seq] is Result.BAD
    assert rig.shown().cycle_counter == 0


async def test_single_step_holds_before_each_step_and_measures_anew(rig: DaemonRig) -> None:
    await rig.started(options=2)
    for held in range(1, 6):
        await rig.to(State.HELD)
        await rig.take(Command.UNHOLD)
        await rig.until(lambda held=held: rig.states.count(State.UNHOLDING) == held)  # type: ignore[misc]
    await rig.to(State.COMPLETED)
    assert [measurer.measured for measurer in rig.measurers] == [
        [],
        ["frame"],
        ["frame", "deck"],
        ["frame", "deck"],
        ["frame", "deck", "deck"],
        ["frame", "deck", "deck", "deck"],
    ]
    assert [run.result for run in await rig.runs()] == ["good"]


async def test_a_hold_in_contact_comes_too_late_and_that_is_shown(rig: DaemonRig) -> None:
    rig.contact.may_end.clear()
    await rig.started()
    await rig.contact.reached.wait()
    assert not rig.shown().safe_point_ahead
    await rig.take(Command.HOLD)
    assert rig.shown().hold_requested
    rig.contact.may_end.set()
    await rig.to(State.COMPLETED)
    assert rig.shown().safe_point_ahead
    assert State.HELD not in rig.states


async def test_a_hold_on_the_way_begins_again_and_ends_well(rig: DaemonRig) -> None:
    main = rig.bench.cell.main
    await rig.idle()
    main.on_the_way.clear()
    main.road_is_free = asyncio.Event()
    await rig.take(Command.START)
    await main.on_the_way.wait()
    await rig.take(Command.HOLD)
    assert rig.shown().hold_requested or rig.unit.machine.state is State.STARTING
    main.road_is_free.set()
    main.road_is_free = None
    if rig.unit.machine.state is State.STARTING:
        await rig.to(State.EXECUTE)
        await rig.take(Command.HOLD)
    await rig.to(State.HELD)
    await rig.take(Command.UNHOLD)
    await rig.to(State.COMPLETED)
    assert rig.contact.matings == 1
    assert len(rig.measurers) == 2
    assert rig.port.status.run_result is Result.GOOD


async def test_a_frame_that_moved_during_a_hold_is_found_where_it_is(rig: DaemonRig) -> None:
    await rig.started(options=2)
    for _ in range(3):
        await rig.to(State.HELD)
        await rig.take(Command.UNHOLD)
        await rig.until(lambda: rig.unit.machine.state is not State.HELD)
    await rig.to(State.HELD)  # before the compensation, the deck over the frame
    rig.bench.world.base_T_frame *= pose_from_xyzabc([2.0, 1.0, 0, 0.3, 0, 0])
    await rig.take(Command.UNHOLD)
    await rig.until(lambda: rig.unit.machine.state is not State.HELD)
    await rig.to(State.HELD)
    await rig.take(Command.UNHOLD)
    await rig.to(State.COMPLETED)
    record = await rig.record()
    assert max(pin_offsets_mm(record)) < 0.05


async def test_the_loop_has_a_number_only_while_it_lasts(rig: DaemonRig) -> None:
    told: list[tuple[int, int]] = []
    rig.unit.board.observers.append(lambda now: told.append((now.step, now.iteration)))
    await rig.started()
    await rig.to(State.COMPLETED)
    assert {step for step, iteration in told if iteration} == {40}
    assert rig.shown().iteration == 0


async def test_a_good_part_has_measured_all_that_it_requires_by_no_wider_limit(
    rig: DaemonRig,
) -> None:
    await rig.started()
    await rig.to(State.COMPLETED)
    record = await rig.record()
    asked, found = record.document(REQUIRED), record.newest_figures
    assert {"pin_offsets.P1", "seat_gap_by_vision", "peak_moment", "worst_residual.seated"} <= set(
        asked
    )
    for key, wanted in asked.items():
        # The worst angle is judged by the threshold of its own axis.
        most = 1e9 if wanted["upper"] is None else wanted["upper"]
        assert found[key].unit == wanted["unit"], key
        assert found[key].label == wanted["label"], key
        assert (found[key].upper or -1e9) <= most + 1e-12, key
        assert (found[key].lower is None) == (wanted["lower"] is None), key
    judged = {entry.key for entry in record.figures if entry.verdict} - {"seat_rotation"}
    assert judged == set(asked), "seat_rotation is the worst of seated_error"


async def test_a_run_that_is_cut_short_tells_what_it_has_not_measured(rig: DaemonRig) -> None:
    await in_contact(rig)
    await rig.take(Command.ABORT)
    await rig.to(State.ABORTED)
    lacking = {one.key for one in not_measured(await rig.record())}
    assert {"pin_offsets.P1", "seat_gap_by_vision", "hold_force", "force_while_verified"} <= lacking
    assert not {"worst_residual.frame", "position_error"} & lacking


async def test_a_part_without_a_required_figure_is_not_good(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    wanted = (required("torque", "N·m", Limit(upper=2.0)),)
    monkeypatch.setattr(DeckToFrame, "required", lambda _process, _run: wanted)
    await rig.started()
    await rig.to(State.STOPPED)
    head = (await rig.record()).head
    assert (head.result, head.fault_number) == ("bad", 811)
    assert "torque not measured" in (head.fault or "")


async def in_contact(rig: DaemonRig) -> int:
    rig.contact.may_end.clear()
    seq = await rig.started()
    await rig.contact.reached.wait()
    return seq


@pytest.mark.parametrize(
    ("command", "state", "result"),
    [
        (Command.STOP, State.STOPPED, "stopped"),
        (Command.ABORT, State.ABORTED, "aborted"),
        (Command.COMPLETE, State.COMPLETED, "bad"),
    ],
)
async def test_a_run_that_is_cut_short(
    rig: DaemonRig, command: Command, state: State, result: str
) -> None:
    await in_contact(rig)
    assert await rig.take(command) is RejectCode.NONE
    await rig.to(state)
    assert all(robot.latched for robot in rig.bench.cell.robots.values())
    assert "disarm" in rig.bench.cell.guard.asked
    record = await rig.record()
    assert record.head.result == result
    assert record.seal is not None
    assert any(a.name == "force-1.mcap" for a in record.artefacts), "the curve came in before"
    assert record.value("peak_force") == pytest.approx(np.abs(curve().wrench[:, 2]).max())
    assert rig.shown().run_result.name.lower() == result
    assert rig.shown().cycle_counter == 0
    await rig.idle()
    assert not any(robot.latched for robot in rig.bench.cell.robots.values())


async def test_a_move_is_stopped_before_the_run_is_closed(rig: DaemonRig) -> None:
    main = rig.bench.cell.main
    await rig.idle()
    main.on_the_way.clear()
    main.road_is_free = asyncio.Event()
    await rig.take(Command.START)
    await main.on_the_way.wait()
    here = main.flange
    await rig.take(Command.ABORT)
    await rig.to(State.ABORTED)
    assert main.flange is here
    assert main.stops >= 1
    assert [run.result for run in await rig.runs()] == ["aborted"]


async def test_a_fault_of_a_step_is_the_fault_of_its_run(rig: DaemonRig) -> None:
    rig.contact.fault = ContactEarly("at 4 mm")
    seq = await rig.started()
    await rig.to(State.STOPPED)
    head = (await rig.record()).head
    assert (head.result, head.fault_number) == ("stopped", 522)
    assert rig.port.ended[seq] is Result.STOPPED
    status = rig.shown()
    assert (status.first_out_alarm, status.alarms, status.error) == (522, (522,), True)
    assert [alarm.number for alarm in (await rig.record()).alarms] == [522]


async def test_a_deck_off_its_seat_is_a_bad_part(rig: DaemonRig) -> None:
    await in_contact(rig)
    rig.bench.world.flange_T_deck *= pose_from_xyzabc([0.5, 0, 0, 0, 0, 0])
    rig.contact.may_end.set()
    await rig.to(State.STOPPED)
    head = (await rig.record()).head
    assert (head.result, head.fault_number) == ("bad", 452)
    assert rig.shown().run_result is Result.BAD


async def test_a_defect_in_a_step_aborts_with_901(rig: DaemonRig) -> None:
    rig.contact.fault = ZeroDivisionError("defect")
    await rig.started()
    await rig.to(State.ABORTED)
    head = (await rig.record()).head
    assert (head.result, head.fault_number) == ("aborted", 901)


async def test_a_stop_that_fails_ends_aborted(rig: DaemonRig) -> None:
    await in_contact(rig)
    rig.bench.cell.aux_1.faults["stop"] = StopFailed("aux_1")
    await rig.take(Command.STOP)
    await rig.to(State.ABORTED)
    assert 304 in rig.shown().alarms
    assert (await rig.record()).head.result == "stopped"
    assert rig.shown().stop_not_confirmed
    assert "aux_1" in str(rig.unit.machine.fault)
    rig.bench.cell.aux_1.faults.clear()
    await rig.take(Command.CLEAR)
    await rig.to(State.STOPPED)
    assert not rig.shown().stop_not_confirmed


async def test_an_abort_overtakes_a_stop(rig: DaemonRig) -> None:
    await in_contact(rig)
    halting, may_stop = asyncio.Event(), asyncio.Event()

    async def slow_stop() -> None:
        halting.set()
        await may_stop.wait()

    rig.bench.cell.aux_1.stop = slow_stop  # type: ignore[method-assign]
    await rig.take(Command.STOP)
    await halting.wait()
    await rig.take(Command.ABORT)
    may_stop.set()
    await rig.to(State.ABORTED)
    assert [run.result for run in await rig.runs()] == ["aborted"]
    assert (await rig.record()).seal is not None


async def test_a_disk_that_fails_at_the_end_makes_no_good_part(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise RecordNotWritten("disk full")

    monkeypatch.setattr(RunStore, "close_run", full)
    seq = await rig.started()
    await rig.to(State.ABORTED)
    assert rig.port.ended[seq] is Result.ABORTED
    assert rig.shown().run_result is Result.ABORTED
    assert rig.shown().cycle_counter == 0
    await rig.take(Command.CLEAR)
    await rig.to(State.STOPPED)
    await rig.take(Command.RESET)
    await rig.to(State.IDLE)
    assert await rig.take(Command.START) is RejectCode.RECORDS_NOT_READY


async def test_a_run_that_the_disk_did_not_close_says_so_after_the_next_start(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise RecordNotWritten("disk full")

    with monkeypatch.context() as broken:
        broken.setattr(RunStore, "close_run", full)
        await rig.started()
        await rig.to(State.ABORTED)
    await rig.restart()
    (run,) = await rig.runs()
    assert (run.result, run.fault_number) == ("aborted", RecordNotWritten.number)
    assert run.fault is not None
    assert run.fault.endswith("disk full; written at the next start")
    assert rig.unit.machine.state is State.STOPPED
    assert rig.shown().alarms[0] == 803, "survives the restart"
    await rig.until(lambda: RunInterrupted.number in rig.shown().alarms)  # where the arm stands
    assert (rig.shown().run_number, rig.shown().run_result) == (1, Result.ABORTED)


async def test_the_fault_that_ended_a_run_is_kept_until_the_disk_takes_it(
    rig: DaemonRig, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise RecordNotWritten("disk full")

    with monkeypatch.context() as broken:
        broken.setattr(RunStore, "close_run", full)
        broken.setattr(RunStore, "keep_end", full)
        rig.contact.may_end.clear()
        await rig.started()
        await rig.contact.reached.wait()
        await rig.unit.machine.fail(LineLostInContact("in step mate"))
        await rig.to(State.ABORTED)
    await DiskWatch(rig.archive, rig.unit).look()
    with monkeypatch.context() as broken:
        broken.setattr(RunStore, "keep_end", full)
        await rig.restart()
    (run,) = await rig.runs()
    assert (run.result, run.fault_number) == ("aborted", LineLostInContact.number)
    assert run.fault is not None
    assert "in step mate; the end of the run could not be recorded (F803" in run.fault


async def test_the_line_reads_the_result_of_the_last_run_after_a_restart(rig: DaemonRig) -> None:
    assert (rig.shown().run_number, rig.shown().run_result) == (0, Result.NONE)
    await rig.started()
    await rig.to(State.COMPLETED)
    before = rig.shown()
    await rig.restart()
    after = rig.shown()
    assert after.run_number == before.run_number == 1
    assert after.run_result is before.run_result is Result.GOOD
    assert (after.serial, after.recipe_active) == (before.serial, before.recipe_active)
    assert after.serial


async def test_no_record_no_motion(rig: DaemonRig, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise RecordNotWritten("disk full")

    monkeypatch.setattr(RunStore, "start_run", full)
    await rig.idle()
    await rig.take(Command.START)
    await rig.to(State.ABORTED)
    assert not any(robot.moves for robot in rig.bench.cell.robots.values())
    assert await rig.runs() == []


async def test_another_head_than_the_calibrated_one_moves_nothing(rig: DaemonRig) -> None:
    rig.bench.cell.head_2.camera.serial = "FH-0815"  # type: ignore[attr-defined]
    await rig.started()
    await rig.to(State.STOPPED)
    assert rig.shown().first_out_alarm == 631
    assert not any(robot.moves for robot in rig.bench.cell.robots.values())


async def test_reset_does_not_move_a_robot_that_is_not_ready(rig: DaemonRig) -> None:
    rig.bench.cell.main.flange = rig.bench.flange_over_seat(0.0)
    rig.bench.cell.aux_2.looks["drives_on"] = False
    await rig.take(Command.RESET)
    await rig.to(State.ABORTED)
    assert rig.shown().first_out_alarm == 303
    assert rig.bench.cell.main.moves == []


async def test_reset_rearms_the_guard_or_fails(rig: DaemonRig) -> None:
    rig.bench.cell.guard.faults["acknowledge"] = GuardDied("killed")
    await rig.take(Command.RESET)
    await rig.to(State.ABORTED)
    assert rig.shown().first_out_alarm == 510


async def test_a_link_lost_in_the_middle_stops_all_robots(rig: DaemonRig) -> None:
    await in_contact(rig)
    await rig.unit.machine.fail(LinkLost("aux_1"))
    await rig.to(State.ABORTED)
    assert all(robot.stops for robot in rig.bench.cell.robots.values())
    assert (await rig.record()).head.fault_number == 202


async def test_a_lost_line_holds_and_nothing_resumes_by_itself(rig: DaemonRig) -> None:
    main = rig.bench.cell.main
    await rig.idle()
    main.on_the_way.clear()
    main.road_is_free = asyncio.Event()
    await rig.take(Command.START)
    await main.on_the_way.wait()
    rig.unit.line_lost()
    await rig.until(lambda: 701 in rig.shown().alarms)
    main.road_is_free.set()
    main.road_is_free = None
    await rig.to(State.HELD)
    moves = len(main.moves)
    for _ in range(50):
        await asyncio.sleep(0)
    assert rig.unit.machine.state is State.HELD
    assert len(main.moves) == moves
    await rig.take(Command.UNHOLD)
    await rig.to(State.COMPLETED)
    assert rig.shown().warning, "until somebody acknowledges"


async def test_closing_aborts_and_seals(rig: DaemonRig) -> None:
    await in_contact(rig)
    await rig.unit.close()
    assert rig.unit.machine.state is State.ABORTED
    assert [run.result for run in await rig.runs()] == ["aborted"]
    assert await rig.take(Command.CLEAR) is RejectCode.NONE
    await rig.to(State.STOPPED)
    assert await rig.take(Command.RESET) is RejectCode.DEVICE_NOT_READY


async def test_a_daemon_that_could_not_keep_a_calibration_does_not_start(
    bench: Bench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    bench.cell.config = bench.cell.config.model_copy(update={"calibration_dir": "/dev/null/x"})
    rig = DaemonRig(bench, tmp_path / "store", monkeypatch)
    with pytest.raises(CalibrationNotStored):
        await rig.open()
    await rig.close()
