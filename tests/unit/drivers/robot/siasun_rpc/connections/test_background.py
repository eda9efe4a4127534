"""Work in the background: a fault is known by then, a defect is told to the log."""

import asyncio
import logging

import pytest

from cellctl.errors.link import LinkLost
from drivers.robot.siasun_rpc.connections.background import BackgroundTasks


async def _raises(error: Exception) -> None:
    raise error


@pytest.mark.parametrize(("error", "lines"), [(LinkLost("gone"), 0), (ZeroDivisionError(), 1)])
async def test_only_a_defect_is_told(
    error: Exception, lines: int, caplog: pytest.LogCaptureFixture
) -> None:
    task = BackgroundTasks().start(_raises(error))
    with caplog.at_level(logging.ERROR):
        await asyncio.wait({task})
        await asyncio.sleep(0)
    assert len(caplog.records) == lines
    assert all(record.exc_info for record in caplog.records)
