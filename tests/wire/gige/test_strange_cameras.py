"""Cameras that lack features, name them by another edition of the standard, or were left set up."""

import re
from pathlib import Path

import numpy as np
import pytest
from genicam import genapi

from cellctl.clock import now_s
from cellctl.errors.camera import CameraFeatureRefused
from cellctl.interfaces.camera import PixelFormat
from drivers.camera.gige.config import GigeCameraConfig, Region, Selection
from drivers.camera.gige.library_process.features import Features
from fakes.gentl.build import SOURCES, build_producer
from fakes.gentl.cameras import FakeCameras, expected_image
from fakes.gentl.formats import Format
from tests.wire.gige.conftest import LEFT, camera

LONG = pytest.mark.long
FIGURES = pytest.mark.figures
"""Of all kinds of cameras; each has a producer and a process of its own."""
AUTOMATIC = """
  <Enumeration Name="ExposureAuto" NameSpace="Standard">
    <EnumEntry Name="Off" NameSpace="Standard"><Value>0</Value></EnumEntry>
    <EnumEntry Name="Continuous" NameSpace="Standard"><Value>1</Value></EnumEntry>
    <pValue>ExposureAutoReg</pValue>
  </Enumeration>
  <IntReg Name="ExposureAutoReg"><Address>0x60</Address><Length>4</Length>
    <AccessMode>RW</AccessMode><pPort>Device</pPort><Sign>Unsigned</Sign>
    <Endianess>LittleEndian</Endianess></IntReg>
"""


def producer_of(folder: Path, description: str) -> Path:
    path = folder / "camera.xml"
    path.write_text(description, encoding="utf-8")
    # Each of these producers serves one test: what an optimising compiler costs, it never earns.
    return build_producer(folder, "-O0", camera_xml=path)


def description() -> str:
    return (SOURCES / "camera.xml").read_text(encoding="utf-8")


def without(name: str, text: str) -> str:
    """The description without a feature, and without its place in a category."""
    text = text.replace(f"    <pFeature>{name}</pFeature>\n", "")
    found = re.subn(rf'  <(\w+) Name="{name}" .*?</\1>\n', "", text, flags=re.DOTALL)
    assert found[1] == 1
    return found[0]


def lacking(name: str, how: str, text: str) -> str:
    """The description with a feature that it names and the camera has not, as of a family's."""
    found = re.subn(rf'(<\w+ Name="{name}" NameSpace="Standard">)', rf"\1<{how}>No</{how}>", text)
    assert found[1] == 1
    port = '  <Port Name="Device"'
    no = "" if '"No"' in text else '  <Integer Name="No"><Value>0</Value></Integer>\n'
    return found[0].replace(port, no + port)


async def test_no_software_trigger(tmp_path: Path, fakes: FakeCameras) -> None:
    producer = producer_of(tmp_path, without("TriggerSoftware", description()))
    with pytest.raises(CameraFeatureRefused, match="no software trigger"):
        await camera(producer).connect()
    assert fakes.opened(LEFT) == 0
    async with camera(producer, trigger="none") as eye:
        assert (await eye.grab()).pixels.shape == (48, 64)


@FIGURES
async def test_no_selector_gain_or_serial_number(tmp_path: Path, fakes: FakeCameras) -> None:
    text = description()
    for name in ("TriggerSelector", "Gain", "DeviceSerialNumber", "AcquisitionMode"):
        text = without(name, text)
    async with camera(producer_of(tmp_path, text)) as eye:
        image = await eye.grab()
        assert await eye.serial_number() == LEFT  # which its producer knows
    assert image.exposure is not None
    assert image.exposure.gain_db is None
    assert np.array_equal(image.pixels, expected_image(1, 64, 48, "Mono8"))


