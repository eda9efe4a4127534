"""`cellctl grab` and `cellctl focus` with the cameras of two drivers."""

import asyncio
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

from cellctl.cli.commands import app_with
from cellctl.errors.camera import CameraBusy
from cellctl.errors.config import DeviceNotInCell, FileInvalid
from cellctl.interfaces.camera import PixelFormat
from fakes.gentl.cameras import FakeCameras, expected_image
from fakes.wire.cameras.frame_server import FrameServer
from fakes.wire.cameras.image_server import ImageServer
from tests.wire.cameras.camera_bench import PictureTaker, pixels
from tests.wire.gige.conftest import LEFT, RIGHT, camera
from tests.wire.ramp import Ramp

GIGE = """name = "bench"
[cameras.eye]
driver = "gige"
simulated = true
[cameras.eye.settings]
producers = ["{producer}"]
camera.user_name = "left eye"
pixel_format = "Mono12"
exposure_s = 0.002
[stereo_cameras.head_1]
driver = "gige"
simulated = true
[stereo_cameras.head_1.settings]
producers = ["{producer}"]
left.serial_number = "GL-1"
right.serial_number = "GR-2"
gain_db = 3.0
max_difference_s = 10.0
image_timeout_s = 20.0
"""
FRAME_SERVER = """name = "bench"
[{section}.eye]
driver = "frame-server"
simulated = true
settings = {{ host = "127.0.0.1", port = {port} }}
"""


@pytest.fixture
def cell(tmp_path: Path, producer: Path) -> Path:
    path = tmp_path / "cell.toml"
    path.write_text(GIGE.format(producer=producer))
    return path


def said(name: str, *words: object) -> str:
    app = app_with(name)
    assert app is not None
    result = CliRunner().invoke(app, [name, *map(str, words)], env={"COLUMNS": "120"})
    if result.exception is not None:
        raise result.exception
    return result.stdout


