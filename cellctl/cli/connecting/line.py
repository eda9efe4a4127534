"""The port for the line PLC, which also tells whether a daemon of this cell runs."""

import errno
import socket
from collections.abc import Iterator
from contextlib import contextmanager

from cellctl.cli.connecting.answer import Answer
from cellctl.config.cell import Plc
from cellctl.errors.line import CannotListen
from cellctl.errors.local import CellInUse

_PROBE_S = 1.0


@contextmanager
def line_port_held(plc: Plc) -> Iterator[Answer]:
    """Have the port of the line inside, as a daemon does first of all, so that none can start.

    Raises ``CellInUse`` where somebody serves it: that is a daemon, wherever its socket may lie.
    """
    place = f"{plc.host}:{plc.port}"
    clients = ", ".join(plc.allowed_clients) or "programs of this PC alone"
    facts = {"port": f"{place} is free", "may call": clients}
    try:
        listener = socket.create_server((plc.host, plc.port), backlog=0)
    except OSError as error:
        if error.errno == errno.EADDRINUSE or (error.errno == errno.EACCES and _served(plc)):
            raise CellInUse(f"somebody serves the line on {place}") from error
        yield _not_held(plc, error)
        return
    with listener:
        yield Answer("plc", "modbus", facts, asked=False)


def _not_held(plc: Plc, error: OSError) -> Answer:
    place = f"{plc.host}:{plc.port}"
    if error.errno == errno.EACCES:
        # The service has the right to it, whoever checks a cell file mostly not.
        text = f"{place} is free; this user may not open it, the service may"
        return Answer("plc", "modbus", {"port": text}, asked=False)
    return Answer("plc", "modbus", fault=CannotListen(f"{place}: {error.strerror}"), asked=False)


def _served(plc: Plc) -> bool:
    try:
        with socket.create_connection((plc.host, plc.port), _PROBE_S):
            return True
    except OSError:
        return False
