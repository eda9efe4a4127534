"""Poses that were taught over a place, held against the height that a rule showed."""

from pathlib import Path

import pytest

from cellctl.config import problems_before_commissioning
from tests.unit.config.test_mistakes import written

_SOCKET = "pose = [500.0, -200.0, 200.0, 180.0, 0.0, 0.0]\ntaught_above_mm = 10.0"


@pytest.mark.parametrize(
    ("socket_mm", "taught_mm", "good"),
    [
        (204.5, 10.0, True),
        # Just over the place, which by the figures lies a millimetre higher.
        (211.0, 3.0, True),
        (215.0, 3.0, False),
        (216.0, 10.0, False),
    ],
)
def test_a_height_that_was_measured_may_be_off_by_some_millimetres(
    tmp_path: Path, socket_mm: float, taught_mm: float, *, good: bool
) -> None:
    new = _SOCKET.replace("-200.0, 200.0", f"-200.0, {socket_mm}")
    new = new.replace("above_mm = 10.0", f"above_mm = {taught_mm}")
    found = problems_before_commissioning(written(tmp_path, "antenna.toml", _SOCKET, new))
    # Its socket stays where it is in the model of the cell, which another check tells.
    keys = [one.key for one in found if "antenna.model.toml" not in str(one)]
    assert keys == ([] if good else ["robots.arm.poses_deg.above_socket"])


@pytest.mark.parametrize(
    ("name", "turns_deg", "good"),
    [
        ("insertion-pin.toml", "7.0, 0.0, 0.0", True),
        ("insertion-pin.toml", "7.0, 4.0, 0.0", False),
        ("insertion-pin.toml", "10.0, 0.0, 0.0", False),
        ("insertion-connector.toml", "7.0, 0.0, 0.0", False),
    ],
)
def test_nobody_aligns_a_round_pin_about_its_axis(
    tmp_path: Path, name: str, turns_deg: str, *, good: bool
) -> None:
    old = "pose = [500.0, -200.0, 200.0, 0.0, 0.0, 0.0]"
    new = old.replace("0.0, 0.0, 0.0]", f"{turns_deg}]")
    found = problems_before_commissioning(written(tmp_path, name, old, new))
    assert [one.key for one in found] == ([] if good else ["robots.arm.poses_deg.above_hole"])


@pytest.mark.parametrize(("plug_mm", "wanted"), [(220.0, "about 40"), (260.0, ""), (290.0, "")])
def test_nobody_is_asked_for_a_height_at_which_no_tool_was(
    tmp_path: Path, plug_mm: float, wanted: str
) -> None:
    old = "flange_T_plug = [0.0, 0.0, 200.0"
    path = written(tmp_path, "antenna.toml", old, old.replace("200.0", str(plug_mm)))
    tray = problems_before_commissioning(path)[0]
    height = next(one for one in tray.against if one.key.endswith("taught_above_mm"))
    assert (tray.key, height.allowed) == ("robots.arm.poses_deg.above_tray", wanted)