def record(path: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return found


def test_a_deep_image_is_saved_as_it_is(cell: Path, fakes: FakeCameras, tmp_path: Path) -> None:
    said("grab", cell, "--camera", "eye", "--out", tmp_path / "out", "--count", 2)
    said("grab", cell, "--camera", "eye", "--out", tmp_path / "out")
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    assert names == [f"eye-{n:06d}.{kind}" for n in (1, 2, 3) for kind in ("json", "png")]
    image = cv2.imread(str(tmp_path / "out" / "eye-000002.png"), cv2.IMREAD_UNCHANGED)
    assert image is not None
    assert np.array_equal(image, expected_image(2, 64, 48, "Mono12"))
    facts = record(tmp_path / "out" / "eye-000002.json")
    assert facts["serial_number"] == LEFT
    (one,) = facts["images"]
    assert one["format"] == "Mono16"
    assert one["exposure"]["pixel_format"] == "Mono12"
    assert one["exposure"]["bits"] == 12
    assert one["exposure"]["exposure_s"] == pytest.approx(0.002)
    assert one["exposure"]["device_time_ns"] > 0
    assert fakes.opened(LEFT) == 0


@pytest.mark.figures  # as a deep image is
def test_deep_colour_is_saved_with_16_bits(cell: Path, fakes: FakeCameras, tmp_path: Path) -> None:
    text = cell.read_text()
    cell.write_text(text.replace('pixel_format = "Mono12"', 'pixel_format = "BayerRG12"'))
    said("grab", cell, "--camera", "eye", "--out", tmp_path / "out")
    image = cv2.imread(str(tmp_path / "out" / "eye-000001.png"), cv2.IMREAD_UNCHANGED)
    assert image is not None
    mosaic = expected_image(1, 64, 48, "BayerRG12")
    assert image.dtype == np.uint16
    assert np.array_equal(image, cv2.cvtColor(mosaic, cv2.COLOR_BayerBG2BGR))
    (one,) = record(tmp_path / "out" / "eye-000001.json")["images"]
    assert (one["format"], one["exposure"]["bits"]) == ("RGB16", 12)
    seen = json.loads(said("focus", cell, "--camera", "eye", "--json"))
    assert 0.0 < seen["sides"][0]["figures"]["median_grey"] < 255.0


def test_a_pair_is_saved_with_both_exposures(
    cell: Path, fakes: FakeCameras, tmp_path: Path
) -> None:
    said("grab", cell, "--head", "head_1", "--out", tmp_path)
    for number, side in enumerate(("left", "right")):
        image = cv2.imread(str(tmp_path / f"head_1-000001-{side}.png"), cv2.IMREAD_UNCHANGED)
        assert image is not None
        assert np.array_equal(image, expected_image(1, 64, 48, "Mono8", camera=number))
    facts = record(tmp_path / "head_1-000001.json")
    assert [one["exposure"]["serial_number"] for one in facts["images"]] == [LEFT, RIGHT]
    assert [one["exposure"]["gain_db"] for one in facts["images"]] == [3.0, 3.0]


async def test_colour_of_a_frame_server(tmp_path: Path) -> None:
    taker = PictureTaker(PixelFormat.RGB8)
    server = ImageServer("127.0.0.1", 0, taker.take)
    await server.start()
    cell = tmp_path / "cell.toml"
    cell.write_text(FRAME_SERVER.format(section="cameras", port=server.port))
    words = (cell, "--camera", "eye", "--out", tmp_path)
    await asyncio.to_thread(said, "grab", *words)
    seen = await asyncio.to_thread(said, "focus", cell, "--camera", "eye", "--json")
    await server.stop()
    image = cv2.imread(str(tmp_path / "eye-000001.png"), cv2.IMREAD_UNCHANGED)
    assert image is not None
    assert np.array_equal(image[:, :, ::-1], pixels(PixelFormat.RGB8, 1))
    assert json.loads(seen)["frame_id"] == 2


async def test_a_head_of_a_frame_server(tmp_path: Path) -> None:
    pool = Ramp()
    server = FrameServer("127.0.0.1", 0, pool.scene, pool)
    await server.start()
    cell = tmp_path / "cell.toml"
    cell.write_text(FRAME_SERVER.format(section="stereo_cameras", port=server.port))
    await asyncio.to_thread(said, "grab", cell, "--head", "eye", "--out", tmp_path)
    await server.stop()
    assert record(tmp_path / "eye-000001.json")["images"][1]["exposure"]["bits"] == 8
    assert (tmp_path / "eye-000001-right.png").is_file()


def test_focus_once_shows_a_table(cell: Path, fakes: FakeCameras) -> None:
    table = said("focus", cell, "--head", "head_1", "--once", "--board", "9x6", "--hole-px", 5, 20)
    for words in ("blur", "saturated", "3 dB", "not found", "left view seen by right"):
        assert words in table
    assert (fakes.opened(LEFT), fakes.opened(RIGHT)) == (0, 0)


def test_focus_gives_figures_to_programs(cell: Path, fakes: FakeCameras) -> None:
    seen = json.loads(said("focus", cell, "--camera", "eye", "--json"))
    image = np.asarray(expected_image(1, 64, 48, "Mono12") >> 4)
    (one,) = seen["sides"]
    assert one["figures"]["median_grey"] == pytest.approx(np.median(image), abs=1)
    assert one["figures"]["saturated_share"] == pytest.approx(np.mean(image >= 254))


@pytest.mark.figures  # a program of its own
def test_ctrl_c_ends_focus_and_lets_the_cameras_go(cell: Path, fakes: FakeCameras) -> None:
    program = "from cellctl.cli.app import main; main()"
    live = subprocess.Popen(
        [sys.executable, "-c", program, "focus", str(cell), "--head", "head_1"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        env=os.environ | {"COLUMNS": "120"},
        text=True,
    )
    try:
        until_s = time.monotonic() + 60.0
        while fakes.exposures(RIGHT) < 3 and time.monotonic() < until_s and live.poll() is None:
            time.sleep(0.05)
        live.send_signal(signal.SIGINT)
        out, err = live.communicate(timeout=30.0)
    finally:
        live.kill()
    assert (live.returncode, err) == (0, "")
    assert "blur" in out
    assert (fakes.opened(LEFT), fakes.opened(RIGHT)) == (0, 0)


@pytest.mark.parametrize("command", ["grab", "focus"])
def test_a_name_that_is_not_there(command: str, cell: Path, tmp_path: Path) -> None:
    words = [cell, "--head", "head_7"] + (["--out", tmp_path] if command == "grab" else [])
    with pytest.raises(DeviceNotInCell, match="--head head_1; --camera eye"):
        said(command, *words)


@pytest.mark.parametrize("words", [[], ["--head", "head_1", "--camera", "eye"]])
def test_one_device_is_named(cell: Path, tmp_path: Path, words: list[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        said("grab", cell, "--out", tmp_path, *words)


def test_a_folder_that_cannot_be_made(cell: Path, tmp_path: Path) -> None:
    with pytest.raises(FileInvalid, match=r"cell\.toml"):
        said("grab", cell, "--camera", "eye", "--out", cell / "images")


async def test_a_camera_that_the_daemon_has(
    cell: Path, producer: Path, fakes: FakeCameras, tmp_path: Path
) -> None:
    async with camera(producer):
        with pytest.raises(CameraBusy):
            await asyncio.to_thread(said, "grab", cell, "--camera", "eye", "--out", tmp_path)
