"""Images of a fake cell through the compiled producer, harvesters, genicam and the driver."""

import asyncio
import zlib
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cellctl.errors.camera import CameraBusy, ImagesDamaged
from cellctl.errors.link import LinkLost, ReplyTimeout
from drivers.camera.gige.config import GigeCameraConfig, GigeHeadConfig, Selection
from drivers.camera.gige.driver import GigeCamera, GigeHead
from fakes.cell import Cell
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras
from fakes.gentl.exposures import Asked, Exposed, ExposureServer
from fakes.render.look import options_of
from fakes.render.worker import Frame, render_frame
from fakes.scenes.deck_on_frame.scenario import DeckScenario
from fakes.scenes.deck_on_frame.scene import DeckOnFrame
from fakes.wire.cameras.gentl_camera import GentlCamera
from fakes.wire.cameras.gentl_faults import GentlFaults
from tests.unit.fakes.world.driving import to_taught
from tests.wire.gige.conftest import LEFT, RIGHT

WIDTH, HEIGHT = 64, 48
USUAL_US = 2000.0
DECK = Path(__file__).parents[3] / "config" / "deck.scenario.toml"


class Pair:
    """A head of which each exposure has pixels of its own."""

    def __init__(self, folder: Path) -> None:
        self.brightness: list[float] = []
        self.faults: list[frozenset[str]] = []
        self.server = ExposureServer(self._expose)
        cameras = [FakeCamera(serial, "", WIDTH, HEIGHT) for serial in (LEFT, RIGHT)]
        self.file = FakeCameras(folder / "cameras", cameras, self.server.address)
        self.head = GentlCamera(
            self._take, GentlFaults(self._at_producer), lenses=2, exposure_us=USUAL_US
        )

    @property
    def exposures(self) -> int:
        return len(self.brightness)

    def images(self, exposure: int) -> NDArray[np.uint8]:
        """Left and right image of an exposure, counted from 1; shape (2, height, width)."""
        levels = np.arange(2 * HEIGHT * WIDTH, dtype=np.int64) * 7 + 31 * exposure
        return (levels % 251).astype(np.uint8).reshape(2, HEIGHT, WIDTH)

    async def _take(self, faults: frozenset[str], brightness: float) -> Frame:
        self.faults.append(faults)
        self.brightness.append(brightness)
        payload = self.images(self.exposures).tobytes()
        return Frame(WIDTH, HEIGHT, payload, zlib.crc32(payload))

    async def _expose(self, asked: Asked) -> Exposed | None:
        return await self.head.expose(asked.camera, asked)

    def _at_producer(self, fault: Any, amount: int) -> None:
        for serial in (LEFT, RIGHT):
            self.file.inject(serial, fault, amount)


