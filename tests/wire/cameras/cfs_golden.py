"""The golden frames of docs/protocols/frame-server.md, taken from the page itself."""

import re
from pathlib import Path

_PAGE = Path(__file__).parents[3] / "docs" / "protocols" / "frame-server.md"
_HEX = re.compile(r"^ {4}([0-9a-f ]+)$", re.MULTILINE)

(
    IMAGE_REQUEST,
    IMAGE_HEADER,
    IMAGE_PAYLOAD,
    PAIR_REQUEST,
    PAIR_HEADER,
    PAIR_PAYLOAD,
    REFUSAL,
) = (bytes.fromhex(match[1]) for match in _HEX.finditer(_PAGE.read_text(encoding="utf-8")))
