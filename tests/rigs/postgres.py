"""A PostgreSQL server of its own for tests, in a folder of its own, gone with it."""

import os
import pwd
import shutil
import signal
import socket
import subprocess
import time
from pathlib import Path
from typing import Any

from sqlalchemy import URL, Engine, create_engine, text

OWNER, PASSWORD = "keeper", "quite secret"
"""The administrator of the server, and the password of every role."""
_START_S = 60.0
_PLENTY_BYTES = 2 << 30
"""Three times what the databases of all tests take."""
_SYSTEM_USER = "postgres"


def programs() -> Path | None:
    """Where the newest server of this machine is; None without one."""
    found = sorted(
        Path("/usr/lib/postgresql").glob("*/bin"), key=lambda path: float(path.parent.name)
    )
    if found:
        return found[-1]
    on_path = shutil.which("initdb")
    return None if on_path is None else Path(on_path).parent


def missing() -> str:
    """Why there can be no server here; empty when there can."""
    if programs() is None:
        return "no PostgreSQL server: apt-get install --no-install-recommends postgresql"
    if os.geteuid() == 0 and not _has_user(_SYSTEM_USER):
        return "a PostgreSQL server does not run as root, and there is no user postgres"
    return ""


def quick_place() -> Path | None:
    """Where a server with many databases lies: in memory if there is plenty, None is the disk.

    A database is three hundred files. Disks may take half a minute to let go those of all tests.
    """
    memory = Path("/dev/shm")
    plenty = memory.is_dir() and shutil.disk_usage(memory).free > _PLENTY_BYTES
    return memory if plenty else None


class PostgresServer:
    """One server on a free port of this machine."""

    def __init__(self, folder: Path) -> None:
        bin_folder = programs()
        assert bin_folder is not None, missing()
        self._bin = bin_folder
        self.data = folder / "data"
        self._log = folder / "server.log"
        self._process: subprocess.Popen[bytes] | None = None
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.port: int = probe.getsockname()[1]
        secret = folder / "password"
        secret.write_text(PASSWORD, encoding="utf-8")
        if os.geteuid() == 0:
            # The server refuses to run as root.
            shutil.chown(folder, _SYSTEM_USER)
            shutil.chown(secret, _SYSTEM_USER)
        command = [str(self._bin / "initdb"), "-D", str(self.data), "-U", OWNER]
        command += ["--pwfile", str(secret), "--auth", "scram-sha-256", "--encoding", "UTF8"]
        command += ["--locale", "C", "--no-sync"]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL, **self._as_user())

    def start(self) -> None:
        """Start, and wait until it answers."""
        with self._log.open("ab") as log:
            self._process = subprocess.Popen(
                [str(self._bin / "postgres"), "-D", str(self.data), "-p", str(self.port),
                 "-c", "listen_addresses=127.0.0.1", "-c", "unix_socket_directories=",
                 # What these tests kill are processes, never the machine.
                 "-c", "fsync=off", "-c", "max_connections=40", "-c", "max_wal_size=64MB"],
                stdout=log, stderr=log, **self._as_user(),
            )  # fmt: skip
        end_s = time.monotonic() + _START_S
        while not self._answers():
            assert self._process.poll() is None, self._log.read_text(encoding="utf-8")
            assert time.monotonic() < end_s, "the server does not answer"
            time.sleep(0.05)  # there is nothing to wait on: the server tells nobody that it is up

    def stop(self) -> None:
        """End it in order, sessions included."""
        self._end(signal.SIGINT)

    def kill(self) -> None:
        """End it as a crash does: at once, in the middle of everything."""
        self._end(signal.SIGQUIT)

    def pause(self, *, paused: bool) -> None:
        """All of its processes hang, or go on."""
        assert self._process is not None
        number = signal.SIGSTOP if paused else signal.SIGCONT
        for pid in (self._process.pid, *_children(self._process.pid)):
            os.kill(pid, number)

    def url(self, user: str = OWNER, database: str = "postgres") -> str:
        """Without a password, as it stands in a cell file."""
        return f"postgresql://{user}@127.0.0.1:{self.port}/{database}"

    def engine(self, user: str = OWNER, database: str = "postgres") -> Engine:
        """An engine for what a test looks at and spoils by itself."""
        url = URL.create("postgresql+psycopg", user, PASSWORD, "127.0.0.1", self.port, database)
        return create_engine(url, isolation_level="AUTOCOMMIT", pool_size=1)

    def execute(self, *statements: str, database: str = "postgres") -> None:
        """Execute statements as the administrator."""
        engine = self.engine(database=database)
        with engine.connect() as connection:
            for statement in statements:
                connection.execute(text(statement))
        engine.dispose()

    @property
    def log(self) -> str:
        """What it has said."""
        return self._log.read_text(encoding="utf-8")

    @property
    def alive(self) -> bool:
        """Whether its process is there; one that has lost its disk ends by itself."""
        return self._process is not None and self._process.poll() is None

    def _answers(self) -> bool:
        ready = [str(self._bin / "pg_isready"), "-q", "-h", "127.0.0.1", "-p", str(self.port)]
        return subprocess.run(ready, check=False).returncode == 0

    def _end(self, number: int) -> None:
        if self._process is not None and self._process.poll() is None:
            self._process.send_signal(number)
            self._process.wait(_START_S)
        self._process = None

    def _as_user(self) -> dict[str, Any]:
        return {"user": _SYSTEM_USER, "cwd": "/"} if os.geteuid() == 0 else {}


def _children(pid: int) -> list[int]:
    text_of = Path(f"/proc/{pid}/task/{pid}/children").read_text(encoding="ascii")
    return [int(word) for word in text_of.split()]


def _has_user(name: str) -> bool:
    return name in {entry.pw_name for entry in pwd.getpwall()}
