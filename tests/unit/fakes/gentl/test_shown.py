"""The cameras of a scenario as a producer shows them."""

from pathlib import Path

import pytest

from fakes.gentl.shown import shown
from fakes.scenes.load import load

CONFIG = Path(__file__).parents[4] / "config"


def test_a_head_is_two_cameras_and_their_numbers_make_its_own() -> None:
    scenario = load(CONFIG / "deck.scenario.toml")
    lenses = shown(scenario)
    assert list(lenses) == ["head_1", "head_2"]
    left, right = lenses["head_1"]
    assert (left.serial, right.serial) == ("FH-0001L", "FH-0001R")
    assert f"{left.serial}+{right.serial}" == scenario.stereo_cameras["head_1"].serial
    assert (left.user_id, right.user_id) == ("head_1_left", "head_1_right")
    assert (left.width, left.height, left.pixel_format) == (2448, 2048, "Mono8")


def test_a_single_camera_has_the_number_of_its_frame_server() -> None:
    ((camera,), (fixed,)) = shown(load(CONFIG / "antenna.scenario.toml")).values()
    assert (camera.serial, camera.user_id, camera.pixel_format) == ("FC-0011", "camera_1", "RGB8")
    assert fixed.serial == "FC-0012"


@pytest.mark.parametrize(("serial", "both"), [("A+B", ("A", "B")), ("FH-7", ("FH-7L", "FH-7R"))])
def test_a_head_with_one_number_has_cameras_with_two(serial: str, both: tuple[str, str]) -> None:
    head = load(CONFIG / "deck.scenario.toml").stereo_cameras["head_1"]
    assert head.model_copy(update={"serial": serial}).serials == both
