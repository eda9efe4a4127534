"""The units that deliver and show records, under a systemd that has booted, without a daemon.

What is recorded is delivered and read all the same; the fleet's server crashes and comes back.
"""

import json
import shutil
import subprocess
from collections.abc import Iterator
from contextlib import closing

import pytest

from cellctl.records.files.delivery_file import FOLDER, NAME, DeliveryState, read_state
from cellctl.records.store import RunStore
from tests.rigs import postgres
from tests.rigs.booted_pc.pc import ROOT, BootedPc, why_not
from tests.rigs.waiting import until_blocking
from tests.unit.records.sample import good_run

pytestmark = [pytest.mark.long, pytest.mark.timeout(400)]
PROGRAM = "/opt/cellctl/current/.venv/bin/cellctl"
PYTHON = "/opt/cellctl/current/.venv/bin/python"
UNIT = "cellctl-forward"
DATA, PORT, PASSWORD = "/var/tmp/fleet", "5433", "quite secret"
AT = f"127.0.0.1:{PORT}/fleet"
API = "http://127.0.0.1:8080/api/v1"
TWO_RELEASES = """
cd /opt/cellctl
mkdir -p releases/old releases/new
for release in old new; do
    cp -a current/.venv releases/$release/
    ln -s /opt/cellctl/source/systemd /opt/cellctl/source/config releases/$release/
done
rm -r current
ln -s releases/new current
ln -s releases/old previous
"""


class FleetServer:
    """PostgreSQL on this PC, with the fleet of one cell."""

    def __init__(self, pc: BootedPc, cell: str) -> None:
        folder = postgres.programs()
        assert folder is not None
        self._pc, self._bin = pc, folder
        secret = f"{DATA}.password"
        pc.run("install", "-d", "-o", "postgres", DATA)
        pc.run("sh", "-c", f"echo '{PASSWORD}' > {secret}")
        made = ("-D", DATA, "-U", "keeper", "--pwfile", secret, "--auth", "scram-sha-256")
        self._by_its_user("initdb", *made, "--locale", "C", "--no-sync")
        self.start()
        self._execute("CREATE ROLE forward_cell LOGIN PASSWORD 'quite secret'")
        self._execute("CREATE DATABASE fleet")
        self.ask("init")
        self.ask("add", cell, "--forwarder", "forward_cell")

    def start(self) -> None:
        options = f"-p {PORT} -c listen_addresses=127.0.0.1 -c unix_socket_directories="
        self._by_its_user("pg_ctl", "-D", DATA, "-l", f"{DATA}/log", "-w", "-o", options, "start")

    def crash(self) -> None:
        self._by_its_user("pg_ctl", "-D", DATA, "-w", "-m", "immediate", "stop")

    def ask(self, *command: str) -> str:
        """`cellctl fleet` of the owner of the database."""
        to = (f"CELLCTL_FLEET=postgresql://keeper@{AT}", f"CELLCTL_FLEET_PASSWORD={PASSWORD}")
        return self._done(self._pc.run("env", *to, PROGRAM, "fleet", *command))

    def _execute(self, statement: str) -> None:
        psql = (str(self._bin / "psql"), "-h", "127.0.0.1", "-p", PORT, "-U", "keeper")
        command = (f"PGPASSWORD={PASSWORD}", *psql, "-d", "postgres", "-c", statement)
        self._done(self._pc.run("env", *command))

    def _by_its_user(self, program: str, *options: str) -> None:
        command = ("runuser", "-u", "postgres", "--", str(self._bin / program), *options)
        self._done(self._pc.run(*command))

    @staticmethod
    def _done(command: subprocess.CompletedProcess[str]) -> str:
        assert command.returncode == 0, command.stdout + command.stderr
        return command.stdout


@pytest.fixture(scope="module")
def pc(tmp_path_factory: pytest.TempPathFactory) -> Iterator[BootedPc]:
    if reason := why_not() or postgres.missing():
        pytest.skip(reason)
    furnished = BootedPc.furnished(tmp_path_factory.mktemp("pc"))
    config = furnished.release / "etc/cellctl"
    shutil.copytree(ROOT / "config", config)
    fleet = (
        f'[fleet]\nurl = "postgresql://forward_cell@{AT}"\n'
        'password_file = "/etc/cellctl/fleet.password"\n'
    )
    cell = (config / "deck.toml").read_text("utf-8")
    (config / "cell.toml").write_text(f"{cell}\n{fleet}", "utf-8")
    (config / "fleet.password").write_text(f"{PASSWORD}\n", "utf-8")
    page = ('socket = "/run/cellctl/cellctl.sock"', 'data_dir = "/var/lib/cellctl"')
    (config / "hmi.toml").write_text("\n".join(page) + "\n", "utf-8")
    with closing(RunStore(furnished.release / "var/lib/cellctl")) as store:
        good_run(store)
    with furnished as booted:
        # As the umask of the daemon's unit leaves them.
        booted.run("chown", "-R", "cellctl:cellctl", "/var/lib/cellctl")
        booted.run("chmod", "-R", "u=rwX,g=rX,o=", "/var/lib/cellctl")
        booted.run("chown", "cellctl", "/etc/cellctl/fleet.password")
        booted.run("chmod", "400", "/etc/cellctl/fleet.password")
        yield booted


