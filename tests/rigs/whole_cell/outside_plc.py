"""A line PLC written from docs/register-map.md and docs/plc-integration.md, and from nothing else.

Addresses, codes and numbers of states are read out of the tables of the document.
"""

import re
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

from pymodbus.client import ModbusTcpClient

from tests.rigs.whole_cell.own_cell import ROOT

_MAP = (ROOT / "docs" / "register-map.md").read_text(encoding="utf-8")
_BEAT_S = 0.2
_POLL_S = 0.03


def _section(title: str) -> list[list[str]]:
    """The rows of the table under a heading."""
    text = re.split(r"^## ", _MAP, flags=re.MULTILINE)
    (found,) = (part for part in text if part.startswith(title))
    rows = [line.strip("|").split("|") for line in found.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row] for row in rows[2:]]


def _registers(title: str) -> dict[str, int]:
    return {row[1]: int(row[0].split("-")[0]) for row in _section(title)}


HOLDING, INPUT = _registers("Holding registers"), _registers("Input registers")
STATES = {int(row[0]): row[1] for row in _section("States")}
COMMANDS = {row[1]: int(row[0]) for row in _section("Commands")}
BITS = {row[1]: int(row[0]) for row in _section("Status bits")}
RESULTS = {int(row[0]): row[1] for row in _section("Results")}
REJECTS = {int(row[0], 16): row[1] for row in _section("Reject codes")}
BLOCK = 125


class OutsidePlc:
    """One connection, a heartbeat beside it, and the handshake of the document."""

    def __init__(self, port: int) -> None:
        self.client = ModbusTcpClient("127.0.0.1", port=port, timeout=5, retries=0)
        self.seq = 0
        self._count = 0
        self._turn = threading.Lock()
        self._quiet = threading.Event()
        self._beat = threading.Thread(target=self._beats, daemon=True)

    def __enter__(self) -> Self:
        assert self.client.connect()  # type: ignore[no-untyped-call]  # pymodbus
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self._quiet.set()
        if self._beat.is_alive():
            self._beat.join(5)
        self.client.close()  # type: ignore[no-untyped-call]  # pymodbus

    def start_heartbeat(self) -> None:
        """The first beat has been taken when this returns."""
        with self._turn:
            standing = self.client.read_holding_registers(HOLDING["plc_heartbeat"]).registers[0]
        self._count = standing
        self._next_beat()
        self._beat.start()

    def _beats(self) -> None:
        while not self._quiet.wait(_BEAT_S):
            self._next_beat()

    def _next_beat(self) -> None:
        self._count = self._count % 0xFFFF + 1
        self.write(HOLDING["plc_heartbeat"], [self._count])

    def write(self, address: int, values: list[int]) -> None:
        with self._turn:
            answer = self.client.write_registers(address, values)
        assert not answer.isError(), answer

    def block(self) -> list[int]:
        with self._turn:
            answer = self.client.read_input_registers(0, count=BLOCK)
        assert not answer.isError(), answer
        registers = list(answer.registers)
        assert registers[INPUT["seq_head"]] == registers[INPUT["seq_tail"]]
        return registers

    def value(self, name: str) -> int:
        return self.block()[INPUT[name]]

    @property
    def state(self) -> str:
        return STATES[self.value("state")]

    def bit(self, name: str) -> bool:
        return bool(self.value("status") >> BITS[name] & 1)

    def until(self, what: str, reached: Callable[[], bool], timeout_s: float = 20.0) -> None:
        deadline = time.monotonic() + timeout_s
        while not reached():
            assert time.monotonic() < deadline, f"no {what} in {timeout_s} s; {self.state}"
            time.sleep(_POLL_S)

    def command(
        self,
        name: str | int,
        *,
        mode: int = 0,
        recipe: int = 0,
        serial: str = "",
        order: str = "",
        options: int = 0,
        alarm: int = 0,
    ) -> int:
        """One FC 16 request with a new ``cmd_seq``, wait for ``ack_seq``; the reject code."""
        self.seq = self.seq % 0xFFFF + 1
        block = [0] * (HOLDING["cmd_seq"] + 1)
        block[HOLDING["unit_mode"]] = mode
        block[HOLDING["cntrl_cmd"]] = COMMANDS[name] if isinstance(name, str) else name
        block[HOLDING["recipe_id"]] = recipe
        block[HOLDING["options"]] = options
        block[HOLDING["alarm_ack_id"]] = alarm
        block[HOLDING["cmd_seq"]] = self.seq
        _put(block, HOLDING["serial"], serial)
        _put(block, HOLDING["order"], order)
        self.write(0, block)
        self.until("acknowledgement", lambda: self.value("ack_seq") == self.seq)
        code = self.value("reject_code")
        assert code in REJECTS
        if code:
            assert self.value("done_seq") == self.seq
        return code

    def done(self, timeout_s: float = 20.0) -> str:
        """The words of the result, once the last command has ended."""
        self.until("end", lambda: self.value("done_seq") == self.seq, timeout_s)
        return RESULTS[self.value("result")]


def _put(block: list[int], address: int, text: str) -> None:
    padded = text.encode("ascii") + b"\0" * (len(text) % 2)
    for index in range(0, len(padded), 2):
        block[address + index // 2] = padded[index] << 8 | padded[index + 1]
