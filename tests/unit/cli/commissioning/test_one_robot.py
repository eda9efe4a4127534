"""`cellctl robot` and `cellctl teach` against a fake arm on the wire: nothing moves."""

import json
import re
import socket
import subprocess
import sys
import threading
import tomllib
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from cellctl.api.local_socket.messages import (
    Request,
    RobotAnswer,
    RobotRequest,
    parse_request,
    to_line,
)
from cellctl.cli.commands import whole_app
from cellctl.errors.config import DeviceNotInCell
from cellctl.errors.local import CellInUse
from fakes.demo.control import Control
from tests.rigs.wire.ports import free_ports
from tests.unit.cli.agreeable import AT_REST, Agreeable, listening

CONFIG = Path(__file__).parents[4] / "config"


@pytest.fixture(scope="module")
def ports() -> Iterator[dict[str, int]]:
    """A small fake cell whose arm runs the shipped jobs; its ports by name."""
    command, state, guard = free_ports(3)
    options = [f"arm.CMD={command}", f"arm.STA={state}", f"arm.GRD={guard}"]
    options += ["control=0", "camera=0", "force=0"]
    process = subprocess.Popen(
        [
            *(sys.executable, "-m", "fakes", "run", "--robots", "jobs"),
            *("--scenario", str(CONFIG / "small.scenario.toml")),
            *(word for option in options for word in ("--port", option)),
        ],
        stdout=subprocess.PIPE,
        text=True,
    )
    assert process.stdout is not None
    ready = json.loads(process.stdout.readline())
    yield {"CMD": command, "STA": state, "control": ready["ports"]["control"]}
    process.terminate()
    process.wait(20)
    process.stdout.close()


@pytest.fixture
def cell_file(ports: dict[str, int], tmp_path: Path) -> Path:
    text = (CONFIG / "small.toml").read_text(encoding="utf-8")
    text = re.sub(r"command_port = \d+", f"command_port = {ports['CMD']}", text)
    text = re.sub(r"state_port = \d+", f"state_port = {ports['STA']}", text)
    path = tmp_path / "small.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.fixture
def watched(ports: dict[str, int]) -> Iterator[None]:
    """No arm of the fake world may have moved at the end of a test."""
    with closing(Control(ports["control"])) as control:
        control.request("watch_begin")
        yield
        assert not any(control.request("watched")["motions"].values())


def run(*words: object, answers: str = "") -> Result:
    return CliRunner().invoke(
        whole_app(), [str(word) for word in words], input=answers, catch_exceptions=False
    )


def heard(result: Result) -> dict[str, Any]:
    assert result.exit_code == 0
    found: dict[str, Any] = json.loads(result.stdout)
    return found


@pytest.mark.usefixtures("watched")
def test_a_robot_says_who_it_is_and_how_often(cell_file: Path) -> None:
    found = heard(run("robot", cell_file, "arm", "--seconds", 1, "--json"))
    assert "ARM-1" in found["link"]["CMD"]
    assert found["reports"]["count"] > 3
    assert found["reports"]["oldest_ms"] >= found["reports"]["period_ms_p50"] / 2
    assert (found["state"]["mode"], found["state"]["drives_on"]) == ("remote", True)
    assert len(found["state"]["joints_deg"]) == 6
    assert found["round_trips"] == {"count": 0}, "no command was given"
    assert found["stop_latency"] == {"stored": "none; the bound of the recipe counts"}
    text = run("robot", cell_file, "arm", "--seconds", 0.5)
    assert "connected without a daemon: nothing was moved" in text.stdout
    assert "override_percent" in text.stdout


@pytest.mark.usefixtures("watched")
def test_the_load_of_the_cell_file_beside_what_the_controller_tells(cell_file: Path) -> None:
    text = cell_file.read_text(encoding="utf-8")
    load = "load = { mass_kg = 4.5, com_mm = [0, 0, 60], tolerance_kg = 0.5, tolerance_mm = 20 }"
    cell_file.write_text(text.replace("[robots.arm]\n", f"[robots.arm]\n{load}\n", 1))
    found = heard(run("robot", cell_file, "arm", "--seconds", 0.5, "--json"))
    assert found["load"] == {
        "in_the_cell_file": "4.5 kg at 0, 0, 60 mm of the flange",
        "may_differ_by": "0.5 kg, 20 mm",
    }
    told = found["selected_at_the_pendant"]
    assert told["load_kg"] == "not told by this controller", "no job can read it"