def shown(pc: BootedPc, name: str, unit: str = UNIT) -> str:
    return pc.run("systemctl", "show", unit, "--property", name, "--value").stdout.strip()


def journal(pc: BootedPc) -> str:
    return pc.run("journalctl", "-u", UNIT, "-o", "cat", "--no-pager").stdout


def told(pc: BootedPc) -> DeliveryState | None:
    """By the file, as the page's user reads it."""
    as_page = ("runuser", "-u", "cellctl-hmi", "-g", "cellctl", "--")
    return read_state(pc.run(*as_page, "cat", str(FOLDER / NAME)).stdout)


def is_delivered(pc: BootedPc) -> bool:
    state = told(pc)
    return state is not None and state.still_to_come == 0 and not state.fault


def got(pc: BootedPc, path: str, *options: str) -> str:
    """What the page's process answers; empty while it does not."""
    return pc.run("curl", "-sf", *options, f"{API}/{path}", timeout_s=200.0).stdout


@pytest.fixture(scope="module")
def fleet(pc: BootedPc) -> FleetServer:
    return FleetServer(pc, "fake-cell")


@pytest.fixture
def server(pc: BootedPc, fleet: FleetServer) -> FleetServer:
    """With everything delivered, and a page that shows it."""
    for unit in (UNIT, "cellctl-hmi"):
        started = pc.run("systemctl", "start", unit, timeout_s=60.0)
        assert started.returncode == 0, started.stderr + journal(pc)
    until_blocking(lambda: is_delivered(pc), within_s=90.0, look_s=0.2)
    until_blocking(lambda: got(pc, "version"), within_s=60.0, look_s=0.2)
    return fleet


def test_what_was_recorded_is_delivered(pc: BootedPc, server: FleetServer) -> None:
    (run,) = json.loads(server.ask("runs", "--json"))
    assert (run["cell"], run["result"]) == ("fake-cell", "good")
    server.ask("verify")
    assert shown(pc, "User") == "cellctl"


def test_the_page_tells_of_it_and_shows_the_records(pc: BootedPc, server: FleetServer) -> None:
    until_blocking(
        lambda: "cellctl_fleet_entries_waiting 0.0" in got(pc, "metrics"), within_s=60.0, look_s=0.2
    )
    assert [run["result"] for run in json.loads(got(pc, "runs"))["runs"]] == ["good"]
    assert "<html" in got(pc, "runs/1/report")
    got(pc, "runs/1/recording", "-o", "/tmp/run.mcap")
    begins = "print(open('/tmp/run.mcap', 'rb').read(5))"
    assert "MCAP" in pc.run(PYTHON, "-c", begins).stdout


def test_a_server_that_crashed_is_told_and_served_again(pc: BootedPc, server: FleetServer) -> None:
    before = shown(pc, "MainPID")
    server.crash()
    until_blocking(lambda: (state := told(pc)) and "F831" in state.fault, within_s=60.0, look_s=0.2)
    assert "F831" in journal(pc)
    server.start()
    until_blocking(lambda: is_delivered(pc), within_s=90.0, look_s=0.2)
    assert shown(pc, "MainPID") == before


def test_page_and_forwarder_are_of_the_release_that_is_gone_back_to(
    pc: BootedPc, server: FleetServer
) -> None:
    laid = pc.run("sh", "-ec", TWO_RELEASES)
    assert laid.returncode == 0, laid.stderr
    units = ("cellctl-hmi", UNIT)
    before = [shown(pc, "MainPID", unit) for unit in units]
    done = pc.run("/opt/cellctl/source/systemd/install.sh", "rollback", timeout_s=200.0)
    assert done.returncode == 0, done.stdout + done.stderr
    assert pc.run("readlink", "/opt/cellctl/current").stdout.strip() == "releases/old"
    assert not {shown(pc, "MainPID", unit) for unit in units} & {"0", *before}
    until_blocking(lambda: got(pc, "version"), within_s=60.0, look_s=0.2)


def test_a_forwarder_that_was_killed_is_back_and_the_unit_ends_in_order(
    pc: BootedPc, server: FleetServer
) -> None:
    before = shown(pc, "MainPID")
    pc.run("systemctl", "kill", "-s", "KILL", UNIT)
    until_blocking(
        lambda: shown(pc, "NRestarts") == "1" and is_delivered(pc), within_s=90.0, look_s=0.2
    )
    assert shown(pc, "MainPID") != before
    assert pc.run("systemctl", "stop", UNIT).returncode == 0
    assert shown(pc, "Result") == "success"
    assert pc.run("pgrep", "-u", "cellctl").stdout == ""


@pytest.mark.parametrize("unit", ["cellctl", "cellctl-hmi", UNIT])
def test_the_exposure_of_the_installed_unit_is_low(pc: BootedPc, unit: str) -> None:
    judged = pc.run("systemd-analyze", "security", "--threshold=20", unit)
    assert judged.returncode == 0, judged.stdout[-300:]
