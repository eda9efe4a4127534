"""The SRI driver against the fake box: the box in the test's loop, the driver in a thread."""

import asyncio
import random
import time
from collections.abc import Callable
from typing import Any, TypeVar

from drivers.ftsensor.sri.driver import SriSensor
from fakes.wire.sri.box import SriBox

WRENCH = (10.0, -20.0, -1962.0, 1.5, -2.5, 0.25)
T = TypeVar("T")


def noisy(time_s: float) -> list[float]:
    """The wrench at any time, with noise, so that no value repeats."""
    return [value + random.gauss(0.0, 0.05) for value in WRENCH]


async def tcp_sensor(box: SriBox, **settings: Any) -> SriSensor:
    """A driver for this box over TCP, not yet open."""
    port = await box.start_tcp()
    values = {"transport": "tcp", "host": "127.0.0.1", "port": port, "rate_hz": 500}
    return SriSensor(SriSensor.Config.model_validate(values | settings))


async def blocking(call: Callable[[], T]) -> T:
    """Run a blocking call of the driver beside the box."""
    return await asyncio.wait_for(asyncio.to_thread(call), 8)


READ_UNTIL_S = 15.0


async def read_until(sensor: SriSensor, condition: Callable[[], bool]) -> list[Any]:
    """Read until a condition holds, at most so many seconds; the samples of that time."""

    def run() -> list[Any]:
        found: list[Any] = []
        end_s = time.monotonic() + READ_UNTIL_S
        while time.monotonic() < end_s:
            found += sensor.read(0.01)
            if condition():
                return found
        raise TimeoutError(f"condition never held: {sensor.health()}")

    return await blocking(run)
