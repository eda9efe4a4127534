"""The daemon's end: starts the process of the maker's library, asks it, and ends it."""

import mmap
import os
from contextlib import suppress
from dataclasses import replace
from multiprocessing import get_context, reduction
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from weakref import finalize

import numpy as np
from numpy.typing import NDArray

from cellctl.errors.link import LinkLost, ReplyTimeout
from drivers.camera.gige import faults
from drivers.camera.gige.library_process import entry
from drivers.camera.gige.protocol import Answer, Grabbed, GrabRequest, Request, RequestFailed

Block = NDArray[np.uint8]
_END_S = 5.0
"""Time for a process that listens to close its cameras: one that is killed leaves them locked."""


class LibraryProcess:
    """Used by one thread at a time. Blocks, so it is called beside the event loop."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._process: BaseProcess | None = None
        self._connection: Connection | None = None
        self._released: list[int] = []
        """Blocks of this process whose images were let go."""

    @property
    def running(self) -> bool:
        """True from a ``start`` until the process ends or is ended."""
        return self._process is not None and self._process.is_alive()

    def start(self) -> None:
        """Start the process, anew if there is one.

        It ends with the thread that calls this, so that it never outlasts its daemon: call it from
        a thread that lasts, such as a worker of the event loop's own pool.
        """
        self.end()
        context = get_context("spawn")  # a fork would take the daemon's threads and sockets along
        ours, theirs = context.Pipe()
        process = context.Process(
            target=entry.serve, args=(theirs, os.getpid()), name=f"cameras of {self._name}"
        )
        process.start()
        theirs.close()
        self._released = []  # images of the process before are let go into the list of their own
        self._process, self._connection = process, ours

    def ask(self, request: Request, timeout_s: float) -> tuple[Answer, list[Block]]:
        """The answer, and the bytes of its images.

        Raises the fault of what the process could not do. A process that does not answer or has
        died is ended: ``ReplyTimeout`` or ``LinkLost``.
        """
        connection = self._connection
        if connection is None:
            raise LinkLost(f"{self._name}: not connected")
        if isinstance(request, GrabRequest):
            request = replace(request, released=self._taken_back())
        try:
            connection.send(request)
            if not connection.poll(timeout_s):
                self.end(wait_s=0.0)  # what hangs closes nothing
                raise ReplyTimeout(f"{self._name}: the maker's library hangs; it was ended")
            answer: Answer = connection.recv()
            images = answer.images if isinstance(answer, Grabbed) else ()
            blocks = [_mapped(reduction.recv_handle(connection), one.size) for one in images]
            for one, block in zip(images, blocks, strict=True):
                # Whatever is made of it refers to this array as long as it shares its memory.
                finalize(block, self._released.append, one.block).atexit = False
        except (EOFError, OSError) as error:
            self.end()
            raise LinkLost(f"{self._name}: the maker's library has crashed") from error
        if isinstance(answer, RequestFailed):
            raise faults.of(self._name, answer)
        return answer, blocks

    def _taken_back(self) -> tuple[int, ...]:
        blocks = tuple(self._released)
        # Not emptied: an image may be let go at this moment, by any thread.
        del self._released[: len(blocks)]
        return blocks

    def end(self, wait_s: float = _END_S) -> None:
        """End the process: in its own way if it does so within the time, else by force."""
        connection, process = self._connection, self._process
        self._connection = self._process = None
        if connection is not None:
            with suppress(OSError):
                connection.close()
        if process is not None:
            process.join(wait_s)
            if process.is_alive():
                process.kill()
                process.join()
            process.close()


def _mapped(handle: int, size: int) -> Block:
    """Memory of a descriptor as a read-only array, which keeps it as long as it is used."""
    try:
        return np.frombuffer(mmap.mmap(handle, size, prot=mmap.PROT_READ), dtype=np.uint8)
    finally:
        os.close(handle)
