"""A PC on which everything is as it should be, below a folder of a test."""

import grp
import pwd
from dataclasses import dataclass, field
from pathlib import Path

from cellctl.config.service_limits import drop_in, service_limits
from cellctl.doctor.pc import Pc
from cellctl.doctor.service import LIMITS_DROP_IN, UNIT
from tests.rigs.shipped import shipped_cell

ROOT = Path(__file__).parents[3]
CELL_FILE = ROOT / "config" / "cell.toml"
SHIPPED_UNIT = ROOT / "systemd" / "cellctl.service"
NOW_S = 1_800_000_000.0
PYTHON = "/usr/bin/python3.11"
FILES = {
    "/opt/cellctl/current/.venv/bin/cellctl": "#!/opt/cellctl/current/.venv/bin/python\n",
    PYTHON: "the interpreter",
    "/proc/sys/kernel/sched_rt_runtime_us": "950000\n",
    "/sys/devices/system/cpu/online": "0-3\n",
    "/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor": "performance\n",
    "/sys/class/rtc/rtc0/since_epoch": f"{NOW_S:.0f}\n",
    "/sys/class/net/eth0/mtu": "9000\n",
    "/proc/sys/net/core/rmem_max": "33554432\n",
    "/proc/mounts": "/dev/sda2 / ext4 rw 0 0\n/dev/sda3 /var ext4 rw 0 0\n",
    # Network 192.168.0.0 with mask 255.255.0.0 directly, everything else by 192.168.1.1.
    "/proc/net/route": "Iface Destination Gateway Flags RefCnt Use Metric Mask\n"
    "eth0 0000A8C0 00000000 0001 0 0 0 0000FFFF\n"
    "eth0 00000000 0101A8C0 0003 0 0 0 00000000\n",
}


@dataclass
class HealthyPc:
    """Files, accounts and answers that a test may spoil before it asks for ``pc``."""

    root: Path
    users: set[str] = field(default_factory=lambda: {"cellctl", "cellctl-hmi"})
    groups: set[str] = field(default_factory=lambda: {"cellctl", "dialout"})
    clock_is_set: bool = True
    time_s: float = NOW_S
    free_bytes: int = 500 * 10**9
    own: set[str] = field(default_factory=set)
    """Addresses of this PC; empty for all."""
    reached: bool = True

    def __post_init__(self) -> None:
        cell = shipped_cell(CELL_FILE.name)
        for path, text in FILES.items():
            self.write(path, text)
        self.write(UNIT, SHIPPED_UNIT.read_text())
        self.write(LIMITS_DROP_IN, drop_in(cell.name, service_limits(cell)))
        self.write("/etc/systemd/system/multi-user.target.wants/cellctl.service", "")
        self.link("/opt/cellctl/current/.venv/bin/python", PYTHON)
        for path in ("/opt/cellctl/current/.venv/bin/cellctl", PYTHON):
            self.at(path).chmod(0o755)
        self.at("/var/lib").mkdir(parents=True)
        # Folders of a test are closed to others, and its umask may be anything.
        for folder in (self.root, *(path for path in self.root.rglob("*") if path.is_dir())):
            folder.chmod(0o755)

    def at(self, path: str) -> Path:
        return self.root / path.lstrip("/")

    def write(self, path: str, text: str) -> None:
        self.at(path).parent.mkdir(parents=True, exist_ok=True)
        self.at(path).write_text(text)

    def link(self, path: str, target: str) -> None:
        self.at(path).unlink(missing_ok=True)
        self.at(path).symlink_to(target)

    def in_unit(self, line: str, instead: str) -> None:
        """Replace a line of the unit by another one."""
        unit = self.at(UNIT).read_text()
        assert f"\n{line}\n" in unit
        self.write(UNIT, unit.replace(f"\n{line}\n", f"\n{instead}\n"))

    def pc(self) -> Pc:
        me, mine = pwd.getpwuid(0), grp.getgrgid(0)
        return Pc(
            root=self.root,
            user=lambda name: me if name in self.users else None,
            group=lambda name: mine if name in self.groups else None,
            clock_is_set=lambda: self.clock_is_set,
            time_s=lambda: self.time_s,
            own_address_towards=lambda _: "192.168.1.5" if self.reached else None,
            is_own_address=lambda address: not self.own or address in self.own,
            free_bytes=lambda _: self.free_bytes,
        )
