"""Operator commands against a daemon, and every one of them that the documents show."""

import contextlib
import io
import json
import os
import re
import shlex
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console
from typer.testing import CliRunner, Result

from cellctl.api.local_socket.messages import (
    AcknowledgeCommand,
    ModeCommand,
    PlainCommand,
    ProcedureCommand,
    Refused,
    StartCommand,
)
from cellctl.api.local_socket.report import (
    AxisReport,
    CalibrationReport,
    FaultReport,
    ForceReport,
    RunReport,
    StatusReport,
)
from cellctl.api.local_socket.socket_file import default_path
from cellctl.cli import nearest_cell
from cellctl.cli.commands import whole_app
from cellctl.cli.operator.daemon_client import DaemonClient
from cellctl.cli.operator.status_screen import screen
from cellctl.clock import utc_now
from cellctl.errors import CellError
from cellctl.errors.local import (
    CommandMissedItsGoal,
    CommandRefused,
    DaemonNotReached,
    DaemonSlow,
    MessageMalformed,
    StopNotDelivered,
)
from cellctl.records import RunStore
from tests.unit.cli.agreeable import AT_REST, Agreeable, listening
from tests.unit.records.sample import good_run

DOCS = Path(__file__).parents[4] / "docs"
OPERATOR = "status|clear|reset|start|procedure|hold|unhold|stop|abort|mode|alarms"
ALARM = FaultReport(
    number=501,
    text="F501 silent",
    cause="Cable.",
    remedy="Look.",
    since=datetime(2026, 3, 4, 5, 6, 7, tzinfo=UTC),
)
EARLIER = FaultReport(number=742, text="F742 SAT-1 was made", cause="It was.", remedy="Look.")
PRESSING = ForceReport(
    sensor="force", age_s=0.001, compensated=True, limit_n=50.0, presses_n=34.5, wrench=()
)
FAULT = FaultReport(number=202, text="F202 lost: aux_1", cause="Cable.", remedy="Find out why.")


@pytest.fixture
def daemon(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Agreeable]:
    daemon = Agreeable()
    monkeypatch.setenv("CELLCTL_SOCKET", str(tmp_path / "s"))
    with listening(tmp_path / "s", daemon):
        yield daemon


def cellctl(*arguments: str) -> Result:
    return CliRunner().invoke(whole_app(), list(arguments))


def fault_of(result: Result) -> type[BaseException]:
    assert result.exception is not None, result.output
    assert isinstance(result.exception, CellError), result.output
    return type(result.exception)


@pytest.mark.parametrize("name", ["clear", "reset", "hold", "unhold", "stop", "abort"])
def test_a_command_is_told_and_waited_for(daemon: Agreeable, name: str) -> None:
    done = cellctl(name)
    assert done.exit_code == 0, done.output
    assert [request.request for request in daemon.asked] == [name]
    assert daemon.shows["state"].lower() in done.output


def test_parameters_arrive(daemon: Agreeable) -> None:
    assert cellctl("start", "--serial", "S-1", "--recipe", "panel", "--dry-run").exit_code == 0
    assert cellctl("procedure", "107", "--wait").exit_code == 0
    assert cellctl("mode", "maintenance").exit_code == 0
    assert cellctl("alarms", "acknowledge", "F202").exit_code == 0
    assert daemon.asked == [
        StartCommand(serial="S-1", recipe="panel", dry_run=True),
        ProcedureCommand(number=107, serial="PROCEDURE-107"),
        ModeCommand(mode="maintenance"),
        AcknowledgeCommand(number=202),
    ]


@pytest.mark.parametrize(
    "arguments",
    [["start"], ["mode", "automatic"], ["procedure", "x"], ["procedure"], ["alarms", "all"]],
)
def test_what_is_mistyped_asks_for_nothing(daemon: Agreeable, arguments: list[str]) -> None:
    assert cellctl(*arguments).exit_code == 2
    assert daemon.asked == []


@pytest.mark.parametrize(
    "arguments",
    [["procedure", "0"], ["start", "--serial", "S" * 25], ["alarms", "acknowledge", "0"]],
)
def test_what_no_message_can_say_is_a_numbered_fault(
    daemon: Agreeable, arguments: list[str]
) -> None:
    assert fault_of(cellctl(*arguments)) is MessageMalformed
    assert daemon.asked == []


