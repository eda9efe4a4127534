"""What can be wrong with cameras and producers, each by a fault of its own, and how it ends."""

import asyncio
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from cellctl.errors.base import CellError
from cellctl.errors.camera import (
    CameraAbsent,
    CameraBusy,
    CameraFeatureRefused,
    CameraOutOfReach,
    CamerasNotTogether,
    ImagesDamaged,
    ProducerUnusable,
    SeveralCameras,
)
from cellctl.errors.link import LinkLost, ReplyTimeout
from drivers.camera.gige.config import GigeHeadConfig, Region, Selection
from drivers.camera.gige.driver import GigeHead
from drivers.camera.gige.library_process.image_memory import MOST_FREE
from fakes.gentl.build import SOURCES, build_producer
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras, Fault, expected_image
from tests.wire.gige.conftest import LEFT, RIGHT, camera, descriptors

FIGURES = pytest.mark.figures
"""For the rest of what one branch serves: each takes a process of the maker's library."""
EM_RISCV, EM_S390 = (number.to_bytes(2, sys.byteorder) for number in (243, 22))


@contextmanager
def network(folder: Path, cameras: list[FakeCamera]) -> Iterator[FakeCameras]:
    """Other cameras than those of the fixture."""
    with pytest.MonkeyPatch.context() as environment, FakeCameras(folder / "own", cameras) as fakes:
        environment.setenv(ENVIRONMENT, str(fakes.path))
        yield fakes


async def refused(producer: Path, fault: type[CellError], **settings: object) -> str:
    eye = camera(producer, **settings)
    with pytest.raises(fault) as caught:
        await eye.connect()
    await eye.disconnect()
    return str(caught.value)


async def test_an_absent_camera_is_named_with_those_that_are_there(
    producer: Path, fakes: FakeCameras
) -> None:
    said = await refused(producer, CameraAbsent, camera=Selection(serial_number="GL-7"))
    assert "GL-7" in said
    assert LEFT in said
    assert RIGHT in said
    assert fakes.opened(LEFT) == 0


async def test_a_camera_is_found_by_its_user_name(producer: Path, fakes: FakeCameras) -> None:
    async with camera(producer, camera=Selection(user_name="right eye")) as eye:
        assert await eye.serial_number() == RIGHT
    assert fakes.opened(RIGHT) == 0


async def test_a_camera_is_found_by_its_address(tmp_path: Path, producer: Path) -> None:
    cameras = [FakeCamera(LEFT, address="192.168.10.7"), FakeCamera(RIGHT, address="192.168.10.8")]
    with network(tmp_path, cameras):
        async with camera(producer, camera=Selection(ip_address="192.168.10.8")) as eye:
            assert await eye.serial_number() == RIGHT
        said = await refused(producer, CameraAbsent, camera=Selection(ip_address="192.168.10.9"))
    assert f"{LEFT} (fake GigE camera at 192.168.10.7)" in said


async def test_a_name_that_two_cameras_have(tmp_path: Path, producer: Path) -> None:
    with network(tmp_path, [FakeCamera(LEFT, "eye"), FakeCamera(RIGHT, "eye")]):
        said = await refused(producer, SeveralCameras, camera=Selection(user_name="eye"))
    assert LEFT in said
    assert RIGHT in said


async def test_a_camera_of_another_subnet(tmp_path: Path, producer: Path) -> None:
    with network(tmp_path, [FakeCamera(LEFT, address="10.0.0.5")]):
        said = await refused(producer, CameraOutOfReach)
    assert "10.0.0.5" in said
    assert "192.168.10.1/24" in said


@pytest.mark.figures  # compiles a producer of its own
async def test_a_camera_out_of_reach_whose_producer_says_no_address(tmp_path: Path) -> None:
    producer = build_producer(tmp_path, "-O0", interface_xml=SOURCES / "module.xml")
    with network(tmp_path, [FakeCamera(LEFT, address="10.0.0.5"), FakeCamera(RIGHT)]):
        assert "cannot be reached" in await refused(producer, CameraOutOfReach)
        async with camera(producer, camera=Selection(serial_number=RIGHT)) as eye:
            await eye.grab()


