"""Frames and replies as bytes, made here by hand; three of them were recorded from devices."""

import struct

ZERO_FRAME = "AA55001B0000" + "00" * 24 + "00"

GOLDEN = {
    50375: (
        "AA55001BC4C7016AF4C0EF7D33C04962C9C0A25CC6BDA6198FBDAFDA693E6E",
        (-7.637940, -2.804561, -6.293248, -0.096856, -0.069873, 0.228373),
    ),
    53739: (
        "AA55001BD1EB41A3A43ECAD1B43F360612BE6A6F833B240256BB00EA3C378B",
        (0.321558, 1.412652, -0.142602, 0.004011, -0.003266, 1.126e-05),
    ),
    0: (
        "AA55001B0000C148F2C171712FC29DE194C178A96BC17057E5C19B8CE3C1E7",
        (-30.285524, -43.860783, -18.610163, -14.728874, -28.667694, -28.443655),
    ),
}
GOLDEN_CRC = bytes.fromhex("AA55001EC4C7016AF4C0EF7D33C04962C9C0A25CC6BDA6198FBDAFDA693E48FF42C4")


def frame(number: int, *values: float) -> bytes:
    """One point, unit E, SUM."""
    data = struct.pack("<6f", *(values or (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)))
    return b"\xaa\x55\x00\x1b" + number.to_bytes(2) + data + bytes([sum(data) % 256])
