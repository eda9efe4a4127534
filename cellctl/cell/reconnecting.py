"""Devices whose link does not come back by itself."""

import asyncio
from collections.abc import Mapping

from cellctl import log
from cellctl.errors import CellError
from cellctl.interfaces.device import Device

_log = log.get(__name__)


async def reconnect(devices: Mapping[str, Device]) -> None:
    """Connect those that have lost their link; nothing happens to the others.

    Grippers and digital I/Os answer no call after a fault until they are connected again, because
    it is open what their outputs have done. Whoever clears has seen it. One that cannot be
    connected is only logged: Start is refused as long as it is away, and Clear has to end with
    everything else in order.
    """
    results = await asyncio.gather(
        *(device.connect() for device in devices.values()), return_exceptions=True
    )
    for name, result in zip(devices, results, strict=True):
        if isinstance(result, CellError):
            _log.warning("device not connected again", device=name, fault=str(result))
        elif isinstance(result, BaseException):
            raise result
