"""The golden frames of docs/protocols/modbus-coupler.md: pairs of request and answer."""

import re
from pathlib import Path

_PAGE = Path(__file__).parents[3] / "docs" / "protocols" / "modbus-coupler.md"
_HEX = re.compile(r"^ {4}([0-9a-f ]+)$", re.MULTILINE)
_FRAMES = [bytes.fromhex(match[1]) for match in _HEX.finditer(_PAGE.read_text(encoding="utf-8"))]

EXCHANGES = list(zip(_FRAMES[::2], _FRAMES[1::2], strict=True))
COILS, INPUTS, REGISTERS, WRITE_COIL, WRITE_COILS, REFUSAL = EXCHANGES
COIL_BITS = [bool(0x056BCD >> k & 1) for k in range(19)]
"""Outputs 0x13 to 0x25 of the specification's example, section 6.1."""
INPUT_BITS = [bool(0x35DBAC >> k & 1) for k in range(22)]
"""Inputs 0xC4 to 0xD9 of section 6.2."""
REGISTER_VALUES = [0x022B, 0, 100]
