"""A session with the fake producer and a fake cell that exposes, spoiled and abandoned images too.

A program of its own, as ``producer_session``.
"""

import asyncio
import os
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from fakes.gentl.cameras import ENVIRONMENT
from tests.wire.gige.producer_session import image, nodes_of, opened, triggered
from tests.wire.gige.test_cell_images import Pair

FORMATS = ("Mono8", "Mono12", "Mono12Packed", "BayerRG8", "BayerRG12", "RGB8")
SPOILED = ("silent", "truncated", "frozen", "wrong_size", "late", "hang_up")


def expose(cameras: list[Any]) -> list[Any]:
    """Trigger both, then fetch from both."""
    for camera in cameras:
        nodes_of(camera).TriggerSoftware.execute()
    return [image(camera, 1.0) for camera in cameras]


def whole(producer: Path) -> None:
    """All formats, with and without chunks; a stop while the cell still exposes."""
    with opened(producer) as cameras:
        for camera in cameras:
            triggered(camera, "Software")
        for number, pixel_format in enumerate(FORMATS):
            for camera in cameras:
                nodes_of(camera).PixelFormat.value = pixel_format
                nodes_of(camera).ChunkModeActive.value = number % 2 == 1
                camera.start()
            for _ in range(5):
                assert [found[:2] for found in expose(cameras)] == [(64, 48)] * 2
            for camera in cameras:
                nodes_of(camera).TriggerSoftware.execute()
                camera.stop()


def spoiled(producer: Path, pair: Pair) -> None:
    """Each fault once; after it the cameras are opened anew."""
    for fault in SPOILED:
        with opened(producer) as cameras:
            for camera in cameras:
                triggered(camera, "Software")
                camera.start()
            assert None not in expose(cameras)
            pair.head.faults.inject(fault, 0.1, replies=1)
            expose(cameras)


async def main(producer: Path) -> None:
    """Run all of it beside the cell."""
    with TemporaryDirectory() as folder:
        pair = Pair(Path(folder))
        os.environ[ENVIRONMENT] = str(pair.file.path)
        await pair.server.start()
        await asyncio.to_thread(whole, producer)
        await asyncio.to_thread(spoiled, producer, pair)
        await pair.server.stop()
        pair.file.close()
    print("clean")


if __name__ == "__main__":
    asyncio.run(main(Path(sys.argv[1])))
