"""The PC's contact in the permit loop of a controller that runs the jobs, over a real coupler."""

import time
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager

from drivers.io.modbus_coupler.config import ModbusCouplerConfig
from drivers.io.modbus_coupler.driver import ModbusCouplerIo
from fakes.wire.couplers.coupler import CouplerServer
from tests.rigs.wire.job_rig import JobRig
from tests.rigs.wire.proxy import ChaosProxy

PERMIT = "permit"
"""Name of the output."""
_ADDRESS = 3


@asynccontextmanager
async def permit_loop(
    rig: JobRig, *, watchdog_ms: int
) -> AsyncIterator[tuple[ModbusCouplerIo, ChaosProxy]]:
    """The driver of the coupler, its contact closed, and the wire to it."""

    coupler = CouplerServer(
        time.monotonic,
        inputs=lambda _: {0: True},
        output_addresses=[_ADDRESS],
        watchdog_ms=watchdog_ms,
    )
    # The controller asks at each of its ticks, by which the watchdog of the coupler has its clock.
    rig.controller.contact_closed = lambda: coupler.outputs[_ADDRESS]
    async with AsyncExitStack() as stack:
        wire = await stack.enter_async_context(ChaosProxy(await coupler.start()))
        stack.push_async_callback(coupler.stop)
        settings = ModbusCouplerConfig(
            host="127.0.0.1", port=wire.port, inputs={"ready": 0}, outputs={PERMIT: _ADDRESS}
        )
        io = await stack.enter_async_context(ModbusCouplerIo("permit", settings))
        await io.write({PERMIT: True})
        yield io, wire
