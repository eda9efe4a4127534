"""Boots, asks and ends the PC."""

import os
import shutil
import subprocess
import sys
import sysconfig
import time
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Self

ROOT = Path(__file__).parents[3]
_GROUPS = Path("/sys/fs/cgroup/unified"), Path("/sys/fs/cgroup")
_SYSTEMD = Path("/lib/systemd/systemd")
_NAMESPACES = ("--pid", "--mount", "--cgroup", "--uts", "--ipc", "--net")
_PATH = "/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
BOOT_S = 60.0
RELEASE = Path("opt/cellctl/current")


def why_not() -> str:
    """Why no PC can be booted here; empty where one can."""
    if os.geteuid() != 0:
        return "namespaces with mounts of their own want root"
    if not _SYSTEMD.exists():
        return f"no {_SYSTEMD} on this machine"
    missing = [name for name in ("unshare", "nsenter", "chroot", "ip") if not shutil.which(name)]
    if missing:
        return f"not on this machine: {', '.join(missing)}"
    if _group_of_all() is None:
        return "no writable tree of control groups of version 2"
    tried = subprocess.run(
        ["unshare", *_NAMESPACES, "--fork", "true"], capture_output=True, text=True, check=False
    )
    return tried.stderr.strip()


def _group_of_all() -> Path | None:
    for path in _GROUPS:
        if (path / "cgroup.procs").exists() and os.access(path, os.W_OK):
            return path
    return None


@dataclass
class BootedPc:
    """Runs until the end of the block; what it writes is gone then."""

    box: Path
    release: Path
    """What is laid over the root of the PC before it boots, beside cellctl itself."""
    _boot: subprocess.Popen[bytes] | None = None
    _programs: list[subprocess.Popen[bytes]] = field(default_factory=list)

    @classmethod
    def furnished(cls, box: Path) -> Self:
        """With the units, users and folders of cellctl as the installation leaves them."""
        release = box / "release"
        for name in ("root", "layer", "release"):
            (box / name).mkdir(parents=True)
        units = release / "etc/systemd/system"
        units.mkdir(parents=True)
        for unit in (ROOT / "systemd").glob("*.service"):
            shutil.copy(unit, units)
        for kind in ("sysusers", "tmpfiles"):
            folder = release / f"usr/lib/{kind}.d"
            folder.mkdir(parents=True)
            shutil.copy(ROOT / f"systemd/cellctl.{kind}", folder / "cellctl.conf")
        on_path = release / "usr/local/bin"
        on_path.mkdir(parents=True)
        cls._install_program(release / RELEASE / ".venv", on_path)
        return cls(box, release)

    @staticmethod
    def _install_program(environment: Path, on_path: Path) -> None:
        version = f"python{sys.version_info.major}.{sys.version_info.minor}"
        (environment / "bin").mkdir(parents=True)
        (environment / "bin/python").symlink_to(f"/opt/cellctl/python/bin/{version}")
        (environment / "pyvenv.cfg").write_text("home = /opt/cellctl/python/bin\n", "utf-8")
        (environment / "lib" / version).mkdir(parents=True)
        (environment / "lib" / version / "site-packages").symlink_to("/opt/cellctl/packages")
        for name, module in (("cellctl", "cellctl.cli.app"), ("cellctl-hmi", "cellctl.hmi.main")):
            lines = (
                f"#!/{RELEASE}/.venv/bin/python",
                "import sys",
                # Before the packages, whose entry for it names a folder that the service may not
                # see.
                "sys.path.insert(0, '/opt/cellctl/source')",
                f"from {module} import main",
                # The workers of the daemon import this file as well.
                "if __name__ == '__main__':",
                "    main()",
            )
            program = environment / "bin" / name
            program.write_text("\n".join(lines) + "\n", "utf-8")
            program.chmod(0o755)
            (on_path / name).symlink_to(f"/{RELEASE}/.venv/bin/{name}")

    def __enter__(self) -> Self:
        group_of_all = _group_of_all()
        assert group_of_all is not None
        group = group_of_all / f"cellctl-test-{os.getpid()}"
        group.mkdir()
        self._group = group
        boot = Path(__file__).with_name("boot.sh")
        packages = sysconfig.get_path("purelib")
        inside = ["bash", str(boot), str(self.box), sys.base_prefix, str(ROOT), packages]
        # Into the control group before the namespaces: it is the root of what the PC sees of them.
        joined = f'echo $$ > "{group}/cgroup.procs"; exec "$@"'
        command = ["unshare", *_NAMESPACES, "--fork", "--kill-child=SIGKILL", *inside]
        with (self.box / "boot.log").open("wb") as log:
            self._boot = subprocess.Popen(
                ["bash", "-c", joined, "boot", *command],
                stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True,
            )  # fmt: skip
        self._wait_for_boot()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        (self._group / "cgroup.kill").write_text("1", "ascii")
        for program in (self._boot, *self._programs):
            if program is not None:
                program.wait()
        end_s = time.monotonic() + 10.0
        while "populated 1" in (self._group / "cgroup.events").read_text("ascii"):
            assert time.monotonic() < end_s, "processes of the PC are still there"
            time.sleep(0.05)
        # Innermost first; the kernel removes a group only when nothing is left in it.
        for folder, _, _ in os.walk(self._group, topdown=False):
            os.rmdir(folder)

    def run(self, *command: str, timeout_s: float = 60.0) -> subprocess.CompletedProcess[str]:
        """A command of the administrator to its end."""
        return subprocess.run(
            [*self._into(), *command],
            capture_output=True,
            text=True,
            check=False,
            timeout=timeout_s,
        )

    def start(self, *command: str, log: Path) -> None:
        """A program that goes on; it ends with the PC."""
        with log.open("wb") as file:
            program = subprocess.Popen([*self._into(), *command], stdout=file, stderr=file)
        self._programs.append(program)

    def _into(self) -> list[str]:
        assert self._boot is not None
        first = _first_process(self._boot.pid)
        root = f"/proc/{first}/root"
        return [
            "nsenter", "-t", str(first), "-m", "-p", "-u", "-i", "-C", "-n", f"--root={root}",
            f"--wd={root}", "env", "-i", f"PATH={_PATH}", "TERM=dumb",
        ]  # fmt: skip

    def _wait_for_boot(self) -> None:
        end_s = time.monotonic() + BOOT_S
        said = ""
        while time.monotonic() < end_s:
            assert self._boot is not None
            if self._boot.poll() is not None:
                break
            try:
                state = self.run("systemctl", "is-system-running", timeout_s=10.0)
            except ProcessLookupError:
                state = None
            if state is not None and state.stdout.strip() in {"running", "degraded"}:
                return
            said = "" if state is None else state.stdout + state.stderr
            time.sleep(0.2)
        log = (self.box / "boot.log").read_text(errors="replace")
        self.__exit__(None, None, None)
        raise AssertionError(f"the PC did not boot: {said}\n{log}")


def _first_process(unshare: int) -> int:
    children = Path(f"/proc/{unshare}/task/{unshare}/children").read_text("ascii").split()
    if not children:
        raise ProcessLookupError("unshare has not forked yet")
    return int(children[0])
