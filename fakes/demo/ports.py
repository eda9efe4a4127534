"""Whether the ports of a demonstration are free, said before anything starts."""

import errno
import socket
import tomllib
from pathlib import Path

from fakes.scenario_file.scenario import Scenario

HOST = "127.0.0.1"
DEFAULT_MODBUS_PORT = 502


class PortInUse(RuntimeError):
    """A port that the demonstration needs is taken."""


class NoLoopback(RuntimeError):
    """This PC does not reach itself, over which all of the demonstration talks."""


def check_ports(scenario: Scenario, cell: Path) -> None:
    """Raise ``PortInUse`` for the first port, of the fake cell or the daemon, that is taken, and
    ``NoLoopback``."""
    require_network(HOST)
    for name, port in {**scenario.ports(), **_modbus_port(cell)}.items():
        if not _free(port):
            raise PortInUse(
                f"port {port} ({name}) is in use by another program, perhaps by another "
                "demonstration: end that one (Ctrl-C in its terminal), or give other ports in "
                "copies of both files and name them with --scenario and --cell"
            )


def require_network(host: str) -> None:
    """Raise ``NoLoopback`` when no packet could go to a host; sends none."""
    with socket.socket(type=socket.SOCK_DGRAM) as probe:
        try:
            probe.connect((host, DEFAULT_MODBUS_PORT))
        except OSError as error:
            raise NoLoopback(
                f"fake cell, daemon and line talk over {host}, which cannot be reached "
                f"({error.strerror}): bring the loopback interface up (ip link set lo up)"
            ) from error


def _modbus_port(cell: Path) -> dict[str, int]:
    try:
        plc = tomllib.loads(cell.read_text(encoding="utf-8")).get("plc", {})
        port = int(plc.get("port", DEFAULT_MODBUS_PORT))
    except (OSError, ValueError, TypeError, AttributeError):
        return {}  # the daemon says what is wrong with the file
    return {"Modbus TCP of the daemon": port}


def _free(port: int) -> bool:
    with socket.socket() as probe:
        # The servers set this too: a connection that has just ended does not keep its port.
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OSError as error:
            return error.errno != errno.EADDRINUSE
    return True
