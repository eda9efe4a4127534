"""The lamp of a camera: on while it exposes, off however that ends."""

import asyncio
from pathlib import Path

import pytest

from cellctl.cell.devices import Cell
from cellctl.cell.lighting.light import Light
from cellctl.cell.lighting.lit_cameras import LitCamera, LitHead
from cellctl.clock import now_s
from cellctl.config import CellConfig
from cellctl.config.checks.cross_checks import cross_issues
from cellctl.errors.digital_io import SignalUnknown
from cellctl.errors.link import LinkLost, ReplyTimeout
from cellctl.interfaces.camera import CameraImage, PixelFormat
from cellctl.interfaces.stereo_camera import StereoPair
from tests.contracts.inprocess.camera import InProcessCamera
from tests.contracts.inprocess.digital_io import InProcessIo
from tests.contracts.inprocess.stereo_camera import InProcessHead

RING = {"device": "lamps", "output": "ring"}


class WatchingCamera(InProcessCamera):
    """Notes when it exposes and whether the lamp is on; exposes until it is let go on."""

    def __init__(self, name: str, io: InProcessIo) -> None:
        super().__init__(name, PixelFormat.MONO8)
        self.lit: list[bool] = []
        self.exposed_s = 0.0
        self.exposing = asyncio.Event()
        self.go_on = asyncio.Event()
        self.go_on.set()
        self._io = io

    async def grab(self) -> CameraImage:
        self.lit.append(self._io.driven["ring"])
        self.exposed_s = now_s()
        self.exposing.set()
        await self.go_on.wait()
        return await super().grab()


class WatchingHead(InProcessHead):
    """The same of a head, without waiting."""

    def __init__(self, io: InProcessIo) -> None:
        super().__init__("head")
        self.lit: list[bool] = []
        self._io = io

    async def grab(self) -> StereoPair:
        self.lit.append(self._io.driven["ring"])
        return await super().grab()


class SlowIo(InProcessIo):
    """Its output is driven a moment before the device confirms it, and later than it was asked."""

    async def write(self, outputs: object) -> None:
        await asyncio.sleep(0.01)
        await super().write(outputs)  # type: ignore[arg-type]
        await asyncio.sleep(0.01)


@pytest.fixture
async def io() -> InProcessIo:
    io = InProcessIo("lamps", (), ("ring", "spare"))
    await io.connect()
    return io


@pytest.fixture
async def behind(io: InProcessIo) -> WatchingCamera:
    camera = WatchingCamera("eye", io)
    await camera.connect()
    return camera


async def test_it_is_on_for_the_exposure_only(io: InProcessIo, behind: WatchingCamera) -> None:
    camera = LitCamera(behind, Light(io, "ring"), settle_s=0.03)
    began_s = now_s()
    image = await camera.grab()
    assert (image.frame_id, behind.lit) == (1, [True])
    assert behind.exposed_s - began_s >= 0.03
    assert io.driven == {"ring": False, "spare": False}


async def test_a_head_has_one_too(io: InProcessIo) -> None:
    behind = WatchingHead(io)
    head = LitHead(behind, Light(io, "ring"), settle_s=0.0)
    async with head:
        assert await head.serial_number() == "MEMORY-1"
        await head.grab()
    assert behind.lit == [True]
    assert io.driven["ring"] is False


async def test_it_goes_off_when_the_exposure_fails(io: InProcessIo, behind: WatchingCamera) -> None:
    behind.cut = True
    with pytest.raises(LinkLost, match="eye"):
        await LitCamera(behind, Light(io, "ring"), 0.0).grab()
    assert behind.lit == [True]
    assert io.driven["ring"] is False


async def test_it_goes_off_when_the_exposure_is_given_up(behind: WatchingCamera) -> None:
    io = SlowIo("lamps", (), ("ring",))
    await io.connect()
    behind.go_on.clear()
    grabbing = asyncio.create_task(LitCamera(behind, Light(io, "ring"), 0.0).grab())
    await behind.exposing.wait()
    assert io.driven["ring"] is True
    grabbing.cancel()
    await asyncio.wait({grabbing})
    assert grabbing.cancelled()
    assert io.driven["ring"] is False