async def test_a_bad_producer_beside_a_good_one(
    tmp_path: Path, producer: Path, fakes: FakeCameras
) -> None:
    bad = tmp_path / "a.cti"
    bad.write_bytes(b"no library")
    async with camera(producer, producers=(bad, producer)) as eye:
        await eye.grab()
    absent = Selection(serial_number="GL-7")
    said = await refused(producer, CameraAbsent, producers=(bad, producer), camera=absent)
    assert "a.cti cannot be loaded" in said


async def test_a_producer_that_does_not_start(
    producer: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It loads, and its own initialisation fails: here, for want of its file of cameras."""
    monkeypatch.setenv(ENVIRONMENT, "/nowhere")
    assert "fake_gentl.cti cannot be used" in await refused(producer, ProducerUnusable)


async def test_a_camera_that_another_program_has(producer: Path, fakes: FakeCameras) -> None:
    async with camera(producer):
        assert "another program" in await refused(producer, CameraBusy)
    assert fakes.opened(LEFT) == 0
    async with camera(producer) as eye:
        await eye.grab()


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [("none.cti", None, "no producer"), ("text.cti", b"no library", "cannot be loaded")],
)
async def test_a_producer_that_cannot_be_used(
    tmp_path: Path, name: str, content: bytes | None, words: str
) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    assert words in await refused(path, ProducerUnusable)


@pytest.fixture
def foreign(tmp_path: Path, producer: Path) -> Path:
    """The same producer for another kind of processor."""
    library = bytearray(producer.read_bytes())
    machine = slice(18, 20)  # e_machine of an ELF file
    library[machine] = EM_RISCV if library[machine] != EM_RISCV else EM_S390
    path = tmp_path / "other.cti"
    path.write_bytes(library)
    return path


async def test_a_producer_for_another_kind_of_processor(foreign: Path) -> None:
    assert "other.cti cannot be loaded" in await refused(foreign, ProducerUnusable)


async def test_the_folder_of_the_variable_is_enough(
    producer: Path, fakes: FakeCameras, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The producers are in several folders, in which other files lie too."""
    (tmp_path / "read.me").write_text("no producer")
    monkeypatch.setenv("GENICAM_GENTL64_PATH", f"{tmp_path}:{producer.parent}")
    async with camera(producer, producers=()) as eye:
        await eye.grab()


async def test_without_a_producer_the_variable_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("GENICAM_GENTL64_PATH", str(tmp_path))
    said = await refused(tmp_path, ProducerUnusable, producers=())
    assert "GENICAM_GENTL64_PATH" in said


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"pixel_format": "Mono14"}, "Mono8, Mono12, Mono12Packed, BayerRG8, BayerRG12"),
        ({"features": {"Binning": 2}}, "no feature Binning; it has"),
        *(
            pytest.param(*one, marks=FIGURES)
            for one in (
                ({"exposure_s": 3.0}, "10.0 to 1000000.0"),
                ({"region": Region(width=20, height=4000)}, "16 to 48"),
                ({"features": {"Gain": 99.0}}, "0.0 to 24.0"),
                ({"packet_bytes": 9004}, "576 to 9000 in steps of 4"),
                ({"packet_delay_ticks": 100_001}, "0 to 100000"),
            )
        ),
    ],
)
async def test_a_refused_feature_says_what_is_allowed(
    producer: Path, fakes: FakeCameras, settings: dict[str, object], words: str
) -> None:
    assert words in await refused(producer, CameraFeatureRefused, **settings)
    assert fakes.opened(LEFT) == 0


