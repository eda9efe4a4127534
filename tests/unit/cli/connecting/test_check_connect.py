"""`cellctl check --connect` against a small fake cell on the wire: all are asked, nothing moves."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from cellctl.cli.commands import whole_app
from cellctl.errors.local import CellInUse
from tests.rigs.whole_cell.own_cell import ROOT, OwnCell
from tests.rigs.wire.ports import free_port

ROBOT, CAMERA, SENSOR = "robots.arm", "cameras.camera", "force_sensors.force"
CHANNEL = f"{SENSOR}.stop_channel"


@pytest.fixture(scope="module")
def standing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[OwnCell]:
    cell = OwnCell.make(tmp_path_factory.mktemp("asked"), "small")
    cell.fake().ready()
    yield cell
    cell.kill_all()


@pytest.fixture
def own(standing: OwnCell, tmp_path: Path) -> Iterator[OwnCell]:
    """A cell file of this test for the fake cell; its arm may not have moved at the end."""
    visitor = standing.visited_from(tmp_path)
    visitor.change('data_dir = "runs/small"', f'data_dir = "{tmp_path / "store"}"')
    with visitor.control() as control:
        control.request("watch_begin")
        yield visitor
        assert not any(control.request("watched")["motions"].values())


def run(own: OwnCell, *words: str) -> Result:
    words = ("check", str(own.cell), "--connect", *words)
    return CliRunner().invoke(whole_app(), words, catch_exceptions=False)


def devices(own: OwnCell, exit_code: int = 0) -> dict[str, dict[str, Any]]:
    done = run(own, "--json")
    assert done.exit_code == exit_code, done.output
    report = json.loads(done.stdout)
    assert (report["good"], report["errors"]) == (exit_code == 0, [])
    return {device["path"]: device for device in report["devices"]}


def faults(device: dict[str, Any]) -> list[int]:
    return [fault["number"] for fault in device["faults"]]


def test_every_device_says_who_it_is(own: OwnCell) -> None:
    found = devices(own)
    assert list(found) == [ROBOT, CAMERA, SENSOR, CHANNEL, "plc"]
    assert all(device["good"] and not faults(device) for device in found.values())
    assert "ARM-1, job program" in found[ROBOT]["facts"]["CMD"]
    assert "p50" in found[ROBOT]["facts"]["reports"]
    assert found[CAMERA]["serial_number"] == "FC-0001"
    assert found[CAMERA]["facts"]["image"].startswith("1224 x 1024 px")
    assert "to that of this PC" in found[CAMERA]["facts"]["clock"]
    assert "FAKE" in found[SENSOR]["serial_number"]
    assert "of its own" in (samples := found[SENSOR]["facts"]["samples"]) or "Hz by" in samples
    assert "N in axes of the flange" in found[SENSOR]["facts"]["force"]
    assert "mm of the base" in found[CHANNEL]["facts"]["flange"]
    assert not found["plc"]["answered"], "the line calls, it cannot be asked"
    assert f"{own.modbus_port} is free" in found["plc"]["facts"]["port"]


def test_a_latch_is_left_as_it_was_found(tmp_path: Path) -> None:
    """The links of the first call end with it, for which this controller latches."""
    fresh = OwnCell.make(tmp_path, "small")
    try:
        fresh.fake().ready()
        for latch in ("not set", "set", "set"):
            found = devices(fresh)[ROBOT]
            assert found["facts"]["stop latch, as found"] == latch
            noted = any("stop is latched" in note for note in found["notes"])
            assert noted == (latch == "set")
    finally:
        fresh.kill_all()


def test_words_for_people(own: OwnCell) -> None:
    done = run(own)
    assert done.exit_code == 0, done.output
    assert f"{CAMERA} by frame-server: answers, serial number FC-0001" in done.stdout
    assert "4 of 4 devices answer, 0 of them differ" in done.stdout
    assert "latched until the daemon has re-armed it" in done.stdout


def test_another_robot_than_the_file_says(own: OwnCell) -> None:
    own.change('robot_name = "ARM-1"', 'robot_name = "ARM-2"')
    found = devices(own, exit_code=1)
    assert (faults(found[ROBOT]), faults(found[CHANNEL])) == ([204], [204])
    (fault,) = found[ROBOT]["faults"]
    assert "robot ARM-1 on the port of ARM-2" in fault["detail"]
    assert "name" in fault["remedy"]
    assert found[CAMERA]["good"]
    assert found[SENSOR]["good"]


def test_an_absent_camera_keeps_nobody_from_being_asked(own: OwnCell) -> None:
    port = free_port()
    own.change(f"port = {own.ports[7211]}", f"port = {port}")
    done = run(own)
    assert done.exit_code == 1
    assert f"F201 Device does not answer: camera, frame server 127.0.0.1:{port}" in done.stdout
    assert (
        "remedy: Check power, cable and the address in the cell file. Then ask again."
        in done.stdout
    )
    assert "Clear and Reset" not in done.stdout, "no daemon runs that would take them"
    assert done.stdout.count("with the cell file that `cellctl demo --stay` names") == 1
    assert "3 of 4 devices answer" in done.stdout
    assert f"{SENSOR} by sri: answers" in done.stdout


def test_a_file_with_errors_is_not_asked_after(own: OwnCell) -> None:
    own.change("speed_percent = 40", "speed_percent = 400")
    done = run(own, "--json")
    assert done.exit_code == 1
    report = json.loads(done.stdout)
    assert [error["key"] for error in report["errors"]] == ["robots.arm.speed_percent"]
    assert (report["good"], report["devices"]) == (False, [])


def test_where_the_line_is_served_nothing_is_asked(own: OwnCell) -> None:
    """Only a daemon serves it, whose devices would lose their links."""
    with socket.create_server(("127.0.0.1", own.modbus_port)):
        with pytest.raises(CellInUse, match="somebody serves the line") as raised:
            run(own)
        # `systemctl stop` does nothing for the cell of `make cell`.
        assert "a program in a terminal by Ctrl-C there" in raised.value.remedy
        assert "`python -m fakes run --scenario FILE`" in raised.value.remedy
        with own.control() as control:
            assert control.request("status")["channels"] == {"arm": []}


def test_where_a_port_of_a_robot_is_taken_nobody_else_is_asked(own: OwnCell) -> None:
    with socket.create_server(("127.0.0.1", own.ports[7201])):
        found = devices(own, exit_code=1)
    assert faults(found[ROBOT]) == [206]
    assert faults(found[CAMERA]) == [740]
    assert faults(found[SENSOR]) == [740]
    assert ROBOT in found[CAMERA]["faults"][0]["detail"]


def test_ctrl_c_ends_it_while_it_waits_for_a_robot(own: OwnCell) -> None:
    command, guard = free_port(), free_port()
    own.change(f"command_port = {own.ports[7201]}", f"command_port = {command}")
    own.change(f"guard_port = {own.ports[7203]}", f"guard_port = {guard}")
    patient = "connect_timeout_s = 90.0"
    own.change('robot_name = "ARM-1"\n', f'robot_name = "ARM-1"\n{patient}\n')
    own.change('robot_name = "ARM-1",', f'robot_name = "ARM-1", {patient},')
    words = [sys.executable, "-m", "cellctl", "check", str(own.cell), "--connect"]
    with (
        a_child_that_may_be_interrupted(),
        subprocess.Popen(
            words, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        ) as process,
    ):
        for port in (command, guard):
            _listened_on(port, process)
        os.kill(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert process.returncode == 130, out + err
    assert "ended by Ctrl-C: the links are dropped, nothing was moved" in err
    assert "Traceback" not in err


@contextmanager
def a_child_that_may_be_interrupted() -> Iterator[None]:
    """A shell lets what it runs in the background ignore Ctrl-C, and children inherit that."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def _listened_on(port: int, process: "subprocess.Popen[str]") -> None:
    deadline_s = time.monotonic() + 60.0
    while time.monotonic() < deadline_s:
        assert process.poll() is None, "ended before it waited for the robot"
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.05)
    raise AssertionError(f"nobody listens on {port}")
