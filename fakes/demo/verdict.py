"""Why a job was not good, in the words of docs/register-map.md."""

from typing import Any

_REFUSALS = {
    0x101: "no heartbeat from the line PLC",
    0x102: "no recipe or procedure with this number",
    0x103: "serial number not of the characters A-Z 0-9 . _ -",
    0x106: "a needed calibration is missing, expired or invalidated",
    0x107: "a device is not connected or not ready",
    0x108: "the run store cannot take a run",
}


def why_not_good(result: dict[str, Any]) -> str:
    """The reason in the line PLC's last message; the daemon tells the faults behind it."""
    parts = [str(result.get("result") or "no result")]
    if code := result.get("reject_code"):
        parts.append(
            f"Start refused with 0x{code:X}, {_REFUSALS.get(code, 'see the register map')}"
        )
    if alarm := result.get("alarm"):
        parts.append(f"alarm F{alarm:03d}")
    if message := result.get("message"):
        parts.append(str(message))
    if result.get("result") == "good":
        parts.append("but the truth is out of limits, see the table")
    return ", ".join(parts)
