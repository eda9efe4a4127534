"""Values to 16-bit registers and back.

Modbus defines no order of the two words of a 32-bit value, and PLCs differ. So the order is a
setting, and the map has constants with which the line's programmer can test it.
"""

import math
import struct
from collections.abc import Mapping, Sequence
from typing import Literal

from cellctl.api.modbus.register_map import INPUT, INPUT_SIZE, UNDEFINED_I32, Item, Kind

Value = int | float | str
WordOrder = Literal["big", "little"]

_FORMATS = {Kind.U32: ">I", Kind.I32: ">i", Kind.F32: ">f"}
_I32_MAX = 2**31 - 1


def encode(item: Item, value: Value, order: WordOrder) -> list[int]:
    """Registers of a value; ``order`` "big" puts the high word first.

    Text is cut to its length and NUL padded, two characters a register, high byte first.
    """
    if item.kind is Kind.TEXT:
        data = (
            str(value).encode("ascii", "replace")[: 2 * item.length].ljust(2 * item.length, b"\0")
        )
        return list(struct.unpack(f">{item.length}H", data))
    if item.kind in _FORMATS:
        words = list(struct.unpack(">HH", struct.pack(_FORMATS[item.kind], value)))
        return words if order == "big" else words[::-1]
    return [int(value) & 0xFFFF]


def decode(item: Item, block: Sequence[int], order: WordOrder) -> Value:
    """The value of an item in a block that starts at address 0.

    Text ends at the first NUL; bytes beyond ASCII come back as U+FFFD, which no charset allows.
    """
    registers = [block[address] for address in item.addresses]
    if item.kind is Kind.TEXT:
        data = struct.pack(f">{item.length}H", *registers)
        return data.split(b"\0", 1)[0].decode("ascii", "replace")
    if item.kind in _FORMATS:
        words = registers if order == "big" else registers[::-1]
        value: int | float = struct.unpack(_FORMATS[item.kind], struct.pack(">HH", *words))[0]
        return value
    return registers[0]


def thousandths(value: float) -> int:
    """A value in its thousandth unit (mm to µm, N to mN) as i32; NaN is "undefined"."""
    return _scaled(value, 1e3)


def millionths(value: float) -> int:
    """A value in its millionth unit (degrees to microdegrees) as i32; NaN is "undefined"."""
    return _scaled(value, 1e6)


def input_block(values: Mapping[str, Value], order: WordOrder) -> tuple[int, ...]:
    """All input registers; items without a value and spare registers are 0."""
    block = [0] * INPUT_SIZE
    for item in INPUT:
        if item.name in values:
            registers = encode(item, values[item.name], order)
            block[item.address : item.address + item.length] = registers
    return tuple(block)


def _scaled(value: float, factor: float) -> int:
    if math.isnan(value):
        return UNDEFINED_I32
    # Clipped, because a value that wraps around would show the PLC a plausible wrong number. The
    # smallest i32 stays free: it means "undefined".
    return round(max(-_I32_MAX, min(_I32_MAX, value * factor)))
