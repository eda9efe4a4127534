"""TCP ports for tests."""

import random
import socket
from collections.abc import Container


def free_port(taken: Container[int] = ()) -> int:
    """Below the range from which the system takes ports for outgoing connections.

    ``taken``: given away already, to somebody who does not listen yet.
    """
    while True:
        port = random.randrange(12_000, 32_000)
        if port in taken:
            continue
        with socket.socket() as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                probe.bind(("127.0.0.1", port))
            except OSError:
                continue
        return port


def free_ports(count: int) -> list[int]:
    """Different ports that nobody listens on just now."""
    ports: set[int] = set()
    while len(ports) < count:
        ports.add(free_port())
    return list(ports)
