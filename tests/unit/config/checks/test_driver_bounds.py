"""The bounds of a driver whose settings have names of their own are held like anybody's."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from cellctl import fault_catalogue, plugins
from cellctl.config import problems
from tests.unit.cell.bench import CELL_FILE

DRIVER = '''
"""An arm of another maker."""

from typing import Any

import numpy as np
from pydantic import BaseModel, ConfigDict

from cellctl.geometry.arm.chain import ArmChain
from cellctl.interfaces import MotionBounds, Robot


class OmegaConfig(BaseModel):
    """Names of its own."""

    model_config = ConfigDict(extra="allow", frozen=True)


class OmegaRobot(Robot):
    """Never connected here."""

    Config = OmegaConfig

    @classmethod
    def bounds(cls, config: Any) -> MotionBounds:
        return MotionBounds(joint_speed_ratio=0.3, speed_m_s=0.02)

    @classmethod
    def chain(cls, config: Any) -> ArmChain:
        dh = np.zeros((6, 4))
        dh[0, 1:3] = 0.8, 0.2
        return ArmChain(dh, np.full(6, -3.0), np.full(6, 3.0))
'''


@pytest.fixture(autouse=True)
def omega(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """An installed package with the driver ``omega``."""
    (tmp_path / "omega_arm").mkdir()
    (tmp_path / "omega_arm" / "__init__.py").write_text("")
    (tmp_path / "omega_arm" / "driver.py").write_text(DRIVER)
    info = tmp_path / "omega_arm-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: omega-arm\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[cellctl.robot]\nomega = omega_arm.driver:OmegaRobot\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    plugins.every.cache_clear()
    fault_catalogue.fault_modules.cache_clear()
    yield
    for name in ("omega_arm", "omega_arm.driver"):
        sys.modules.pop(name, None)
    plugins.every.cache_clear()
    fault_catalogue.fault_modules.cache_clear()


def test_speeds_and_lengths_are_held_against_the_driver_of_any_maker(tmp_path: Path) -> None:
    text = CELL_FILE.read_text()
    begin = text.index("[robots.main]")
    main = text[begin:].replace('driver = "siasun-sjl"', 'driver = "omega"', 1)
    path = tmp_path / "cell.toml"
    path.write_text(text[:begin] + main)
    found = {issue.key: issue.allowed for issue in problems(path)}
    assert found["robots.main.speed_percent"].startswith("at most 30,")
    assert found["robots.main.linear_speed_mm_s"].startswith("at most 20,")
    assert found["robots.main.d1_mm"].startswith("800,")
    assert "robots.main.linear_acceleration_mm_s2" not in found


def test_a_load_is_held_against_what_arms_of_this_driver_carry(tmp_path: Path) -> None:
    text = (CELL_FILE.parent / "antenna-rpc.toml").read_text()
    for folder in CELL_FILE.parent.iterdir():
        if folder.is_dir():
            (tmp_path / folder.name).symlink_to(folder)
    path = tmp_path / "cell.toml"
    for mass_kg, fits in ((35.0, True), (35.1, False)):
        path.write_text(text.replace("mass_kg = 1.5", f"mass_kg = {mass_kg}"))
        found = {issue.key: issue.allowed for issue in problems(path)}
        assert ("robots.arm.load.mass_kg" not in found) is fits
    assert found["robots.arm.load.mass_kg"].startswith("at most 35,")