@pytest.fixture
async def pair(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AsyncIterator[Pair]:
    pair = Pair(tmp_path)
    monkeypatch.setenv(ENVIRONMENT, str(pair.file.path))
    await pair.server.start()
    yield pair
    await pair.server.stop()
    pair.file.close()


def head(producer: Path, **settings: Any) -> GigeHead:
    asked: dict[str, Any] = {
        "left": Selection(serial_number=LEFT),
        "right": Selection(serial_number=RIGHT),
        "producers": (producer,),
        "exposure_s": USUAL_US / 1e6,
        "image_timeout_s": 20.0,
        "max_difference_s": 10.0,
        "tries": 1,
    } | settings
    return GigeHead("head", GigeHeadConfig(**asked))


async def test_both_cameras_of_a_head_see_one_moment(producer: Path, pair: Pair) -> None:
    async with head(producer) as cameras:
        for exposure in (1, 2, 3):
            seen = await cameras.grab()
            left, right = pair.images(exposure)
            assert np.array_equal(seen.left, left)
            assert np.array_equal(seen.right, right)
            assert pair.exposures == exposure
    assert pair.brightness == [1.0, 1.0, 1.0]


async def test_the_settings_of_the_camera_reach_the_cell(producer: Path, pair: Pair) -> None:
    region = {"width": 32, "height": 24, "offset_x": 8, "offset_y": 6}
    settings = {"exposure_s": 0.004, "gain_db": 20.0, "region": region, "pixel_format": "Mono12"}
    camera = Selection(serial_number=RIGHT)
    asked = GigeCameraConfig(camera=camera, producers=(producer,), **settings)  # type: ignore[arg-type]
    async with GigeCamera("eye", asked) as eye:
        image = await eye.grab()
    assert np.array_equal(image.pixels >> 4, pair.images(1)[1, 6:30, 8:40])
    assert pair.brightness == [pytest.approx(2 * 10.0)]


async def test_faults_of_a_frame_server_by_their_names(producer: Path, pair: Pair) -> None:
    """Each spoils so many exposures as was said, and the cameras give images again after it."""
    async with head(producer, image_timeout_s=2.0) as cameras:
        await cameras.grab()
        for name, fault in (
            ("silent", ReplyTimeout),
            ("half_open", ReplyTimeout),
            ("truncated", ImagesDamaged),
            ("corrupt_payload", ImagesDamaged),
            ("frozen", ImagesDamaged),
        ):
            pair.head.faults.inject(name, replies=1)
            with pytest.raises(fault):
                await cameras.grab()
            seen = await cameras.grab()
            assert np.array_equal(seen.left, pair.images(pair.exposures)[0]), name
        pair.head.faults.inject("wrong_size", replies=1)
        assert (await cameras.grab()).left.shape == (HEIGHT // 2, WIDTH // 2)
        pair.head.faults.inject("black")
        await cameras.grab()
        assert pair.faults[-1] == {"black"}


async def test_a_late_image_comes_late(producer: Path, pair: Pair) -> None:
    async with head(producer) as cameras:
        await cameras.grab()
        pair.head.faults.inject("late", 0.4, replies=1)
        begun_s = asyncio.get_running_loop().time()
        await cameras.grab()
        assert asyncio.get_running_loop().time() - begun_s >= 0.4


async def test_a_camera_that_falls_off_the_network_is_opened_anew(
    producer: Path, pair: Pair
) -> None:
    async with head(producer) as cameras:
        await cameras.grab()
        pair.head.faults.inject("hang_up", replies=1)
        with pytest.raises(LinkLost):
            await cameras.grab()
        await cameras.grab()


async def test_a_camera_that_another_program_takes(producer: Path, pair: Pair) -> None:
    async with head(producer) as cameras:
        await cameras.grab()
        pair.head.faults.inject("busy")
        with pytest.raises(LinkLost):
            await cameras.grab()
        with pytest.raises(CameraBusy):
            await cameras.grab()
        pair.head.faults.clear()
        await cameras.grab()


async def test_the_cameras_are_gone_with_their_cell(producer: Path, pair: Pair) -> None:
    async with head(producer) as cameras:
        await cameras.grab()
        await pair.server.stop()
        for _ in range(2):  # opened anew, they are still seen, and nobody exposes
            with pytest.raises(LinkLost):
                await cameras.grab()


def test_an_unknown_fault_names_those_that_there_are() -> None:
    faults = GentlFaults(lambda _fault, _amount: None)
    with pytest.raises(ValueError, match="no such fault: drunk; there are silent"):
        faults.inject("drunk")
    with pytest.raises(ValueError, match="lasts until it is cleared"):
        faults.inject("hang", replies=1)


def small_heads() -> DeckScenario:
    """The deck's cell with heads of few pixels, which see as far to the sides as the real ones."""
    scenario = DeckScenario.read(DECK)
    few = {"image_px": (320, 264), "centre_px": (160.0, 132.0), "focal_px": 460.0}
    optics = {name: one.model_copy(update=few) for name, one in scenario.optics.items()}
    return scenario.model_copy(update={"optics": optics})


@pytest.fixture
def cameras(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "cameras"
    monkeypatch.setenv(ENVIRONMENT, str(path))
    return path


@asynccontextmanager
async def running(scenario: DeckScenario, cameras: Path) -> AsyncIterator[Cell]:
    ports = dict.fromkeys(scenario.ports(), 0)
    cell = Cell(scenario, 1, ports, cameras)
    try:
        await cell.start()
        yield cell
    finally:
        await cell.stop()


def before_a_board(world: DeckOnFrame) -> None:
    to_taught(world, "aux_1", "measure")
    world.commands()["place_chessboard"](head="head_1")


@pytest.mark.figures  # renders for both
async def test_a_head_of_the_cell_shows_what_a_frame_server_would(
    producer: Path, cameras: Path
) -> None:
    """Pixel by pixel, and its serial number is that of the frame server too."""
    # Exposures drift with the time of day, which is not the same in both worlds.
    scenario = small_heads().without_imperfections()
    serials = scenario.stereo_cameras["head_1"].serials
    settings = {
        "left": Selection(serial_number=serials[0]),
        "right": Selection(serial_number=serials[1]),
        "exposure_s": scenario.optics[scenario.stereo_cameras["head_1"].optics].exposure_us / 1e6,
        "image_timeout_s": 60.0,
    }
    async with running(scenario, cameras) as cell, head(producer, **settings) as head_1:
        assert isinstance(cell.world, DeckOnFrame)
        before_a_board(cell.world)
        seen = await head_1.grab()
        assert await head_1.serial_number() == scenario.stereo_cameras["head_1"].serial
    world = DeckOnFrame(scenario, 1)
    before_a_board(world)
    scene = world.camera_scene("head_1")
    assert scenario.rendering is not None
    frame = render_frame(scene, options_of(scenario.rendering))
    left, right = np.frombuffer(frame.payload, np.uint8).reshape(2, frame.height, frame.width)
    assert np.array_equal(seen.left, left)
    assert np.array_equal(seen.right, right)
    assert left.std() > 30.0, "there is something to see"
