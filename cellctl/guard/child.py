"""The guard process as the daemon holds it: start, packets both ways, death."""

import asyncio
import contextlib
import os
import socket
import subprocess
import sys
from collections.abc import Callable

from cellctl.errors.force import GuardDied
from cellctl.guard import ring
from cellctl.guard.messages import Message, encode, receive
from cellctl.guard.ring_reader import RingReader

_MODULE = "cellctl.guard.process"
_QUIT_S = 2.0


class GuardChild:
    """One process, one link, one ring. Not reused: a new guard is a new child."""

    def __init__(
        self,
        ring_slots: int,
        on_message: Callable[[Message], None],
        on_death: Callable[[str], None],
        module: str = _MODULE,
    ) -> None:
        self._on_message = on_message
        self._on_death = on_death
        self._loop = asyncio.get_running_loop()
        self._gone = asyncio.Event()
        self._link, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        memory = ring.create(ring_slots)
        self.reader = RingReader(memory)
        with theirs:
            command = [sys.executable, "-X", "faulthandler", "-m", module]
            self._process = subprocess.Popen(
                [*command, str(theirs.fileno()), str(memory)],
                stdin=subprocess.DEVNULL,
                pass_fds=(theirs.fileno(), memory),
                process_group=0,  # Ctrl-C is the daemon's to handle
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            )
        os.close(memory)
        self._link.settimeout(0.0)
        self._pid_descriptor = os.pidfd_open(self._process.pid)
        self._loop.add_reader(self._link, self._read)
        self._loop.add_reader(self._pid_descriptor, self._reap)

    @property
    def pid(self) -> int:
        """Of the guard."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """Until its death has been noticed."""
        return not self._gone.is_set()

    def send(self, message: Message) -> None:
        """Hand over a packet; ``GuardDied`` when the guard does not take it."""
        try:
            self._link.send(encode(message))
        except OSError as error:
            raise GuardDied(f"it takes no messages: {error.strerror or error}") from error

    async def quit(self) -> None:
        """Ask for the end, kill after two seconds, free everything. Idempotent."""
        if self.alive:
            with contextlib.suppress(GuardDied):
                self.send({"id": 0, "do": "quit"})
            try:
                async with asyncio.timeout(_QUIT_S):
                    await self._gone.wait()
            except TimeoutError:
                self._process.kill()
                await self._gone.wait()
        self._close()

    def _read(self) -> None:
        """Everything that waits; the end of the link is told by the process's end."""
        while True:
            try:
                message = receive(self._link)
            except BlockingIOError:
                return
            except OSError:
                message = None
            if message is None:
                self._loop.remove_reader(self._link)
                return
            self._on_message(message)

    def _reap(self) -> None:
        self._loop.remove_reader(self._pid_descriptor)
        self._read()
        code = self._process.wait()
        self._gone.set()
        self._on_death(f"exit code {code}" if code >= 0 else f"killed by signal {-code}")

    def _close(self) -> None:
        if self._pid_descriptor < 0:
            return
        self._loop.remove_reader(self._link)
        self._link.close()
        os.close(self._pid_descriptor)
        self._pid_descriptor = -1
        self.reader.close()
