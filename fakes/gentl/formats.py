"""Pixel formats of the fake cameras, with their numbers by PFNC."""

from typing import Final, Literal

Format = Literal["Mono8", "Mono12", "Mono12Packed", "BayerRG8", "BayerRG12", "RGB8"]
PFNC: Final[dict[Format, int]] = {
    "Mono8": 0x01080001,
    "Mono12": 0x01100005,
    "Mono12Packed": 0x010C0006,
    "BayerRG8": 0x01080009,
    "BayerRG12": 0x01100011,
    "RGB8": 0x02180014,
}
FORMATS: Final = {number: name for name, number in PFNC.items()}