async def test_given_up_while_it_is_switched_on(behind: WatchingCamera) -> None:
    io = SlowIo("lamps", (), ("ring",))
    await io.connect()
    grabbing = asyncio.create_task(LitCamera(behind, Light(io, "ring"), 0.0).grab())
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    grabbing.cancel()
    await asyncio.wait({grabbing})
    # Both writes have come to their ends, in their order: on, then off.
    assert (io.writes, io.driven["ring"], behind.lit) == (2, False, [])


async def test_nothing_is_exposed_in_the_dark(io: InProcessIo, behind: WatchingCamera) -> None:
    io.silent = True
    with pytest.raises(ReplyTimeout, match="lamps"):
        await LitCamera(behind, Light(io, "ring"), 0.0).grab()
    assert (behind.lit, behind.exposures) == ([], 0)


async def test_a_lamp_that_stays_on_is_a_fault(io: InProcessIo, behind: WatchingCamera) -> None:
    behind.go_on.clear()
    camera = LitCamera(behind, Light(io, "ring"), 0.0)
    grabbing = asyncio.create_task(camera.grab())
    await behind.exposing.wait()
    io.silent = True
    behind.go_on.set()
    with pytest.raises(ReplyTimeout, match="lamps"):
        await grabbing


async def test_the_fault_of_the_exposure_goes_before_that_of_the_lamp(
    io: InProcessIo, behind: WatchingCamera
) -> None:
    behind.go_on.clear()
    behind.cut = True
    grabbing = asyncio.create_task(LitCamera(behind, Light(io, "ring"), 0.0).grab())
    await behind.exposing.wait()
    io.silent = True
    behind.go_on.set()
    with pytest.raises(LinkLost, match="eye"):
        await grabbing


async def test_cameras_share_a_lamp(io: InProcessIo, behind: WatchingCamera) -> None:
    light = Light(io, "ring")
    second = WatchingCamera("second", io)
    await second.connect()
    behind.go_on.clear()
    second.go_on.clear()
    grabs = [asyncio.create_task(LitCamera(one, light, 0.0).grab()) for one in (behind, second)]
    await behind.exposing.wait()
    await second.exposing.wait()
    behind.go_on.set()
    await grabs[0]
    assert io.driven["ring"] is True
    second.go_on.set()
    await grabs[1]
    assert io.driven["ring"] is False


def cell(light: dict[str, str], permit: dict[str, str] | None = None) -> CellConfig:
    address = {"host": "127.0.0.1", "port": 7102}
    lit = {"driver": "frame-server", "settings": address, "light": light}
    return CellConfig.model_validate(
        {
            "name": "cell",
            "data_dir": "/tmp/none",
            "robots": {"arm": {"driver": "siasun-sjl", "permit": permit}} if permit else {},
            "cameras": {"eye": lit},
            "stereo_cameras": {"head": lit},
            "digital_ios": {
                "lamps": {
                    "driver": "modbus-coupler",
                    "settings": {"host": "127.0.0.1", "outputs": {"ring": 0, "arm": 1}},
                }
            },
        }
    )


def test_a_cell_puts_one_lamp_before_its_cameras(tmp_path: Path) -> None:
    built = Cell(cell(RING), tmp_path)
    eye, head = built.cameras["eye"], built.stereo_cameras["head"]
    assert isinstance(eye, LitCamera)
    assert isinstance(head, LitHead)
    assert eye._light is head._light


def test_an_output_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(SignalUnknown, match="rung; outputs of lamps: ring, arm"):
        Cell(cell(RING | {"output": "rung"}), tmp_path)


def test_the_check_knows_the_lamps() -> None:
    def keys(config: CellConfig) -> set[str]:
        return {issue.key for issue in cross_issues(config, []) if "light" in issue.key}

    other = {"device": "lamps", "output": "arm"}
    assert keys(cell(RING, permit=other)) == set()
    assert keys(cell(RING | {"device": "lamp"})) == {
        "cameras.eye.light.device", "stereo_cameras.head.light.device",
    }  # fmt: skip
    assert keys(cell(RING, permit=RING)) == {
        "cameras.eye.light.output", "stereo_cameras.head.light.output",
    }  # fmt: skip