async def test_settings_reach_the_camera(producer: Path, fakes: FakeCameras) -> None:
    region = Region(width=32, height=16, offset_x=8, offset_y=4)
    network = {"packet_bytes": 8000, "packet_delay_ticks": 65_000}
    async with camera(
        producer, region=region, pixel_format="Mono12", gain_db=3.0, **network
    ) as eye:
        image = await eye.grab()
    assert image.pixels.shape == (16, 32)
    first = fakes.exposures(LEFT)
    assert image.pixels[0, 0] == (16 * (8 + 3 * 4 + 37 * first) + 5) & 0x0FFF


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("incomplete", "packets are missing"),
        pytest.param("truncated", "1536 bytes of buffer, 3072 are needed", marks=FIGURES),
        pytest.param("stale", "the image before came again", marks=FIGURES),
    ],
)
async def test_a_damaged_image_is_taken_again_and_counted(
    producer: Path, fakes: FakeCameras, fault: Fault, words: str
) -> None:
    async with camera(producer) as eye:
        image = await eye.grab()
        assert image.exposure is not None
        assert image.exposure.taken_again == 0
        fakes.inject(LEFT, fault, 2)
        image = await eye.grab()
        assert np.array_equal(image.pixels, expected_image(fakes.exposures(LEFT), 64, 48, "Mono8"))
        assert image.exposure is not None
        assert image.exposure.taken_again == 2
        fakes.inject(LEFT, fault, 3)
        with pytest.raises(ImagesDamaged, match=words):
            await eye.grab()
        await eye.grab()


@pytest.mark.figures  # one more library process
async def test_a_camera_without_clock_is_not_believed_twice(
    tmp_path: Path, fakes: FakeCameras
) -> None:
    """Its time stamps are all 0; the numbers of its frames tell an old image."""
    producer = build_producer(tmp_path, "-O0", "-DTICKS_PER_S=0")
    async with camera(producer) as eye:
        image = await eye.grab()
        fakes.inject(LEFT, "stale", 1)
        image = await eye.grab()
    assert image.exposure is not None
    assert image.exposure.device_time_ns is None
    assert image.exposure.taken_again == 1
    assert np.array_equal(image.pixels, expected_image(2, 64, 48, "Mono8"))


@pytest.mark.figures  # waits for many images that never come
@pytest.mark.parametrize("fault", [pytest.param("incomplete", marks=FIGURES), "drop"])
async def test_a_head_whose_right_image_fails_leaves_no_descriptor_of_the_left(
    producer: Path, fakes: FakeCameras, fault: Fault
) -> None:
    settings = GigeHeadConfig(
        left=Selection(serial_number=LEFT),
        right=Selection(serial_number=RIGHT),
        producers=(producer,),
        exposure_s=0.001,
        image_timeout_s=2.0,
        tries=1,
        max_difference_s=2.0,
    )
    async with GigeHead("head", settings) as head:
        await head.grab()
        before = await descriptors(head, fakes.opened(LEFT))
        # Up to MOST_FREE blocks wait for later images, before and after: how many depends on how
        # soon the images before were let go of.
        for _ in range(2 * MOST_FREE + 1):
            fakes.inject(RIGHT, fault, 1)
            with pytest.raises((ImagesDamaged, ReplyTimeout)):
                await head.grab()
        await head.grab()
        assert await descriptors(head, fakes.opened(LEFT)) <= before + MOST_FREE


async def test_an_image_that_comes_late_is_nobodys(producer: Path, fakes: FakeCameras) -> None:
    async with camera(producer, image_timeout_s=2.0) as eye:
        fakes.inject(LEFT, "slow_ms", 30_000)
        with pytest.raises(ReplyTimeout):
            await eye.grab()
        fakes.inject(LEFT, "slow_ms", 0)
        image = await eye.grab()
        assert image.pixels[0, 0] == (37 * fakes.exposures(LEFT)) & 0xFF


async def test_a_camera_that_is_unplugged_is_opened_again_by_itself(
    producer: Path, fakes: FakeCameras
) -> None:
    async with camera(producer) as eye:
        for _ in range(2):
            await eye.grab()
            fakes.inject(LEFT, "lost")
            with pytest.raises(LinkLost):
                await eye.grab()
            with pytest.raises(CameraAbsent):
                await eye.grab()
            with pytest.raises(CameraAbsent):
                await eye.connect()
            fakes.inject(LEFT, "lost", 0)
            image = await eye.grab()
            assert image.pixels[0, 0] == 37  # the first of the camera that was switched on anew


