"""The guard process as the daemon holds it: start, requests and their answers, events, death."""

import asyncio
import contextlib
import itertools
import os
import socket
import subprocess
import sys
from collections.abc import Callable
from typing import Any

from cellctl.errors.force import GuardDied, GuardRefused
from cellctl.guard import ring
from cellctl.guard.limits import GuardSettings
from cellctl.guard.messages import Message, encode, receive
from cellctl.guard.ring_reader import RingReader

_QUIT_S = 2.0
"""How long a guard may take to end by itself: closing sensor and channel takes a fraction of it."""


class GuardChild:
    """One process with its link and its ring. Not reused: a new guard is a new child.

    It loads its drivers by ``set_up`` and opens them at ``OPEN``. ``on_event`` gets every event of
    the guard. ``on_death`` is called once, with how it ended in words, after its last messages.
    """

    def __init__(
        self,
        set_up: Message,
        settings: GuardSettings,
        on_event: Callable[[Message], None],
        on_death: Callable[[str], None],
        *,
        module: str,
    ) -> None:
        self._on_event = on_event
        self._on_death = on_death
        self._pending = PendingRequests(settings.reply_timeout_s)
        self._loop = asyncio.get_running_loop()
        self._gone = asyncio.Event()
        self._abandoned = False
        """True once nobody waits for the end of the process any more."""
        # SEQPACKET keeps the messages apart: each is read whole or not at all, also one of a
        # process that is killed while it sends.
        self._link, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        memory = ring.create(settings.ring_slots)
        self.reader = RingReader(memory)
        with theirs:
            # A fresh interpreter, not a fork: a fork would inherit the daemon's memory and locks.
            # Its modules are the daemon's own, whatever lies in the folder that it runs in (-P).
            command = [sys.executable, "-P", "-X", "faulthandler", "-m", module]
            self._process = subprocess.Popen(
                [*command, str(theirs.fileno()), str(memory)],
                stdin=subprocess.DEVNULL,
                pass_fds=(theirs.fileno(), memory),
                process_group=0,  # Ctrl-C is the daemon's to handle
                # Should a driver load numpy after all, its linear algebra must not start threads
                # beside the one that judges samples.
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
            )
        # Reader and child have descriptors of their own. Left open, this one would keep the ring of
        # a dead guard, about 18 MB, at every restart.
        os.close(memory)
        self._link.settimeout(0.0)
        # A descriptor of the process tells its end at once, without a thread that waits for it.
        self._pid_descriptor = os.pidfd_open(self._process.pid)
        self._loop.add_reader(self._link, self._read)
        self._loop.add_reader(self._pid_descriptor, self._reap)
        # One that has died already is told of by its end, like any other.
        with contextlib.suppress(GuardDied):
            self.send(set_up)

    @property
    def pid(self) -> int:
        """Number of the guard's process."""
        return self._process.pid

    @property
    def alive(self) -> bool:
        """True until the death of the process has been noticed."""
        return not self._gone.is_set()

    def send(self, message: Message) -> None:
        """Send a message; raises ``GuardDied`` when the guard does not take it."""
        try:
            self._link.send(encode(message))
        except OSError as error:
            raise GuardDied(f"it takes no messages: {error.strerror or error}") from error

    async def ask(self, request: Message, wait_s: float) -> Any:
        """Send a request and return its result; ``wait_s`` is how long it takes by its nature.

        Raises ``GuardRefused`` with the guard's reason, or ``GuardDied``.
        """
        return await self._pending.ask(self.send, request, wait_s)

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
            # A caller that gives up waiting must not leave a guard behind that hangs: nobody would
            # know of it, and it would keep sensor and stop channel for itself.
            except asyncio.CancelledError:
                self._abandoned = True
                self._process.kill()
                raise
        self.close()

    def close(self) -> None:
        """Free what a process that has ended leaves here. Idempotent."""
        if self._pid_descriptor < 0:
            return
        self._loop.remove_reader(self._link)
        self._link.close()
        os.close(self._pid_descriptor)
        self._pid_descriptor = -1
        self.reader.close()

    def _read(self) -> None:
        """Take all messages that wait.

        The end of the link is not yet the death of the guard: that comes with the end of the
        process, which also says how it died.
        """
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
            if "event" in message:
                self._on_event(message)
            else:
                self._pending.take(message)

    def _reap(self) -> None:
        """The process has ended: take its last messages, then tell its death."""
        self._loop.remove_reader(self._pid_descriptor)
        # The fault with which a guard gives up its start may still wait in the socket. Taken after
        # the death, it would come too late: ``start`` would raise the death instead of its cause.
        self._read()
        code = self._process.wait()
        how = f"exit code {code}" if code >= 0 else f"killed by signal {-code}"
        self._gone.set()
        self._pending.fail(GuardDied(how))
        self._on_death(how)
        if self._abandoned:
            self.close()


class PendingRequests:
    """Numbers the requests and wakes whoever waits for an answer."""

    def __init__(self, reply_timeout_s: float) -> None:
        self._reply_timeout_s = reply_timeout_s
        self._ids = itertools.count(1)
        self._answers: dict[int, asyncio.Future[Any]] = {}

    async def ask(self, send: Callable[[Message], None], request: Message, wait_s: float) -> Any:
        """Send a request and wait for its result, ``wait_s`` longer than the reply timeout."""
        number = next(self._ids)
        answer: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        self._answers[number] = answer
        timeout_s = self._reply_timeout_s + wait_s
        try:
            send({"id": number, **request})
            async with asyncio.timeout(timeout_s):
                return await answer
        except TimeoutError:
            words = f"no answer to {request['do']} within {timeout_s:g} s"
            raise GuardDied(words) from None
        finally:
            del self._answers[number]

    def take(self, message: Message) -> None:
        """Take an answer; one that nobody waits for any more is dropped."""
        answer = self._answers.get(message["id"])
        if answer is None or answer.done():
            return
        if "refused" in message:
            answer.set_exception(GuardRefused(message["refused"]))
        else:
            answer.set_result(message["result"])

    def fail(self, fault: GuardDied) -> None:
        """Tell everybody who waits that no answer will come."""
        for answer in self._answers.values():
            if not answer.done():
                answer.set_exception(fault)
