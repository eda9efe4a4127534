"""Automatic exposure through the compiled producer: the fake plate is as bright as exposed."""

import asyncio
import json
from collections.abc import AsyncIterator
from pathlib import Path

import cv2
import numpy as np
import pytest

from cellctl.cell.devices import Cell
from cellctl.cell.lighting.auto_exposure import RunExposures
from cellctl.config import CellConfig, load_cell
from cellctl.errors.camera import ExposureNotAdjustable, ExposureNotReached
from cellctl.errors.link import LinkLost
from cellctl.interfaces.camera import PixelFormat
from cellctl.records.async_store import AsyncRunStore
from cellctl.records.run_recorder import RunRecorder
from cellctl.records.store import RunStore
from drivers.camera.gige.config import GigeHeadConfig, Selection
from drivers.camera.gige.driver import GigeHead
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras
from fakes.gentl.exposures import Asked, Exposed, ExposureServer, Outcome
from fakes.wire.cameras.image_server import ImageServer
from tests.unit.records.conftest import start
from tests.wire.cameras.camera_bench import PictureTaker
from tests.wire.gige.conftest import LEFT, RIGHT
from tests.wire.gige.test_grab_and_focus import FRAME_SERVER, said

WIDTH, HEIGHT = 256, 192
CELL = """name = "bench"
[stereo_cameras.head_1]
driver = "gige"
simulated = true
[stereo_cameras.head_1.settings]
producers = ["{producer}"]
left.serial_number = "GL-1"
right.serial_number = "GR-2"
pixel_format = "Mono8"
max_difference_s = 10.0
"""

SETTINGS = "[stereo_cameras.head_1.settings]\n"
AUTO = "auto_exposure = { hole_px = [8, 16], target_grey = 150 }\n"


class Plate:
    """Grey 30 in the left view and 60 in the right one after 1 ms, with dark holes."""

    def __init__(self) -> None:
        self.exposures_us: list[float] = []

    async def expose(self, asked: Asked) -> Exposed:
        self.exposures_us.append(asked.exposure_us)
        light = np.full((HEIGHT, WIDTH), 30.0 * (1 + asked.camera), dtype=np.float32)
        for centre in ((60, 60), (180, 70), (110, 130)):
            cv2.circle(light, centre, 12, 1.0, -1)
        grey = cv2.GaussianBlur(light, (0, 0), 0.8) * asked.exposure_us / 1000.0
        # A sensor has noise, and an image that comes again is refused.
        grey += np.random.default_rng(len(self.exposures_us)).normal(0.0, 0.5, grey.shape)
        data = np.clip(np.rint(grey), 0, 255).astype(np.uint8).ravel()
        return Exposed(Outcome.WHOLE, (WIDTH, HEIGHT), data)


