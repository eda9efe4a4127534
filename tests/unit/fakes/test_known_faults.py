"""Faults by device, told without a cell, are those that a cell takes."""

from pathlib import Path
from typing import Literal

import pytest

from fakes.cell import Cell
from fakes.known_faults import UnknownFault, known_faults, require_known
from fakes.scenes.load import load

CONFIG = Path(__file__).parents[3] / "config"


@pytest.mark.parametrize("name", ["antenna-rpc", "deck", "deck-jobs"])
@pytest.mark.parametrize("cameras", ["gentl", "frame-server"])
async def test_a_cell_takes_these_and_no_others(
    tmp_path: Path, name: str, cameras: Literal["gentl", "frame-server"]
) -> None:
    scenario = load(CONFIG / f"{name}.scenario.toml")
    known = known_faults(scenario, cameras)
    cell = Cell(scenario, 1, gentl=tmp_path / "cameras" if cameras == "gentl" else None)
    inject = cell.operator.handlers()["inject"]
    try:
        for device, faults in known.items():
            for fault in faults:
                await inject(device=device, name=fault)
            with pytest.raises(ValueError, match="fault") as refused:
                await inject(device=device, name="?")
            there = (
                str(refused.value).partition("there are ")[2]
                or str(refused.value).partition("it knows ")[2]
            )
            assert set(there.split(", ")) - {""} == set(faults), device
        with pytest.raises(ValueError, match="unknown device") as strange:
            await inject(device="?", name="silent")
        assert all(repr(device) in str(strange.value) for device in known)
    finally:
        await cell.stop()


def test_where_the_way_of_images_is_open_both_have_their_names() -> None:
    known = known_faults(load(CONFIG / "deck.scenario.toml"), None)
    for fault in ("crash", "camera_fault"):
        require_known(f"head_1:{fault}", known)
    with pytest.raises(UnknownFault, match="head_1 knows no fault 'rain'; it knows"):
        require_known("head_1:rain", known)