def test_a_refusal_is_a_numbered_fault_with_its_reason(daemon: Agreeable) -> None:
    daemon.refusal = Refused(code=0x10B, text="the line PLC is in control", state="STOPPED")
    done = cellctl("reset")
    assert fault_of(done) is CommandRefused
    assert "0x10B the line PLC is in control (state Stopped)" in str(done.exception)


def test_a_refusal_names_what_there_is_and_what_is_permitted(daemon: Agreeable) -> None:
    daemon.refusal = Refused(
        code=0x102,
        text="no recipe",
        state="IDLE",
        permitted=("start", "stop"),
        known=("1 panel", "2 deck"),
        remedy="think of another one",
    )
    text = str(cellctl("start", "--serial", "S").exception)
    assert "this cell has 1 panel, 2 deck" in text
    assert "permitted now: start, stop" in text
    assert "; think of another one; " in text


def test_a_run_step_by_step_holds_where_it_should(daemon: Agreeable) -> None:
    daemon.leads_to["start"] = "HELD"
    assert fault_of(cellctl("start", "--serial", "S", "--wait")) is CommandMissedItsGoal
    for wait in ((), ("--wait",)):
        done = cellctl("start", "--serial", "S", "--single-step", *wait)
        assert done.exit_code == 0, done.output
        assert "`cellctl unhold` carries it out" in done.output


def test_alarms_of_a_start_are_told(daemon: Agreeable) -> None:
    older = ALARM
    daemon.shows["alarms"] = (older,)
    daemon.comes_with["start"] = (older, EARLIER)
    said = cellctl("start", "--serial", "S").output
    assert f"alarm {EARLIER.text}" in said
    assert older.text not in said
    assert "not yet acknowledged: F501; see `cellctl alarms`" in said


