"""A session with the fake producer through harvesters: `good`, `faults` or `loss` by its argument.

A program of its own, because it runs under sanitizers, which are loaded before Python is.
"""

import logging
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from genicam import genapi, gentl
from harvesters.core import Harvester

from drivers.camera.gige.library_process.delivered import delivered
from drivers.camera.gige.library_process.loss_event import LossEvent
from drivers.camera.gige.library_process.producers import Producers
from fakes.gentl.cameras import ENVIRONMENT, FakeCamera, FakeCameras, Fault, expected_image

LEFT, RIGHT = "GL-1", "GR-2"
ERRORS = (genapi.GenericException, gentl.GenericException)
FORMATS = ("Mono8", "Mono12", "Mono12Packed", "BayerRG8", "BayerRG12")
FAULTS: tuple[Fault, ...] = ("incomplete", "truncated", "stale", "drop")


@contextmanager
def opened(producer: Path) -> Iterator[list[Any]]:
    """Both cameras of the network."""
    producers = Producers((producer,))
    there = {found.seen.serial_number: found for found in producers.look()}
    try:
        yield [there[serial].create() for serial in (LEFT, RIGHT)]
    finally:
        producers.close()


def nodes_of(camera: Any) -> Any:
    return camera.remote_device.node_map


def triggered(camera: Any, source: str) -> None:
    nodes_of(camera).TriggerMode.value = "On"
    nodes_of(camera).TriggerSource.value = source


def image(camera: Any, timeout_s: float = 10.0) -> Any:
    """Shape and bytes of the next image; None for none within the time."""
    buffer = camera.try_fetch(timeout=timeout_s, is_raw=True)
    if buffer is None:
        return None
    found = delivered(buffer, nodes_of(camera))
    assert found is not None
    copied = (found.width, found.height, found.data.copy())
    buffer.parent.queue_buffer(buffer)
    return copied


def good(producer: Path) -> None:
    """Formats, regions, chunks, software trigger, several openings."""
    for _ in range(3):
        with opened(producer) as cameras:
            for camera in cameras:
                triggered(camera, "Software")
            for pixel_format, chunks in product(FORMATS, (False, True)):
                for camera in cameras:
                    nodes_of(camera).PixelFormat.value = pixel_format
                    nodes_of(camera).ChunkModeActive.value = chunks
                    camera.start()
                some_images(cameras)
                for camera in cameras:
                    camera.stop()


def some_images(cameras: list[Any]) -> None:
    """A few of each, both triggered before the first is fetched."""
    for _ in range(5):
        for camera in cameras:
            nodes_of(camera).TriggerSoftware.execute()
        for camera in cameras:
            assert image(camera)[:2] == (64, 48)


def faults(producer: Path, fakes: FakeCameras) -> None:
    """What goes wrong with images, with the stream, and with the camera."""
    taken(producer, fakes)
    with opened(producer) as (left, right):
        triggered(left, "Software")
        nodes_of(left).ChunkModeActive.value = True
        left.start()
        for fault in FAULTS:
            fakes.inject(LEFT, fault)
            for _ in range(3):
                nodes_of(left).TriggerSoftware.execute()
                with suppress(ValueError):  # of a truncated one
                    image(left, 1.0)
        hangs(left, fakes)
        fakes.inject(LEFT, "slow_ms", 300)
        nodes_of(left).TriggerSoftware.execute()
        left.stop()  # within the exposure
        left.start()
        nodes_of(left).TriggerSoftware.execute()
        assert image(left) is not None
        fakes.inject(LEFT, "slow_ms", 0)
        triggered(right, "Line1")
        fakes.wire(output=LEFT, to=RIGHT)
        right.start()
        nodes_of(left).TriggerSoftware.execute()
        assert image(right) is not None
        right.stop()
        nodes_of(right).TriggerMode.value = "Off"
        right.start()
        assert image(right) is not None
        fakes.inject(RIGHT, "lost")
        for use in (nodes_of(right).AcquisitionStop.execute, lambda: image(right, 0.1)):
            with suppress(*ERRORS):
                use()
        fakes.inject(RIGHT, "lost", 0)
    with opened(producer) as (left, _):
        triggered(left, "Software")
        left.start()
        nodes_of(left).TriggerSoftware.execute()
        width, height, data = image(left)
        assert np.array_equal(data.reshape(height, width), expected_image(1, 64, 48, "Mono8"))