async def test_a_short_loss_costs_one_fault(producer: Path, fakes: FakeCameras) -> None:
    """The cable is back before anybody asks, and what was open is dead all the same."""
    async with camera(producer) as eye:
        await eye.grab()
        fakes.inject(LEFT, "lost")
        fakes.inject(LEFT, "lost", 0)
        with pytest.raises(LinkLost):
            await eye.grab()
        await eye.connect()
        await eye.grab()


@pytest.mark.parametrize("trigger", [pytest.param("none", marks=FIGURES), "Line1"])
async def test_a_lost_camera_that_nothing_is_sent_to_is_asked_for(
    producer: Path, fakes: FakeCameras, trigger: str
) -> None:
    """Long before its image would be late: with a trigger by wire that may be a minute."""
    async with camera(producer, trigger=trigger, image_timeout_s=60.0) as eye:
        first = asyncio.create_task(eye.grab())
        while not first.done():
            fakes.pulse()
            await asyncio.wait({first}, timeout=0.1)
        await first
        fakes.inject(LEFT, "slow_ms", 60_000)
        begun = fakes.begun(LEFT)
        waiting = asyncio.create_task(eye.grab())
        while fakes.begun(LEFT) == begun:
            fakes.pulse()
            await asyncio.wait({waiting}, timeout=0.1)
        assert not waiting.done()
        fakes.inject(LEFT, "lost")
        fakes.inject(LEFT, "lost", 0)
        with pytest.raises(LinkLost):
            await asyncio.wait_for(waiting, 20.0)


async def test_a_camera_that_is_slow_is_not_lost(producer: Path, fakes: FakeCameras) -> None:
    async with camera(producer, image_timeout_s=10.0) as eye:
        fakes.inject(LEFT, "slow_ms", 1500)
        await eye.grab()


async def test_nothing_is_left_behind(producer: Path, fakes: FakeCameras) -> None:
    before = len(os.listdir("/proc/self/fd"))
    for _ in range(2):
        async with camera(producer) as eye:
            images = [await eye.grab() for _ in range(20)]
            assert fakes.buffers(LEFT) == 4
        del images
    assert len(os.listdir("/proc/self/fd")) <= before + 1
    assert (fakes.opened(LEFT), fakes.buffers(LEFT)) == (0, 0)


async def test_images_that_are_kept_are_not_written_over(
    producer: Path, fakes: FakeCameras
) -> None:
    """However many; and the memory of those that are let go is used again."""
    async with camera(producer) as eye:
        kept = [(await eye.grab()).pixels[4:, ::2] for _ in range(12)]
        library = fakes.opened(LEFT)
        open_then = await descriptors(eye, library)
        for _ in range(40):
            await eye.grab()
        assert await descriptors(eye, library) <= open_then + 2 * 2
        for number, pixels in enumerate(kept, start=1):
            assert np.array_equal(pixels, expected_image(number, 64, 48, "Mono8")[4:, ::2])
        kept.clear()
        del pixels
        await eye.grab()
        assert await descriptors(eye, library) < open_then


async def test_a_head_whose_cameras_do_not_meet(producer: Path, fakes: FakeCameras) -> None:
    settings = GigeHeadConfig(
        left=Selection(serial_number=LEFT),
        right=Selection(serial_number=RIGHT),
        producers=(producer,),
        exposure_s=0.001,
        image_timeout_s=10.0,
        max_difference_s=1.0,
    )
    async with GigeHead("head", settings) as head:
        assert await head.serial_number() == f"{LEFT}+{RIGHT}"
        await head.grab()
        fakes.inject(RIGHT, "slow_ms", 2500)
        with pytest.raises(CamerasNotTogether):
            await head.grab()


async def test_a_caller_who_gives_up_does_not_disturb_the_next(
    producer: Path, fakes: FakeCameras
) -> None:
    async with camera(producer) as eye:
        grab = asyncio.create_task(eye.grab())
        await asyncio.wait({grab}, timeout=0.001)
        grab.cancel()
        before = fakes.exposures(LEFT)
        image = await eye.grab()
        assert fakes.exposures(LEFT) > before or before == 0
        assert image.pixels[0, 0] == (37 * fakes.exposures(LEFT)) & 0xFF