@FIGURES
@pytest.mark.parametrize(
    "how", ["pIsAvailable", pytest.param("pIsImplemented", marks=pytest.mark.long)]
)
async def test_features_of_the_family_that_this_camera_lacks(
    tmp_path: Path, fakes: FakeCameras, how: str
) -> None:
    listed = "    <pFeature>ExposureTime</pFeature>\n"
    text = description().replace(listed, listed + listed.replace("Time", "Auto"))
    text = text.replace('  <Float Name="ExposureTime"', AUTOMATIC + '  <Float Name="ExposureTime"')
    for name in ("ExposureAuto", "TriggerSelector", "Gain"):
        text = lacking(name, how, text)
    producer = producer_of(tmp_path, text)
    async with camera(producer) as eye:
        image = await eye.grab()
    assert image.exposure is not None
    assert image.exposure.exposure_s == pytest.approx(0.001)
    assert image.exposure.gain_db is None
    words = "no feature Gain" if how == "pIsImplemented" else "has the feature Gain, but not"
    with pytest.raises(CameraFeatureRefused, match=words):
        await camera(producer, gain_db=3.0).connect()


@FIGURES
async def test_the_gain_of_an_older_edition(tmp_path: Path, fakes: FakeCameras) -> None:
    text = description().replace('"Gain"', '"GainAbs"').replace(">Gain<", ">GainAbs<")
    async with camera(producer_of(tmp_path, text), gain_db=4.0) as eye:
        image = await eye.grab()
    assert image.exposure is not None
    assert image.exposure.gain_db == pytest.approx(4.0)


@FIGURES
async def test_a_camera_that_cannot_move_its_region(tmp_path: Path, fakes: FakeCameras) -> None:
    text = without("OffsetY", without("OffsetX", description()))
    producer = producer_of(tmp_path, text)
    async with camera(producer, region=Region(width=32, height=16)) as eye:
        assert (await eye.grab()).pixels.shape == (16, 32)
    with pytest.raises(CameraFeatureRefused, match="no feature OffsetX"):
        await camera(producer, region=Region(width=32, height=16, offset_x=8)).connect()


@FIGURES
@pytest.mark.parametrize(
    ("asked", "meant"),
    [("Exposuretime", "ExposureTime"), ("PacketSize", "GevSCPSPacketSize"), ("Gian", "Gain")],
)
async def test_a_mistyped_feature_is_answered_with_those_that_are_meant(
    producer: Path, fakes: FakeCameras, asked: str, meant: str
) -> None:
    with pytest.raises(
        CameraFeatureRefused, match=f"it has ({meant}$|{meant},|.*, {meant})"
    ) as said:
        await camera(producer, features={asked: 1}).connect()
    assert str(said.value).count(",") < 12


@FIGURES
async def test_the_exposure_of_an_older_edition(tmp_path: Path, fakes: FakeCameras) -> None:
    text = description().replace('"ExposureTime"', '"ExposureTimeAbs"')
    text = text.replace("<pFeature>ExposureTime<", "<pFeature>ExposureTimeAbs<")
    async with camera(producer_of(tmp_path, text), exposure_s=0.002) as eye:
        image = await eye.grab()
    assert image.exposure is not None
    assert image.exposure.exposure_s == pytest.approx(0.002)


@pytest.mark.figures  # compiles a producer of its own
async def test_an_automatic_exposure_is_switched_off_first(
    tmp_path: Path, fakes: FakeCameras
) -> None:
    """The exposure is read-only as long as the automatic one is on, as in many cameras."""
    listed, opening = "    <pFeature>ExposureTime</pFeature>\n", '<Float Name="ExposureTime" '
    text = description().replace(listed, listed + listed.replace("Time", "Auto"))
    lock = "<pIsLocked>ExposureAutoReg</pIsLocked>"
    head = f'{opening}NameSpace="Standard">'
    assert head in text
    text = text.replace(f"  {head}", f"{AUTOMATIC}  {head}{lock}")
    producer = producer_of(tmp_path, text)
    automatic = {"ExposureAuto": "Continuous"}
    async with camera(producer, exposure_s=None, features=automatic) as eye:
        image = await eye.grab()
        assert image.exposure is not None
        assert image.exposure.exposure_s is None
    async with camera(producer, exposure_s=0.003) as eye:
        image = await eye.grab()
        assert image.exposure is not None
        assert image.exposure.exposure_s == pytest.approx(0.003)