@pytest.fixture
async def plate(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[Plate]:
    plate = Plate()
    server = ExposureServer(plate.expose)
    await server.start()
    cameras = [FakeCamera(serial, "", WIDTH, HEIGHT) for serial in (LEFT, RIGHT)]
    with FakeCameras(tmp_path / "cameras", cameras, server.address) as fakes:
        monkeypatch.setenv(ENVIRONMENT, str(fakes.path))
        yield plate
        await server.stop()


@pytest.fixture
def cell(tmp_path: Path, producer: Path) -> Path:
    path = tmp_path / "cell.toml"
    path.write_text(CELL.format(producer=producer))
    return path


@pytest.fixture
def automatic(cell: Path) -> CellConfig:
    """The same cell with the setting."""
    text = cell.read_text()
    assert text.count(SETTINGS) == 1
    cell.write_text(text.replace(SETTINGS, AUTO + SETTINGS))
    return load_cell(cell)


async def focused(cell: Path, *words: object) -> str:
    asked = ("--head", "head_1", "--hole-px", 8, 16, "--auto", "--json", *words)
    return await asyncio.to_thread(said, "focus", cell, *asked)


async def test_the_brighter_view_gets_the_grey(cell: Path, plate: Plate) -> None:
    seen = json.loads(await focused(cell))
    left, right = seen["sides"]
    assert right["figures"]["median_grey"] == pytest.approx(180.0, abs=9.0)
    assert right["figures"]["saturated_share"] == 0.0
    assert left["exposure_s"] == right["exposure_s"] == pytest.approx(3e-3, rel=0.05)
    assert (left["holes"], right["holes"]) == (3, 3)
    # Both cameras of each exposure: the first one, at most 16 of the search, and the one shown.
    assert len(plate.exposures_us) <= 2 * 18
    assert plate.exposures_us[-1] == pytest.approx(left["exposure_s"] * 1e6)


async def test_a_run_finds_it_once_and_records_it(
    automatic: CellConfig, plate: Plate, tmp_path: Path
) -> None:
    """The head's setting asks for it and the run's record has it; later images are exposed so."""
    built = Cell(automatic, tmp_path)
    store = AsyncRunStore(tmp_path / "runs")
    number = await store.do(start)
    recorder = RunRecorder(store, number)
    exposures = RunExposures(built, recorder)
    async with built.stereo_cameras["head_1"] as head:
        for _ in range(2):
            await exposures.find(head)
        taken = len(plate.exposures_us)
        pair = await head.grab()
    await recorder.exposures({"raw/left.pgm.zst": pair.exposures[0]})
    record = await store.do(RunStore.run, number)
    found = record.document("images.auto_exposure")["head_1"]
    assert found["grey"] == pytest.approx(150.0, abs=8.0)
    assert found["holes"] == 3
    assert 2 * found["exposures"] == taken
    kept = record.document("images.exposures")["raw/left.pgm.zst"]
    assert kept["exposure_s"] == pytest.approx(found["exposure_s"])
    assert found["exposure_s"] == pytest.approx(2.5e-3, rel=0.06)
    built.workers.close()
    store.close()


async def test_the_limit_of_the_exposure_is_kept(cell: Path, plate: Plate) -> None:
    with pytest.raises(ExposureNotReached, match="at the limit of the exposure, 2 ms"):
        await focused(cell, "--exposure-ms", 0.1, 2.0)
    assert max(plate.exposures_us[2:]) <= 2000.0


async def test_a_server_of_frames_cannot(tmp_path: Path) -> None:
    server = ImageServer("127.0.0.1", 0, PictureTaker(PixelFormat.MONO8).take)
    await server.start()
    path = tmp_path / "cell.toml"
    path.write_text(FRAME_SERVER.format(section="cameras", port=server.port))
    words = (path, "--camera", "eye", "--hole-px", 8, 16, "--auto", "--once")
    with pytest.raises(ExposureNotAdjustable, match="eye"):
        await asyncio.to_thread(said, "focus", *words)
    await server.stop()


@pytest.mark.figures  # as every setting does
async def test_an_exposure_that_was_set_outlasts_a_lost_camera(
    producer: Path, plate: Plate, tmp_path: Path
) -> None:
    config = GigeHeadConfig(
        left=Selection(serial_number=LEFT),
        right=Selection(serial_number=RIGHT),
        producers=(producer,),
        exposure_s=0.002,
        max_difference_s=10.0,
        image_timeout_s=20.0,
    )
    head = GigeHead("head", config)
    async with head:
        await head.grab()
        assert await head.set_exposure(0.0035) == pytest.approx(0.0035)
        # The nearest that the camera can, by the limits of its own description.
        assert await head.set_exposure(1e-9) == pytest.approx(10e-6)
        assert await head.set_exposure(0.004) == pytest.approx(0.004)
        pair = await head.grab()
        assert [one.exposure_s for one in pair.exposures] == [pytest.approx(0.004)] * 2
        await asyncio.to_thread(head._library.end)  # as after a fault of the maker's library
        pair = await head.grab()
        assert [one.exposure_s for one in pair.exposures] == [pytest.approx(0.004)] * 2
    with pytest.raises(LinkLost):
        await head.set_exposure(0.004)
    async with head:
        await head.grab()
    assert plate.exposures_us[-2:] == [pytest.approx(2000.0)] * 2
