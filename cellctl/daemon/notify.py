"""Tell systemd how the service is (sd_notify(3)); silent when systemd did not start it."""

import os
import socket


def notify(state: str) -> None:
    """Send one datagram such as ``READY=1`` or ``STATUS=…`` to ``$NOTIFY_SOCKET``."""
    address = os.environ.get("NOTIFY_SOCKET")
    if not address:
        return
    if address.startswith("@"):
        address = "\0" + address[1:]
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as channel:
        channel.connect(address)
        channel.send(state.encode())


def watchdog_interval_s() -> float | None:
    """Half the watchdog time-out systemd asks for, or None."""
    usec = os.environ.get("WATCHDOG_USEC")
    return int(usec) / 2e6 if usec else None
