"""A healthy PC has nothing to mend; each of many defects is found, with what mends it."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import whole_app
from cellctl.doctor.diagnosis import diagnose
from cellctl.doctor.finding import Finding, Health
from cellctl.doctor.service import LIMITS_DROP_IN, UNIT
from tests.unit.doctor.healthy_pc import CELL_FILE, PYTHON, HealthyPc

Spoil = Callable[[HealthyPc], object]

COMMAND = (
    "ExecStart=/opt/cellctl/current/.venv/bin/cellctl run /etc/cellctl/cell.toml "
    "--data-dir /var/lib/cellctl"
)


def findings(healthy: HealthyPc, cell_file: Path = CELL_FILE) -> list[Finding]:
    subjects = diagnose(cell_file, healthy.pc())
    return [finding for subject in subjects for finding in subject.findings]


@pytest.fixture
def healthy(tmp_path: Path) -> HealthyPc:
    return HealthyPc(tmp_path)


def test_a_healthy_pc(healthy: HealthyPc) -> None:
    found = findings(healthy)
    assert [finding for finding in found if finding.health is not Health.GOOD] == []
    assert len(found) > 20
    assert not any(finding.remedy for finding in found)


def interpreter_below_home(healthy: HealthyPc) -> None:
    healthy.write("/home/eve/.pyenv/bin/python3.11", "another interpreter")
    healthy.link("/opt/cellctl/current/.venv/bin/python", "/home/eve/.pyenv/bin/python3.11")


def closed_folder(healthy: HealthyPc) -> None:
    healthy.at("/opt/cellctl").chmod(0o700)


def nothing_but(line: str) -> Spoil:
    return lambda healthy: healthy.write(LIMITS_DROP_IN, line)


def by_gateway(healthy: HealthyPc) -> None:
    route = healthy.at("/proc/net/route").read_text().splitlines()
    healthy.write("/proc/net/route", "\n".join([route[0], route[2]]))


CASES: dict[str, tuple[Spoil, str, Health, str]] = {
    "no unit": (lambda pc: pc.at(UNIT).unlink(), "unit", Health.BAD, "make install"),
    "another unit": (
        lambda pc: pc.in_unit("Type=notify", "Type=exec"),
        "unit",
        Health.DOUBTFUL,
        "drop-in",
    ),
    "not enabled": (
        lambda pc: pc.at("/etc/systemd/system/multi-user.target.wants/cellctl.service").unlink(),
        "start with the PC",
        Health.DOUBTFUL,
        "systemctl enable",
    ),
    "no program": (
        lambda pc: pc.at("/opt/cellctl/current/.venv/bin/cellctl").unlink(),
        "program",
        Health.BAD,
        "make install",
    ),
    "interpreter below a home directory": (
        interpreter_below_home,
        "interpreter",
        Health.BAD,
        "PYTHON=/usr/bin/python3",
    ),
    "interpreter gone": (lambda pc: pc.at(PYTHON).unlink(), "interpreter", Health.BAD, "install"),
    "interpreter for its owner alone": (
        lambda pc: pc.at(PYTHON).chmod(0o700),
        "interpreter",
        Health.BAD,
        "chmod o+rx",
    ),
    "program in a closed folder": (closed_folder, "program", Health.BAD, "chmod o+x /opt/cellctl"),
    "no user": (lambda pc: pc.users.clear(), "user of the service", Health.BAD, "sysusers"),
    "no group for serial lines": (
        lambda pc: pc.groups.discard("dialout"),
        "group of the service",
        Health.BAD,
        "groupadd dialout",
    ),
    "no user of the page": (
        lambda pc: pc.users.discard("cellctl-hmi"),
        "user of the page",
        Health.DOUBTFUL,
        "sysusers",
    ),
    "no real-time priority": (
        lambda pc: pc.in_unit("LimitRTPRIO=80", "LimitRTPRIO=10"),
        "real-time priority",
        Health.BAD,
        "LimitRTPRIO=60",
    ),
    "no locked memory": (
        lambda pc: pc.in_unit("LimitMEMLOCK=infinity", "LimitMEMLOCK=64K"),
        "locked memory",
        Health.BAD,
        "LimitMEMLOCK=infinity",
    ),
    "no time for real-time programs": (
        lambda pc: pc.write("/proc/sys/kernel/sched_rt_runtime_us", "0"),
        "real-time share",
        Health.BAD,
        "sysctl",
    ),
    "one processor": (
        lambda pc: pc.write("/sys/devices/system/cpu/online", "0"),
        "processors",
        Health.DOUBTFUL,
        "two processors",
    ),
    "processors that save power": (
        lambda pc: pc.write("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "powersave"),
        "processor speed",
        Health.DOUBTFUL,
        "performance",
    ),
    "clock not synchronised": (
        lambda pc: setattr(pc, "clock_is_set", False),
        "clock",
        Health.DOUBTFUL,
        "timedatectl",
    ),
    "clock of a PC without a battery": (
        lambda pc: setattr(pc, "time_s", 0.0),
        "clock",
        Health.BAD,
        "set date and time",
    ),
    "clock with battery an hour off": (
        lambda pc: pc.write("/sys/class/rtc/rtc0/since_epoch", str(int(pc.time_s) - 3600)),
        "clock with battery",
        Health.DOUBTFUL,
        "hwclock",
    ),
    "records in memory": (
        lambda pc: pc.write("/proc/mounts", "none / overlay rw 0 0\n"),
        "disk",
        Health.BAD,
        "journal",
    ),
    "records on a server": (
        lambda pc: pc.write("/proc/mounts", "/dev/sda2 / ext4 rw 0 0\nfar:/x /var nfs4 rw 0 0\n"),
        "disk",
        Health.DOUBTFUL,
        "local disk",
    ),
    "disk full": (lambda pc: setattr(pc, "free_bytes", 10**9), "room", Health.BAD, "make room"),
    "disk nearly full": (
        lambda pc: setattr(pc, "free_bytes", 10 * 10**9),
        "room",
        Health.DOUBTFUL,
        "larger disk",
    ),
    "records where the unit lets write nothing": (
        lambda pc: pc.in_unit(COMMAND, COMMAND.replace("/var/lib/cellctl", "/data")),
        "records",
        Health.BAD,
        "ReadWritePaths=/data",
    ),
    "address of the line is not of this PC": (
        lambda pc: pc.own.add("10.0.0.1"),
        "robots.main.settings.listen_host",
        Health.BAD,
        "interface",
    ),
    "no way to a head": (
        lambda pc: setattr(pc, "reached", False),
        "stereo_cameras.head_1.settings.host",
        Health.BAD,
        "ip -brief address",
    ),
    "a head behind a gateway": (
        by_gateway,
        "stereo_cameras.head_1.settings.host",
        Health.DOUBTFUL,
        "interface of its own",
    ),
    "service not held to its peers": (
        lambda pc: pc.at(LIMITS_DROP_IN).unlink(),
        "limits of the service",
        Health.DOUBTFUL,
        "cellctl service-limits",
    ),
    "service held to other peers": (
        nothing_but("[Service]\nIPAddressAllow=10.1.1.1\n"),
        "limits of the service",
        Health.BAD,
        "cellctl service-limits",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_a_defect_is_found_with_its_remedy(healthy: HealthyPc, case: str) -> None:
    spoil, subject, health, remedy = CASES[case]
    spoil(healthy)
    found = {
        finding.subject: finding
        for finding in findings(healthy)
        if finding.health is not Health.GOOD
    }
    assert found[subject].health is health, found
    assert remedy in found[subject].remedy


def test_what_depends_on_nothing_is_examined_without_unit_and_cell_file(tmp_path: Path) -> None:
    healthy = HealthyPc(tmp_path)
    healthy.at(UNIT).unlink()
    healthy.clock_is_set = False
    found = {finding.subject: finding for finding in findings(healthy, tmp_path / "none.toml")}
    assert found["cell file"].health is Health.BAD
    assert "make install" in found["cell file"].remedy
    assert found["clock"].health is Health.DOUBTFUL
    assert found["packages"].health is Health.GOOD


def test_the_command_examines_this_very_pc() -> None:
    """Whatever it is: every line has its place, and what is not good has a remedy."""
    result = CliRunner().invoke(whole_app(), ["doctor", str(CELL_FILE), "--json"])
    subjects = json.loads(result.stdout)
    found = [finding for subject in subjects for finding in subject["findings"]]
    assert {"Software", "Cell file", "Service", "Clock", "Network"} <= {
        subject["title"] for subject in subjects
    }
    assert all(bool(finding["remedy"]) == (finding["health"] != "good") for finding in found)
    assert result.exit_code == int(any(finding["health"] == "bad" for finding in found))
    text = CliRunner().invoke(whole_app(), ["doctor", str(CELL_FILE)]).stdout
    assert all(finding["found"] in text for finding in found)
