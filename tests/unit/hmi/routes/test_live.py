"""What the cell says is told also where a part of it is missing: the daemon may be a newer one."""

from typing import Any

import pytest

from cellctl.api.local_socket.live_feed import as_line
from tests.rigs.sweeps import sweep
from tests.unit.hmi.in_process import Api, lasting_s
from tests.unit.hmi.scripted_daemon import PaperDaemon, snapshot

PATHS = ("status", "permitted", "description", "health", "curve", "procedures", "plc/registers")


@pytest.mark.parametrize("key", sorted(set(snapshot()) - {"kind", "forces"}))
@pytest.mark.parametrize("language", sweep(("en", "zh"), ("en",)))
async def test_a_part_of_the_snapshot_that_is_missing(api: Api, key: str, language: str) -> None:
    said: dict[str, Any] = snapshot() | {"mono_s": lasting_s(), "mode": "MAINTENANCE"}
    del said[key]
    await api.parts.hub.take(as_line(said))
    for path in PATHS:
        reply = await api.get(path, Accept_Language=language)
        assert reply.status == 200, path


@pytest.mark.parametrize("key", sorted(PaperDaemon().description))
async def test_a_part_of_the_description_that_is_missing(api: Api, key: str) -> None:
    described = {"kind": "description", **PaperDaemon().description}
    del described[key]
    await api.parts.hub.take(as_line(described))
    for path in (*PATHS, "calibrations"):
        assert (await api.get(path, Accept_Language="zh")).status == 200, path
