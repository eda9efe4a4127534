"""The course of a stream, whatever its controller speaks: begin, follow, finish."""

import contextlib
from collections.abc import AsyncIterator
from typing import Any, Protocol

from cellctl.errors.base import CellError
from cellctl.errors.robot import TargetOutOfBounds
from cellctl.interfaces.streaming_robot import StreamLimits


class CommandedStream(Protocol):
    """A stream with its ends, which its driver sees to."""

    limits: StreamLimits

    async def begin(self) -> None:
        """Before the first setpoint."""

    async def finish(self, timeout_s: float) -> Any:
        """Stand at the last setpoint, for which the controller has so long."""


@contextlib.asynccontextmanager
async def followed(
    stream: CommandedStream, timeout_s: float, *, not_taken: type[CellError] = TargetOutOfBounds
) -> AsyncIterator[None]:
    """From the first setpoint to standstill, for which the controller has ``timeout_s``.

    A setpoint that was refused by its bounds was not sent; ``not_taken`` is another refusal after
    which the stream of this controller goes on. Then the stream is finished and not stopped: the
    arm goes no further than to its last setpoint, while a stop with its dead time would let it run
    on. Where standstill is not confirmed within the loss time, whoever leaves the stream stops it.
    """
    await stream.begin()
    try:
        yield
    except (TargetOutOfBounds, not_taken):
        with contextlib.suppress(CellError):
            await stream.finish(stream.limits.loss_s)
        raise
    await stream.finish(timeout_s)
