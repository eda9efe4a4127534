"""What is written by hand agrees with the code."""

import re
from pathlib import Path

from cellctl.api.modbus.server import ServerLimits
from cellctl.runtime.step import Step

PAGE = Path(__file__).parents[3] / "docs/plc-integration.md"


def test_the_steps_are_listed() -> None:
    rows = re.findall(r"^\| (\d+) \| ([^|]+) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert {(int(number), name.strip().replace("-", " ")) for number, name in rows} == {
        (int(step), step.label if step else "none") for step in Step
    }


def test_the_limits_are_the_documented_ones() -> None:
    text = PAGE.read_text(encoding="utf-8")
    limits = ServerLimits()
    assert f"Up to {limits.clients} clients" in text
    assert f"more than {limits.frame_s:g} s and a silence of {limits.idle_s:g} s" in text