@pytest.mark.parametrize(
    "pixel_format", ["Mono12Packed", *(pytest.param(f, marks=LONG) for f in ("Mono8", "Mono12"))]
)
async def test_padded_lines_and_packed_samples(
    tmp_path: Path, fakes: FakeCameras, pixel_format: Format
) -> None:
    producer = build_producer(tmp_path, "-O0", "-DLINE_PADDING=12")
    async with camera(producer, pixel_format=pixel_format) as eye:
        image = await eye.grab()
    assert np.array_equal(image.pixels, expected_image(1, 64, 48, pixel_format))


CHUNKS = {"ChunkModeActive": True}


@pytest.mark.parametrize("pixel_format", [pytest.param("Mono8", marks=FIGURES), "Mono12Packed"])
async def test_chunks_behind_an_image(
    tmp_path: Path, fakes: FakeCameras, pixel_format: Format
) -> None:
    """With an automatic exposure, only they know how long this image was exposed."""
    text = description().replace(
        '  <Float Name="ExposureTime"', AUTOMATIC + '  <Float Name="ExposureTime"'
    )
    features = CHUNKS | {"ExposureAuto": "Continuous", "ExposureTime": 2500.0, "Gain": 6.0}
    producer = producer_of(tmp_path, text)
    async with camera(
        producer, pixel_format=pixel_format, exposure_s=None, features=features
    ) as eye:
        images = [await eye.grab() for _ in range(3)]
    for number, image in enumerate(images, start=1):
        assert np.array_equal(image.pixels, expected_image(number, 64, 48, pixel_format))
        assert image.exposure is not None
        assert image.exposure.exposure_s == pytest.approx(0.0025)
        assert image.exposure.gain_db == pytest.approx(6.0)


@pytest.mark.figures  # compiles a producer of its own
async def test_chunks_that_a_camera_does_not_describe(tmp_path: Path, fakes: FakeCameras) -> None:
    """They stay unread, and the image is whole."""
    text = description()
    for name in ("ChunkExposureTime", "ChunkGain", "ChunkFrameID"):
        text = without(name, text)
    for port in ("Exposure", "Gain", "Frame"):
        text = re.sub(rf'  <Port Name="Chunk{port}Port">.*\n', "", text)
    async with camera(producer_of(tmp_path, text), features=CHUNKS, gain_db=1.0) as eye:
        image = await eye.grab()
    assert np.array_equal(image.pixels, expected_image(1, 64, 48, "Mono8"))
    assert image.exposure is not None
    assert image.exposure.gain_db == pytest.approx(1.0)


async def test_a_mosaic_as_colour_and_as_grey(producer: Path, fakes: FakeCameras) -> None:
    async with camera(producer, pixel_format="BayerRG8") as eye:
        colour = await eye.grab()
    async with camera(producer, pixel_format="BayerRG8", grey=True) as eye:
        grey = await eye.grab()
    assert colour.pixel_format is PixelFormat.RGB8
    assert grey.pixel_format is PixelFormat.MONO8
    expected = np.rint(colour.pixels @ np.array([0.299, 0.587, 0.114]))
    assert np.array_equal(grey.pixels, expected)


@FIGURES
async def test_a_deep_mosaic_keeps_its_bits_as_colour(producer: Path, fakes: FakeCameras) -> None:
    async with camera(producer, pixel_format="BayerRG12") as eye:
        colour = await eye.grab()
    async with camera(producer, pixel_format="BayerRG12", grey=True) as eye:
        grey = await eye.grab()
    assert colour.pixel_format is PixelFormat.RGB16
    assert colour.exposure is not None
    assert colour.exposure.bits == 12
    mosaic = expected_image(1, 64, 48, "BayerRG12")
    # Under a filter the colour of that filter is what was measured: red at even rows and columns.
    assert np.array_equal(colour.pixels[2:-2:2, 2:-2:2, 0], mosaic[2:-2:2, 2:-2:2])
    assert colour.pixels.max() > 255
    assert grey.pixel_format is PixelFormat.MONO8
    # The first frame again: the camera was opened anew.
    luma = np.rint(colour.pixels @ np.array([0.299, 0.587, 0.114]))
    assert np.array_equal(grey.pixels, luma.astype(np.uint16) >> 4)


