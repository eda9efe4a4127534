"""Small pictures in the renderer's place, for tests of the wire around it."""

import zlib
from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from typing import Any

from fakes.render.worker import Frame

WIDTH, HEIGHT = 8, 6


@dataclass(frozen=True)
class _Scene:
    """All that the frame server itself reads of a scene."""

    time_s: float


class Ramp(Executor):
    """Answers a rendering job at once, with another picture each time."""

    def __init__(self) -> None:
        self.exposures = 0

    def scene(self) -> Any:
        """A scene whose time moves on."""
        return _Scene(float(self.exposures))

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> "Future[Any]":
        self.exposures += 1
        payload = bytes((self.exposures + k) % 256 for k in range(2 * WIDTH * HEIGHT))
        future: Future[Any] = Future()
        future.set_result(Frame(WIDTH, HEIGHT, payload, zlib.crc32(payload)))
        return future