def test_an_alarm_that_an_earlier_part_has_too_is_told_of_this_one(
    daemon: Agreeable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The list of active alarms has each number once, with the part that it came with first."""
    store = RunStore(tmp_path / "store")
    number = good_run(store)
    store.add_alarm(number, ALARM.number, f"F{ALARM.number} of this part")
    store.close()
    daemon.shows |= {"alarms": (ALARM,), "data_dir": str(tmp_path / "store")}
    daemon.on_its_way_to = "EXECUTE"
    begun = RunReport(
        number=number, serial="S", recipe="r", mode="production", started=utc_now(), result=""
    )

    def nap(_s: float) -> None:
        daemon.shows |= {"state": "EXECUTE", "state_requested": "EXECUTE", "last_run": begun}

    monkeypatch.setattr(time, "sleep", nap)
    said = cellctl("start", "--serial", "S").output
    assert f"alarm F{ALARM.number} of this part" in said
    assert ALARM.text not in said


def test_an_arm_that_presses_is_told_with_what_to_do(daemon: Agreeable) -> None:
    daemon.shows["forces"] = (PRESSING,)
    for name in ("abort", "clear"):
        said = cellctl(name).output
        assert "an arm may press: 34.5 N at force; just after a stop" in said
        assert "One that hangs free: leave the gripper closed" in said
    daemon.shows["forces"] = ()
    assert "presses" not in cellctl("abort").output


def test_a_dry_run_ends_as_one(daemon: Agreeable) -> None:
    daemon.shows["result"] = "bad"
    done = cellctl("start", "--serial", "S", "--dry-run", "--wait")
    assert done.exit_code == 0, done.output
    assert "dry run has ended" in done.output
    daemon.leads_to["start"] = "ABORTED"
    assert fault_of(cellctl("start", "--serial", "S", "--dry-run", "--wait")) is (
        CommandMissedItsGoal
    )


def test_the_end_of_a_run_is_shown_as_its_record(daemon: Agreeable, tmp_path: Path) -> None:
    store = RunStore(tmp_path / "store")
    number = good_run(store)
    store.close()
    daemon.shows["data_dir"] = str(tmp_path / "store")
    daemon.shows["last_run"] = RunReport(
        number=number, serial="S", recipe="r", mode="production", started=utc_now(), result="good"
    )
    done = cellctl("start", "--serial", "S", "--wait")
    assert done.exit_code == 0, done.output
    assert cellctl("runs", "show", str(number), "--data-dir", str(store.path)).output in done.output


def test_a_run_that_ended_bad_is_shown_as_its_record_too(
    daemon: Agreeable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = RunStore(tmp_path / "store")
    number = good_run(store)
    store.close()
    daemon.leads_to["start"] = "EXECUTE"
    ended = RunReport(
        number=number, serial="S", recipe="r", mode="production", started=utc_now(), result="bad"
    )

    def nap(_s: float) -> None:
        daemon.shows |= {"state": "STOPPED", "state_requested": "STOPPED", "result": "bad"}
        daemon.shows |= {"last_run": ended, "faults": (FAULT,)}

    monkeypatch.setattr(time, "sleep", nap)
    daemon.shows["data_dir"] = str(tmp_path / "store")
    done = cellctl("start", "--serial", "S", "--wait")
    assert fault_of(done) is CommandMissedItsGoal
    assert "STOPPED: F202 lost" in str(done.exception)
    assert cellctl("runs", "show", str(number), "--data-dir", str(store.path)).output in done.output


def test_a_reset_that_ends_in_aborted_failed(daemon: Agreeable) -> None:
    daemon.leads_to["reset"] = "ABORTED"
    daemon.shows["faults"] = (FAULT,)
    done = cellctl("reset")
    assert fault_of(done) is CommandMissedItsGoal
    assert "ABORTED: F202 lost" in str(done.exception)


@pytest.mark.parametrize("newest", ["stop", "reset"])
def test_whose_command_led_elsewhere_is_said(
    daemon: Agreeable, tmp_path: Path, newest: str
) -> None:
    with contextlib.closing(RunStore(tmp_path / "store")) as store:
        store.audit("terminal:bo", "stop")
        store.audit("terminal:ann", newest)
    daemon.leads_to["reset"] = "STOPPED"
    daemon.shows["data_dir"] = str(tmp_path / "store")
    done = cellctl("reset")
    assert fault_of(done) is CommandMissedItsGoal
    said = "STOPPED by the command stop of terminal:ann, " in str(done.exception)
    assert said is (newest == "stop")


@pytest.mark.parametrize("arguments", [["start", "--serial", "S"], ["procedure", "101"]])
def test_only_a_good_end_is_a_success(daemon: Agreeable, arguments: list[str]) -> None:
    daemon.shows["result"] = "bad"
    assert cellctl(*arguments).exit_code == 0
    assert fault_of(cellctl(*arguments, "--wait")) is CommandMissedItsGoal


def test_whoever_waits_for_a_run_sees_its_steps(
    daemon: Agreeable, monkeypatch: pytest.MonkeyPatch
) -> None:
    daemon.leads_to["start"] = "EXECUTE"
    coming = iter(("10 measure frame", "10 measure frame", "20 measure deck", ""))

    def nap(_s: float) -> None:
        step = next(coming)
        daemon.shows |= {"step": step, "state": "EXECUTE" if step else "COMPLETED"}

    monkeypatch.setattr(time, "sleep", nap)
    done = cellctl("start", "--serial", "S", "--wait")
    assert done.exit_code == 0, done.output
    assert done.stderr.splitlines() == ["10 measure frame", "20 measure deck"]


@pytest.mark.parametrize(
    ("words", "leads_to", "what"),
    [
        (("start", "--serial", "S", "--wait"), "EXECUTE", "the run goes on"),
        (("procedure", "107", "--wait"), "EXECUTE", "the run goes on"),
        (("reset",), "RESETTING", "the cell goes on with the command reset"),
        (("hold",), "EXECUTE", "the Hold stays asked for"),
    ],
)
def test_ctrl_c_ends_the_waiting_alone_and_says_so(
    daemon: Agreeable,
    monkeypatch: pytest.MonkeyPatch,
    words: tuple[str, ...],
    leads_to: str,
    what: str,
) -> None:
    daemon.leads_to[words[0]] = leads_to
    daemon.on_its_way_to = "" if "--wait" in words else "IDLE"

    def interrupted(_s: float) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(time, "sleep", interrupted)
    done = cellctl(*words)
    assert done.exit_code == 130, done.output
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"only the waiting has ended, {what}")
    assert "`cellctl stop` ends motion and run" in line
    assert [request.request for request in daemon.asked] == [words[0]], "nothing was stopped"


def test_a_hold_that_comes_too_late_says_so_and_is_no_fault(
    daemon: Agreeable, monkeypatch: pytest.MonkeyPatch
) -> None:
    daemon.leads_to["hold"], daemon.on_its_way_to = "EXECUTE", "HELD"
    daemon.shows |= {"hold_requested": True, "safe_point_ahead": False, "step": "mate"}
    coming = iter(("mate", "verify", "verify", ""))

    def nap(_s: float) -> None:
        if step := next(coming):
            daemon.shows |= {"step": step}
        else:
            ended = {"state": "COMPLETED", "state_requested": "COMPLETED"}
            daemon.shows |= {"step": "", "hold_requested": False, **ended}

    monkeypatch.setattr(time, "sleep", nap)
    done = cellctl("hold")
    assert done.exit_code == 0, done.exception
    said = "no safe point is left before the end of the run"
    assert [line.split(",")[0] for line in done.stderr.splitlines()] == [
        f"mate: {said}",
        f"verify: {said}",
    ]
    assert "the run came to its end before a safe point; nothing is held" in done.stdout


def test_a_hold_that_a_stop_ends_is_a_fault(daemon: Agreeable) -> None:
    daemon.leads_to["hold"] = "STOPPED"
    assert fault_of(cellctl("hold")) is CommandMissedItsGoal


def test_what_takes_too_long_is_not_waited_for(
    daemon: Agreeable,
) -> None:
    times_s = iter(range(0, 1000, 50))
    daemon.leads_to["reset"], daemon.on_its_way_to = "RESETTING", "IDLE"
    client = DaemonClient(Path(os.environ["CELLCTL_SOCKET"]), clock=lambda: next(times_s))
    client.command(PlainCommand(request="reset"))
    with pytest.raises(CommandMissedItsGoal, match="still RESETTING after 60 s"):
        client.settled()


@pytest.mark.parametrize("command", ["status", "abort"])
def test_a_daemon_that_is_there_and_slow_is_told_from_one_that_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, command: str
) -> None:
    monkeypatch.setattr(DaemonClient._ask, "__defaults__", (0.2,))
    path = tmp_path / "s"
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(path))
        listener.listen()
        done = cellctl(command, "--socket", str(path))
    assert fault_of(done) is (DaemonSlow if command == "status" else StopNotDelivered)
    facts = str(done.exception)
    assert re.search(r": no answer within 0\.[2-9] s; ", facts), facts
    assert f"process {os.getpid()} is alive" in facts
    assert re.search(r"[\d.]+ programs on average wanted the \d+ processors", facts)


def test_no_daemon_is_a_numbered_fault(tmp_path: Path) -> None:
    done = cellctl("status", "--socket", str(tmp_path / "none"))
    assert fault_of(done) is DaemonNotReached


@pytest.mark.parametrize("name", ["stop", "abort"])
def test_a_stop_that_reaches_nobody_says_that_nothing_was_stopped(
    tmp_path: Path, name: str
) -> None:
    done = cellctl(name, "--socket", str(tmp_path / "none"))
    assert fault_of(done) is StopNotDelivered
    assert str(tmp_path / "none") in str(done.exception)


def test_status_for_programs(daemon: Agreeable) -> None:
    done = cellctl("status", "--json")
    assert StatusReport.model_validate_json(done.output).state == "STOPPED"
    assert json.loads(done.output)["links"] == {"robots.main": "", "guard": ""}


def test_status_is_followed_until_it_is_interrupted(
    daemon: Agreeable, monkeypatch: pytest.MonkeyPatch
) -> None:
    naps = iter((None, None, KeyboardInterrupt()))

    def nap(_s: float) -> None:
        interrupt = next(naps)
        if interrupt is not None:
            raise interrupt

    monkeypatch.setattr(time, "sleep", nap)
    done = cellctl("status", "--watch")
    assert done.exit_code == 0, done.output
    assert "Stopped" in done.output


def test_a_daemon_that_dies_is_not_shown_as_if_it_lived(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CELLCTL_SOCKET", str(tmp_path / "s"))
    with contextlib.ExitStack() as alive:
        alive.enter_context(listening(tmp_path / "s", Agreeable()))
        naps = iter((alive.close, None))

        def nap(_s: float) -> None:
            end = next(naps)
            if end is None:
                raise KeyboardInterrupt
            end()

        monkeypatch.setattr(time, "sleep", nap)
        done = cellctl("status", "--watch")
    assert done.exit_code == 0, done.output
    final = done.output[done.output.rindex("F714") :]
    assert "last seen at" in final
    assert "Stopped" in final
    assert "good" not in final, "nothing of it is said to be well"


def test_alarms_are_listed_with_their_remedy(daemon: Agreeable) -> None:
    assert "no alarms" in cellctl("alarms").output
    assert json.loads(cellctl("alarms", "--json").output) == []
    daemon.shows["alarms"] = (FAULT, ALARM)
    listed = cellctl("alarms").output
    assert "F202 lost: aux_1" in listed
    assert "Find out why." in listed
    assert "F501 silent, since 2026-03-04 05:06:07 UTC" in listed
    first, second = json.loads(cellctl("alarms", "--json").output)
    assert (first["number"], first["remedy"]) == (202, FAULT.remedy)
    assert datetime.fromisoformat(second["since"]) == ALARM.since


def test_the_screen_says_what_matters() -> None:
    now = utc_now()
    shows = AT_REST | {
        "state": "HOLDING",
        "state_requested": "HELD",
        "control": "line",
        "line_alive": True,
        "step": "compensate",
        "iteration": 2,
        "errors": (
            AxisReport(axis="x", unit="mm", value=0.0711, limit=0.05),
            AxisReport(axis="rz", unit="°", value=None, limit=0.005),
        ),
        "forces": (
            ForceReport(
                sensor="force",
                age_s=0.001,
                compensated=True,
                limit_n=50.0,
                wrench=(AxisReport(axis="Fz", unit="N", value=-12.34),),
            ),
        ),
        "permitted": {"stop": "", "start": "not now"},
        "faults": (FAULT,),
        "alarms": (FAULT, ALARM),
        "guard_trip": "raw limit: Fz 60 N",
        "links": {"robots.main": "F207 too old", "guard": ""},
        "calibrations": (
            CalibrationReport(
                kind="head_1", made=now - timedelta(days=5, hours=1), valid_until=now
            ),
            CalibrationReport(kind="payload", problem="F632 missing"),
        ),
        "last_run": RunReport(
            number=7, serial="SAT-7", recipe="panel", mode="production", started=now, result=""
        ),
    }
    console = Console(width=100, record=True, file=io.StringIO())
    console.print(screen(StatusReport(**shows), now))
    text = console.export_text()
    for words in (
        "Holding, on its way to Held",
        "line PLC; here only",
        "compensate, pass 2",
        "7, SAT-7, panel",
        "open",
        "Fz 60 N",
        "robots.main: F207 too old",
        "line PLC alive",
        "Find out why.",
        "x 0.0711 of ±0.05 mm, rz –",
        "Fz -12.3 N; limit 50 N",
        "F501 silent, since 2026-03-04 05:06:07 UTC",
        "5 d",
        "F632 missing",
    ):
        assert words in text, words
    assert re.search(r"permitted +stop", text)
    assert text.count("F202") == 1, "a latched fault is not shown again as an alarm"
    assert len(text.splitlines()) <= 30


def test_the_screen_calls_an_awaited_touch_no_stop_request() -> None:
    now = utc_now()
    console = Console(width=100, record=True, file=io.StringIO())
    touched = AT_REST | {"guard_touch": "touch: after 12 ms"}
    console.print(screen(StatusReport(**touched), now))
    text = " ".join(console.export_text().split())
    assert "guard good; stopped at the touch that the step looks for: touch: after 12 ms" in text
    assert "stop requested" not in text


@pytest.mark.parametrize(
    ("shows", "words"),
    [
        ({"state": "ABORTED"}, "look why it was aborted, then `cellctl clear`"),
        ({"state": "ABORTED", "faults": (FAULT,)}, "remove the cause of the fault, then"),
        ({"state": "IDLE", "mode": "MAINTENANCE"}, "`cellctl procedure NUMBER`"),
        ({"state": "IDLE", "mode": "MANUAL"}, "in Manual nothing is started"),
        ({"state": "STOPPED"}, "`cellctl reset`"),
        ({"state": "IDLE", "permitted": {"start": ""}}, "`cellctl start --serial SERIAL`"),
        ({"state": "IDLE", "permitted": {"start": "a calibration"}}, "refused: a calibration"),
        (
            {"state": "IDLE", "permitted": {"start": "the run store"}, "records": "F803"},
            "refused: the run store; `records` below says",
        ),
        ({"state": "EXECUTE"}, "`cellctl hold`"),
        ({"state": "EXECUTE", "safe_point_ahead": False}, "a Hold would come too late"),
        (
            {
                "state": "EXECUTE",
                "state_requested": "HELD",
                "hold_requested": True,
                "safe_point_ahead": False,
            },
            "wait; the Hold comes too late",
        ),
        ({"state": "HELD"}, "`cellctl unhold`"),
        # Of a run that joined a good part, `test_status_screen` tells the opposite.
        ({"state": "COMPLETED"}, "leave its gripper closed"),
        ({"state": "COMPLETED", "mode": "MAINTENANCE"}, "the guide of the procedure"),
        ({"state": "CLEARING", "state_requested": "STOPPED"}, "wait"),
    ],
)
def test_the_screen_says_what_to_do_next(shows: dict[str, Any], words: str) -> None:
    there = AT_REST | {"state_requested": shows["state"]} | shows
    console = Console(width=120, record=True, file=io.StringIO())
    console.print(screen(StatusReport(**there), utc_now()))
    (line,) = [line for line in console.export_text().splitlines() if line.startswith("next")]
    assert words in line


def documented() -> list[str]:
    """Operator commands as the documents show them, in their order."""
    pages = (DOCS / name for name in ("operating.md", "commissioning.md"))
    text = "\n".join(page.read_text(encoding="utf-8") for page in pages)
    found = re.findall(rf"^    (cellctl (?:{OPERATOR})\b[^#\n]*)", text, re.MULTILINE)
    found += re.findall(rf"`(cellctl (?:{OPERATOR})\b[^`\n]*)`", text)
    return list(dict.fromkeys(command.strip() for command in found))


@pytest.mark.parametrize("command", documented())
def test_what_the_documents_show_runs(
    daemon: Agreeable, command: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(_s: float) -> None:
        raise KeyboardInterrupt

    if "--watch" in command:
        monkeypatch.setattr(time, "sleep", interrupt)
    done = cellctl(*shlex.split(command)[1:])
    assert done.exit_code == 0, (command, done.output, done.exception)


def test_the_documents_show_every_command() -> None:
    shown = {command.split()[1] for command in documented()}
    assert shown == set(OPERATOR.split("|"))


@pytest.mark.parametrize("words", [["abort"], ["--debug", "alarms"]])
def test_an_abort_waits_for_no_library_that_computes(words: list[str], tmp_path: Path) -> None:
    """Loading these takes seconds, of an Abort's time and of the daemon's processor."""
    code = (
        "import sys\n"
        f"sys.argv = ['cellctl', *{words!r}]\n"
        "from cellctl.cli.app import main\n"
        "try:\n"
        "    main()\n"
        "finally:\n"
        "    print(*sys.modules)\n"
    )
    environment = os.environ | {"CELLCTL_SOCKET": str(tmp_path / "absent.sock")}
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        env=environment,
    )
    loaded = set(done.stdout.split())
    assert "cellctl.cli.operator.daemon_client" in loaded
    assert not loaded & {"numpy", "scipy", "cv2", "matplotlib", "sqlalchemy", "transitions"}


def test_the_service_is_found_where_its_unit_puts_the_socket(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    unit = (DOCS.parent / "systemd" / "cellctl.service").read_text(encoding="utf-8")
    (name,) = re.findall(r"^RuntimeDirectory=(\w+)$", unit, re.MULTILINE)
    monkeypatch.setenv("RUNTIME_DIRECTORY", f"/run/{name}")
    assert default_path(Path("elsewhere")) == nearest_cell.SERVICE_SOCKET