def hangs(left: Any, fakes: FakeCameras) -> None:
    """A register that does not answer for a while: Python stands still meanwhile, all of it."""
    fakes.inject(LEFT, "hang")
    begun_s = time.monotonic()
    ends_it = os.fork()
    if not ends_it:
        time.sleep(0.2)
        fakes.inject(LEFT, "hang", 0)
        os._exit(0)
    nodes_of(left).TriggerSoftware.execute()
    assert time.monotonic() - begun_s >= 0.2
    os.waitpid(ends_it, 0)
    assert image(left) is not None


def taken(producer: Path, fakes: FakeCameras) -> None:
    """A camera that another program has, and one that is open here already."""
    producers = Producers((producer,))
    there = {found.seen.serial_number: found for found in producers.look()}
    there[LEFT].create()
    fakes.inject(RIGHT, "busy")
    for serial in (LEFT, RIGHT):
        try:
            there[serial].create()
        except ERRORS:
            continue
        raise AssertionError(f"{serial} was opened twice")
    fakes.inject(RIGHT, "busy", 0)
    producers.close()


def loss(producer: Path, fakes: FakeCameras) -> None:
    """The event of a device module that says, once, that its camera is lost; to the driver too."""
    harvester = Harvester()
    harvester.add_file(str(producer))
    harvester.update()
    device = harvester.device_info_list[0].module.create_device()
    device.open(gentl.DEVICE_ACCESS_FLAGS_LIST.DEVICE_ACCESS_EXCLUSIVE)
    event = gentl.EventManagerModule(device.register_event(gentl.EVENT_TYPE_LIST.EVENT_MODULE))
    assert not told(event, 50)
    fakes.inject(LEFT, "lost")
    fakes.inject(LEFT, "lost", 0)
    assert told(event, 5000)
    assert not told(event, 50)
    event.unregister_event()
    device.close()
    device.open(gentl.DEVICE_ACCESS_FLAGS_LIST.DEVICE_ACCESS_EXCLUSIVE)
    for_driver = LossEvent(device)
    assert not for_driver.told()
    fakes.inject(LEFT, "lost")
    assert for_driver.told()
    assert not for_driver.told()
    for_driver.close()
    assert not for_driver.told()
    device.close()
    no_events = LossEvent(device)
    assert not no_events.told()
    no_events.close()
    harvester.reset()


def told(event: Any, timeout_ms: int) -> bool:
    """Whether the event has come within the time."""
    try:
        event.update_event_data(timeout_ms)
    except gentl.TimeoutException:
        return False
    return True


def main(producer: Path, what: str) -> None:
    """Run one of the three; the log of harvesters goes to the standard error stream."""
    logger = logging.getLogger("harvesters.core")
    logger.setLevel(logging.WARNING)
    for handler in logger.handlers:
        handler.setLevel(logging.WARNING)
    cameras = [FakeCamera(LEFT, "left eye", 64, 48), FakeCamera(RIGHT, "right eye", 64, 48)]
    with TemporaryDirectory() as folder, FakeCameras(Path(folder, "cameras"), cameras) as fakes:
        os.environ[ENVIRONMENT] = str(fakes.path)
        if what == "good":
            good(producer)
        else:
            {"faults": faults, "loss": loss}[what](producer, fakes)
        assert (fakes.opened(LEFT), fakes.buffers(LEFT)) == (0, 0)
    print("clean")


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
