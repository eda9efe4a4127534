"""The shipped unit under a systemd that has booted: ready, watched, ended in order.

Not in a simulated way: the real systemd of this machine, with the whole sandbox of the unit.
"""

import json
import shutil
from collections.abc import Iterator
from itertools import takewhile

import pytest

from tests.rigs.booted_pc.pc import ROOT, BootedPc, why_not
from tests.rigs.waiting import until_blocking

pytestmark = [pytest.mark.long, pytest.mark.timeout(700)]
PROGRAM = "/opt/cellctl/current/.venv/bin/cellctl"
SOURCE = "PYTHONPATH=/opt/cellctl/source"
PYTHON = "/opt/cellctl/current/.venv/bin/python"


@pytest.fixture(scope="module")
def pc(tmp_path_factory: pytest.TempPathFactory) -> Iterator[BootedPc]:
    reason = why_not()
    if reason:
        pytest.skip(reason)
    furnished = BootedPc.furnished(tmp_path_factory.mktemp("pc"))
    config = furnished.release / "etc/cellctl"
    shutil.copytree(ROOT / "config", config)
    cell = (config / "deck.toml").read_text("utf-8")
    cell = cell.replace('"demo-calibration"', '"/var/lib/cellctl/calibration"')
    (config / "cell.toml").write_text(cell, "utf-8")
    page = ('socket = "/run/cellctl/cellctl.sock"', 'data_dir = "/var/lib/cellctl"')
    (config / "hmi.toml").write_text("\n".join(page) + "\n", "utf-8")
    with furnished as booted:
        kept = "/var/lib/cellctl/calibration"
        booted.run("cp", "-r", "/etc/cellctl/demo-calibration", kept)
        booted.run("chown", "-R", "cellctl:cellctl", kept)
        fake = ("-m", "fakes", "run", "--scenario", "/etc/cellctl/deck.scenario.toml")
        booted.start("env", SOURCE, PYTHON, *fake, log=furnished.box / "fake.log")
        until_blocking(
            lambda: '"ready"' in (furnished.box / "fake.log").read_text(errors="replace"),
            within_s=90.0,
            look_s=0.2,
        )
        yield booted


def shown(pc: BootedPc, name: str) -> str:
    answer = pc.run("systemctl", "show", "cellctl", "--property", name, "--value")
    return answer.stdout.strip()


def journal(pc: BootedPc) -> str:
    return pc.run("journalctl", "-u", "cellctl", "-o", "cat", "--no-pager").stdout


def test_it_is_ready_with_its_guard_in_real_time(pc: BootedPc) -> None:
    started = pc.run("systemctl", "start", "cellctl", timeout_s=120.0)
    assert started.returncode == 0, started.stderr + journal(pc)
    assert shown(pc, "ActiveState") == "active"
    assert shown(pc, "StatusText").startswith("ready, Modbus TCP on port")
    found = pc.run("pgrep", "-u", "cellctl", "-f", "cellctl.guard.watch.main").stdout.split()
    policy = pc.run("chrt", "-p", found[0]).stdout
    assert "SCHED_FIFO" in policy
    status = pc.run(PROGRAM, "status", "--json", "--socket", "/run/cellctl/cellctl.sock")
    assert json.loads(status.stdout)["state"] == "STOPPED"


def printed(heading: str) -> list[str]:
    """The commands of the first indented block of the guide below a heading or phrase."""
    below = (ROOT / "docs/commissioning.md").read_text("utf-8").split(heading, 1)[1]
    lines = below.splitlines()
    first = next(index for index, line in enumerate(lines) if line.startswith("    "))
    block = takewhile(lambda line: line.startswith("    "), lines[first:])
    return [line.removeprefix("    ") for line in block]


def typed(pc: BootedPc, command: str) -> str:
    """What root sees who types it; fails where it fails."""
    done = pc.run("sh", "-c", command.replace("sudo ", ""), timeout_s=620.0)
    assert done.returncode == 0, f"{command}: {done.stdout}{done.stderr}{journal(pc)}"
    return done.stdout


def test_the_first_part_by_the_commands_of_the_guide(pc: BootedPc) -> None:
    """From a cell file that is good, over the limits of its service, to a part in the records."""
    assert "good" in typed(pc, "cellctl check /etc/cellctl/cell.toml")
    for command in printed("says that it is good:"):
        typed(pc, command)
    reset, start, listed = printed("**The first part.**")
    typed(pc, reset)
    assert "good" in typed(pc, start)
    assert "SAT-0001" in typed(pc, listed)
    doctor = pc.run("cellctl", "doctor", "--json")
    assert json.loads(doctor.stdout), doctor.stderr


def test_it_makes_a_part(pc: BootedPc) -> None:
    command = ("env", SOURCE, PYTHON, "-m", "fakes", "plc", "--port", "5020", "--serial", "SAT-1")
    made = pc.run(*command, "--timeout", "600", timeout_s=620.0)
    assert made.returncode == 0, made.stdout + made.stderr + journal(pc)
    listed = pc.run(PROGRAM, "runs", "list", "--json", "--data-dir", "/var/lib/cellctl")
    made_runs = {run["serial"]: run["result"] for run in json.loads(listed.stdout)}
    assert made_runs == {"SAT-0001": "good", "SAT-1": "good"}


def test_the_page_follows_it_from_a_unit_of_its_own(pc: BootedPc) -> None:
    assert pc.run("systemctl", "start", "cellctl-hmi", timeout_s=60.0).returncode == 0
    url = "http://127.0.0.1:8080/api/v1/health"
    asked = f"import urllib.request as r; print(r.urlopen('{url}').read().decode())"

    def linked() -> bool:
        answer = pc.run(PYTHON, "-c", asked)
        return answer.returncode == 0 and json.loads(answer.stdout)["daemon_linked"]

    until_blocking(linked, within_s=90.0, look_s=0.2)
    exposed = pc.run("systemctl", "show", "cellctl-hmi", "--property", "User", "--value").stdout
    assert exposed.strip() == "cellctl-hmi"


def test_a_daemon_that_hangs_is_killed_and_comes_back_without_moving(pc: BootedPc) -> None:
    before = shown(pc, "MainPID")
    pc.run("kill", "-STOP", before)
    until_blocking(
        lambda: shown(pc, "NRestarts") == "1" and shown(pc, "ActiveState") == "active",
        within_s=90.0,
        look_s=0.2,
    )
    assert shown(pc, "MainPID") != before
    assert "watchdog" in journal(pc).lower()
    status = pc.run(PROGRAM, "status", "--json", "--socket", "/run/cellctl/cellctl.sock")
    assert json.loads(status.stdout)["state"] in {"STOPPED", "ABORTED"}


def test_it_ends_in_order_and_leaves_nobody(pc: BootedPc) -> None:
    assert pc.run("systemctl", "stop", "cellctl").returncode == 0
    assert shown(pc, "Result") == "success"
    assert shown(pc, "ExecMainStatus") == "0"
    assert pc.run("pgrep", "-u", "cellctl").stdout == ""
