"""Waits until the load of a robot has stopped swinging, as measured by its force sensor."""

import asyncio

import numpy as np

from cellctl.errors.force import NotSettled, SensorFrozen
from cellctl.geometry.pose import Array
from cellctl.guard.client import GuardClient

BLOCK = 10
"""Samples averaged to one, against noise: 10 ms at 1 kHz, short beside the 90 ms of a swing."""
STILL = np.array([1.2, 1.2, 1.2, 0.4, 0.4, 0.4])
"""Scatter of the blocks (N, N·m) that counts as still: at 1e6 N/m a movement of one or two µm
(docs/decisions/0005)."""


async def settle(guard: GuardClient) -> None:
    """Return once the raw wrench is steady.

    Raises ``NotSettled`` after a time-out, also when samples stay away, and ``SensorFrozen`` when
    they are all the same: a live sensor is never that still.
    """
    settling = guard.settling
    # The clock of the loop is the one that stamps samples, also in a loop whose time is simulated.
    loop = asyncio.get_running_loop()
    begin_s = loop.time()
    scatter = np.full(6, np.inf)
    while loop.time() - begin_s < settling.timeout_s:
        await asyncio.sleep(settling.poll_s)
        since_s = loop.time() - settling.window_s
        # Samples from before the call show the swing of the move, or the calm from before it.
        if since_s < begin_s:
            continue
        raw = guard.samples(since_s).raw
        scatter = block_scatter(raw)
        if (scatter < STILL).all():
            # The guard looks for this only while it is armed, which it is not here.
            if not np.ptp(raw, axis=0).any():
                raise SensorFrozen(f"{len(raw)} samples in a row are equal in all six channels")
            return
    shown = ", ".join(f"{value:.2f}" for value in scatter)
    raise NotSettled(f"readings still scatter by ({shown}) N, N·m after {settling.timeout_s:g} s")


def block_scatter(raw: Array) -> Array:
    """Standard deviation of block means, shape (6,), of raw wrenches, shape (n, 6).

    Infinite when there are too few samples to say.
    """
    blocks = len(raw) // BLOCK
    if blocks < 2:
        return np.full(6, np.inf)
    means = raw[: blocks * BLOCK].reshape(blocks, BLOCK, 6).mean(axis=1)
    return np.asarray(means.std(axis=0))
