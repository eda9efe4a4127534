"""A pseudo terminal as the far end of a serial line."""

import asyncio
import os
import tty
from collections.abc import Callable


class PtyPort:
    """The box's end of a serial line; clients open ``path``. Bytes nobody reads get lost."""

    def __init__(self, on_bytes: Callable[[bytes], None]) -> None:
        self._on_bytes = on_bytes
        # The far end stays open here too: without anybody on it, reading this end fails with EIO,
        # and the line would end with its first client.
        self._master, self._slave = os.openpty()
        tty.setraw(self._slave)
        os.set_blocking(self._master, False)
        self.path = os.ttyname(self._slave)
        self._loop = asyncio.get_running_loop()
        self._loop.add_reader(self._master, self._readable)

    def write(self, data: bytes) -> bool:
        """Send; False when the line's buffer is full and something was lost."""
        try:
            return os.write(self._master, data) == len(data)
        except BlockingIOError:
            return False

    def close(self) -> None:
        """Hang up: clients see an error or the end of file."""
        self._loop.remove_reader(self._master)
        os.close(self._master)
        os.close(self._slave)

    def _readable(self) -> None:
        self._on_bytes(os.read(self._master, 4096))
