"""The line PLC's interface: register map, Modbus TCP server, command handshake, heartbeats."""

from cellctl.plc.commands import LineCommand
from cellctl.plc.coupling import LineCoupling
from cellctl.plc.port import PlcPort
from cellctl.plc.result import Result
from cellctl.plc.server import ServerLimits
from cellctl.plc.status import CellStatus

__all__ = ["CellStatus", "LineCommand", "LineCoupling", "PlcPort", "Result", "ServerLimits"]