class Daemon(threading.Thread):
    """Answers one question for a robot, as the daemon of a cell with this name would."""

    def __init__(self, path: Path, cell: str) -> None:
        super().__init__(daemon=True)
        self._cell = cell
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._listener.bind(str(path))
        self._listener.listen(1)
        self.asked: Request | None = None
        self.start()

    def run(self) -> None:
        connection, _ = self._listener.accept()
        with connection, connection.makefile("rb") as lines:
            self.asked = parse_request(lines.readline())
            heard: dict[str, dict[str, Any]] = {
                "reports": {"count": 7},
                "round_trips": {"count": 2, "ms_p50": 4.5},
            }
            connection.sendall(to_line(RobotAnswer(cell=self._cell, heard=heard)))
        self._listener.close()


def test_beside_a_daemon_the_daemon_is_asked(tmp_path: Path) -> None:
    """The ports of the robot are the daemon's then; nothing is there to connect to here."""
    daemon = Daemon(tmp_path / "here.sock", "fake-cell")
    words = ("--seconds", 2, "--json", "--socket", tmp_path / "here.sock")
    found = heard(run("robot", CONFIG / "deck.toml", "main", *words))
    assert daemon.asked == RobotRequest(name="main", seconds=2.0)
    assert found["source"] == "asked through the daemon"
    assert found["round_trips"]["ms_p50"] == 4.5
    (text,) = found["stop_latency"].values()
    assert re.fullmatch(r"at most \d+ ms, valid without end", text)


@pytest.mark.usefixtures("watched")
def test_the_daemon_of_another_cell_is_not_asked_twice(cell_file: Path, tmp_path: Path) -> None:
    Daemon(tmp_path / "other.sock", "another cell")
    words = ("--seconds", 0.5, "--json", "--socket", tmp_path / "other.sock")
    found = heard(run("robot", cell_file, "arm", *words))
    assert found["source"] == "connected without a daemon"


def test_teaching_beside_a_daemon_names_the_daemon_and_not_a_port(
    cell_file: Path, tmp_path: Path
) -> None:
    text = cell_file.read_text(encoding="utf-8")
    api = f'[local_api]\nsocket = "{tmp_path / "s"}"\n\n[robots.arm]\n'
    cell_file.write_text(text.replace("[robots.arm]\n", api, 1), encoding="utf-8")
    daemon = Agreeable(shows=AT_REST | {"cell": "small-cell"})
    with (
        listening(tmp_path / "s", daemon),
        pytest.raises(CellInUse, match="the daemon of small-cell runs and is STOPPED"),
    ):
        run("teach", cell_file, "arm")


@pytest.mark.usefixtures("watched")
def test_the_taught_poses_are_compared(cell_file: Path) -> None:
    found = heard(run("teach", cell_file, "arm", "--json"))
    assert found["poses"]["home"]["off_deg"] == pytest.approx(0.0, abs=0.01)
    assert found["poses"]["look"]["off_deg"] > 1.0
    assert "look" in run("teach", cell_file, "arm").stdout


@pytest.mark.usefixtures("watched")
def test_a_pose_is_written_after_a_yes_only(cell_file: Path) -> None:
    # The arm stands at its home, which would be a copy of it under another name.
    text = cell_file.read_text(encoding="utf-8")
    before = text.replace("home = [0.0, -100.0", "home = [1.0, -98.0")
    cell_file.write_text(before, encoding="utf-8")
    said = run("teach", cell_file, "arm", "view", answers="y\n\nn\n").stdout
    assert said.index("has no pose 'view'") < said.index("Bring arm to 'view'")
    assert "left as it was" in said
    assert cell_file.read_text(encoding="utf-8") == before
    shown = run("teach", cell_file, "arm", "look", answers="\ny\n")
    assert "joints in the file" in shown.stdout
    after = cell_file.read_text(encoding="utf-8")
    poses = tomllib.loads(after)["robots"]["arm"]["poses_deg"]
    assert poses["look"] == pytest.approx([0.0, -100.0, 100.0, 0.0, 90.0, 0.0], abs=0.01)
    assert "taught 20" in after
    assert after.count("#") - before.count("#") in (0, 1)
    assert [path.name for path in cell_file.parent.iterdir()] == [cell_file.name]


def test_an_unknown_robot_is_refused_with_those_that_there_are(cell_file: Path) -> None:
    with pytest.raises(DeviceNotInCell, match="it has arm"):
        run("robot", cell_file, "leg")