async def test_a_format_that_is_not_read_is_refused_before_the_first_image(
    tmp_path: Path, fakes: FakeCameras
) -> None:
    """A colour camera that was left at YUV422_8, by the number that PFNC gives it."""
    listed = '<EnumEntry Name="Mono8" NameSpace="Standard"><Value>0x01080001<'
    text = description()
    assert listed in text
    text = text.replace(listed, listed.replace("Mono8", "YUV422_8").replace("01080001", "02100032"))
    eye = camera(producer_of(tmp_path, text), pixel_format="YUV422_8")
    with pytest.raises(CameraFeatureRefused, match=r"YUV422_8 is not supported.*set pixel_format"):
        await eye.connect()
    assert fakes.opened(LEFT) == 0


@pytest.mark.figures  # compiles a producer of its own
async def test_a_clock_of_ticks(tmp_path: Path, fakes: FakeCameras) -> None:
    producer = build_producer(tmp_path, "-O0", "-DTICKS_PER_S=125000000")
    async with camera(producer) as eye:
        before_s = now_s()
        image = await eye.grab()
        after_s = now_s()
    assert image.exposure is not None
    assert image.exposure.device_time_ns is not None
    assert before_s <= image.exposure.device_time_ns * 1e-9 <= after_s


class Node:
    """A feature with a value, and with one for each entry of a selector."""

    def __init__(self, value: object, symbolics: list[str] | None = None) -> None:
        self.value = value
        self.symbolics = symbolics

    def get_access_mode(self) -> int:
        return int(genapi.EAccessMode.RW)


class TriggerNodes:
    """The triggers of a camera: mode and delay belong to what TriggerSelector selects."""

    def __init__(self) -> None:
        self.delays = {"AcquisitionStart": Node(0.0), "FrameStart": Node(0.0)}
        self.modes = {"AcquisitionStart": Node("On"), "FrameStart": Node("Off")}
        self.TriggerSelector = Node("AcquisitionStart", list(self.modes))
        self.TriggerSource = Node("Line1")
        self.TriggerSoftware = Node(None)

    @property
    def TriggerMode(self) -> Node:
        return self.modes[str(self.TriggerSelector.value)]

    @property
    def TriggerDelay(self) -> Node:
        return self.delays[str(self.TriggerSelector.value)]


@pytest.mark.parametrize("name", ["GevSCPSPacketSize", "DeviceStreamChannelPacketSize"])
def test_packets_are_set_for_the_network_by_the_name_of_either_edition(name: str) -> None:
    nodes = TriggerNodes()
    size, delay = Node(1500), Node(0)
    setattr(nodes, name, size)
    nodes.GevSCPD = delay  # type: ignore[attr-defined]
    settings = GigeCameraConfig(
        camera=Selection(serial_number=LEFT), packet_bytes=8000, packet_delay_ticks=65_000
    )
    Features(nodes, "eye").set_up(settings.setup_of(settings.camera).settings)
    assert (size.value, delay.value) == (8000, 65_000)


def test_another_trigger_that_was_left_on_is_switched_off() -> None:
    nodes = TriggerNodes()
    settings = GigeCameraConfig(camera=Selection(serial_number=LEFT))
    Features(nodes, "eye").set_up(settings.setup_of(settings.camera).settings)
    assert {name: mode.value for name, mode in nodes.modes.items()} == {
        "AcquisitionStart": "Off",
        "FrameStart": "On",
    }
    assert nodes.TriggerSource.value == "Software"


def test_features_of_the_settings_meet_the_trigger_of_a_frame() -> None:
    nodes = TriggerNodes()
    settings = GigeCameraConfig(
        camera=Selection(serial_number=LEFT), features={"TriggerDelay": 20.0}
    )
    Features(nodes, "eye").set_up(settings.setup_of(settings.camera).settings)
    assert nodes.delays["FrameStart"].value == 20.0
    assert nodes.delays["AcquisitionStart"].value == 0.0


def test_a_feature_that_selects_another_trigger_moves_no_trigger_away() -> None:
    nodes = TriggerNodes()
    settings = GigeCameraConfig(
        camera=Selection(serial_number=LEFT), features={"TriggerSelector": "AcquisitionStart"}
    )
    Features(nodes, "eye").set_up(settings.setup_of(settings.camera).settings)
    assert nodes.modes["FrameStart"].value == "On"
    assert nodes.modes["AcquisitionStart"].value == "Off"
