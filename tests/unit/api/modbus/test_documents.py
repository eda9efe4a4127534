"""What is written by hand agrees with the code."""

from pathlib import Path

from cellctl.api.modbus.server import ServerLimits

PAGE = Path(__file__).parents[4] / "docs/plc-integration.md"


def test_the_limits_are_the_documented_ones() -> None:
    text = PAGE.read_text(encoding="utf-8")
    limits = ServerLimits()
    assert f"Up to {limits.clients} clients" in text
    assert f"more than {limits.frame_s:g} s and a silence of {limits.idle_s:g} s" in text
