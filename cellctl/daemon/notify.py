"""Tell systemd how the service is (sd_notify(3)); silent when systemd did not start it."""

import os
import socket

from cellctl import log
from cellctl.clock import Monotonic, now_s

_log = log.get(__name__)


def notify(state: str) -> None:
    """Send one datagram such as ``READY=1`` or ``STATUS=…`` to ``$NOTIFY_SOCKET``.

    Never blocks and never raises: a deaf systemd is no reason to stop the cell.
    """
    address = os.environ.get("NOTIFY_SOCKET")
    if not address:
        return
    # An abstract socket of Linux: systemd writes its leading zero byte as @.
    if address.startswith("@"):
        address = "\0" + address[1:]
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK) as channel:
            channel.connect(address)
            channel.send(state.encode())
    except OSError as error:
        _log.warning("systemd not told", state=state.split("\n", maxsplit=1)[0], error=str(error))


def watchdog_interval_s() -> float | None:
    """Half the watchdog time-out systemd asks this process for, or None."""
    usec = os.environ.get("WATCHDOG_USEC", "")
    pid = os.environ.get("WATCHDOG_PID", str(os.getpid()))
    if not usec.isdigit() or int(usec) == 0 or pid != str(os.getpid()):
        return None
    return int(usec) / 2e6


class Watchdog:
    """Feeds systemd's watchdog, no more often than needed."""

    def __init__(self, clock: Monotonic = now_s) -> None:
        self._now_s = clock
        self._interval_s = watchdog_interval_s()
        self._next_s = 0.0

    def feed(self) -> None:
        """The daemon lives; nothing to do without a watchdog or before it is due."""
        if self._interval_s is not None and self._now_s() >= self._next_s:
            self._next_s = self._now_s() + self._interval_s
            notify("WATCHDOG=1")
