"""Follows the hub for what adds up, and answers in the text form of Prometheus."""

from pathlib import Path

from prometheus_client import CollectorRegistry, disable_created_metrics, generate_latest

from cellctl import log
from cellctl.hmi.event_stream import Streams
from cellctl.hmi.hub import Hub
from cellctl.hmi.metrics.collector import SnapshotCollector
from cellctl.hmi.metrics.history import CellHistory

_WAIT_S = 1.0
_log = log.get(__name__)


class MetricsKeeper:
    """Has a registry of its own: that of the library has figures of this process beside them."""

    def __init__(self, hub: Hub, streams: Streams, data_dir: Path, forwarder_dir: Path) -> None:
        # Else each counter would have a second series with the time of its begin.
        disable_created_metrics()  # type: ignore[no-untyped-call]  # of the library
        self._hub = hub
        self._registry = CollectorRegistry()
        self._history = CellHistory(self._registry)
        self._registry.register(
            SnapshotCollector(hub, lambda: streams.count, data_dir, forwarder_dir)
        )

    async def run(self) -> None:
        """Count until cancelled."""
        version, told, understood = -1, -1.0, True
        while True:
            await self._hub.wait(version, _WAIT_S)
            version, snapshot = self._hub.version, self._hub.snapshot
            # A description or the link may be what has come.
            if not snapshot or snapshot["mono_s"] == told:
                continue
            told = snapshot["mono_s"]
            try:
                self._history.take(snapshot)
            except (LookupError, TypeError) as error:
                # A daemon of another version may say less. Complained of once.
                if understood:
                    _log.error("snapshot not counted", reason=repr(error))
                understood = False

    def text(self) -> bytes:
        """All metrics as they are now."""
        return bytes(generate_latest(self._registry))
