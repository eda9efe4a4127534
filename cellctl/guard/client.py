"""The daemon's side of the guard. Used from the event loop only."""

import asyncio
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl import log
from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.force import GuardDied, SensorSilent
from cellctl.force.compensation import Compensation
from cellctl.guard import vitals
from cellctl.guard.child import GuardChild
from cellctl.guard.limits import GuardLimits, GuardSettings
from cellctl.guard.messages import Message, fault_from_json, limits_to_json, trip_from_json
from cellctl.guard.report import Curve, GuardHealth, GuardSample, GuardTrip, TareResult, TripReason
from cellctl.guard.requests import Requests

_log = log.get(__name__)


class GuardClient:
    """Starts, supervises and asks the guard process.

    Requests raise ``GuardRefused`` with the guard's reason or ``GuardDied``. When the guard dies,
    ``trip`` becomes ``GUARD_DIED`` and stays until ``acknowledge``. That starts a new guard in the
    place of one that is of no use, and gives it the last compensation and deck frame, but no tare.
    """

    def __init__(
        self,
        sensor_plugin: str,
        sensor_config: dict[str, Any],
        stop_plugin: str | None,
        stop_config: dict[str, Any] | None,
        settings: GuardSettings,
    ) -> None:
        self._sensor = {"name": sensor_plugin, "config": sensor_config}
        self._stop = None
        if stop_plugin is not None:
            self._stop = {"name": stop_plugin, "config": stop_config or {}}
        self._settings = settings
        self._child: GuardChild | None = None
        self._started: asyncio.Future[None] | None = None
        self._stopping = self._ready = False
        self._requests = Requests(settings.reply_timeout_s)
        self._trip: GuardTrip | None = None
        self._fault: CellError | None = None
        """Why the guard could not start, or gave up its sensor."""
        self._serial = ""
        self._degraded: tuple[str, ...] = ()
        self._channel_up = False
        self._load: Message | None = None
        self._deck_frame: Message | None = None

    # --- life

    async def start(self) -> None:
        """Start the guard and wait until sensor and stop channel stand. Idempotent.

        Raises what the drivers raise in the guard, or ``GuardDied``.
        """
        if self.running:
            return
        await self.stop()
        self._stopping = self._ready = False
        self._fault = None
        self._started = asyncio.get_running_loop().create_future()
        self._child = GuardChild(self._settings.ring_slots, self._take, self._died)
        try:
            self._child.send(self._set_up())
            await self._until_started(self._started)
        except BaseException as error:
            await self.stop()
            self._fault = error if isinstance(error, CellError) else None
            raise
        for measure in self._degraded:
            _log.warning("guard runs degraded", measure=measure)
        _log.info("guard runs", pid=self._child.pid, sensor=self._serial)

    async def stop(self) -> None:
        """End the guard; the robot is stopped by that. Idempotent."""
        self._stopping = True
        if self._child is not None:
            child, self._child = self._child, None
            await child.quit()
        self._fail(GuardDied("the guard was stopped"))

    @property
    def running(self) -> bool:
        """True while the process lives."""
        return self._child is not None and self._child.alive

    @property
    def pid(self) -> int:
        """Process number of the guard; 0 while there is none."""
        return self._child.pid if self._child is not None and self._child.alive else 0

    # --- requests

    async def set_compensation(self, compensation: Compensation) -> None:
        """Subtract this load from now on; drops the tare."""
        load = {
            "load": compensation.A.tolist(),
            "offset": compensation.b.tolist(),
            "base_down": list(compensation.base_down),
        }
        await self._request("compensation", **load)
        self._load = load

    async def set_deck_frame(self, sensor_T_deck: RigidTransform) -> None:
        """Give wrenches in this frame from now on; drops the tare."""
        frame = {
            "rotation": sensor_T_deck.rotation.as_matrix().ravel().tolist(),
            "translation_m": sensor_T_deck.translation.tolist(),
        }
        await self._request("deck_frame", **frame)
        self._deck_frame = frame

    async def tare(self, duration_s: float) -> TareResult:
        """Average over the next ``duration_s`` and subtract that from then on."""
        result = await self._request("tare", duration_s, duration_s=duration_s)
        return TareResult(
            np.array(result["mean"]), np.array(result["sigma"]), int(result["samples"])
        )

    async def arm(self, limits: GuardLimits) -> None:
        """Watch these limits from now on; replaces those watched before."""
        await self._request("arm", limits=limits_to_json(limits))

    async def disarm(self) -> None:
        """Watch nothing. A latched trip stays latched."""
        await self._request("disarm")

    async def acknowledge(self) -> None:
        """Release the latch; disarms.

        Starts a new guard when the old one has died, hangs or has given up its sensor; raises as
        ``start`` does when that fails.
        """
        health = self.health()
        if health.alive and health.sensor_open:
            await self._request("acknowledge")
        else:
            await self.stop()
            await self.start()
            if self._load is not None:
                await self._request("compensation", **self._load)
            if self._deck_frame is not None:
                await self._request("deck_frame", **self._deck_frame)
        self._trip = None

    @property
    def compensated(self) -> bool:
        """True once a compensation was set; without one nothing can be armed."""
        return self._load is not None

    # --- what the guard has seen

    @property
    def trip(self) -> GuardTrip | None:
        """The latched trip, or None."""
        return self._trip

    def newest(self) -> GuardSample | None:
        """The newest sample of any age; None before the first and without a guard."""
        return None if self._child is None else self._child.reader.latest()

    def latest(self) -> GuardSample:
        """The newest sample; ``GuardDied`` or ``SensorSilent`` when there is none."""
        sample = self._require_child().reader.latest()
        if sample is None:
            raise SensorSilent("no sample since the guard's start")
        return sample

    def samples(self, since_s: float) -> Curve:
        """All samples with a later time that the ring still holds."""
        return self._require_child().reader.since(since_s)

    def health(self) -> GuardHealth:
        """How the guard is doing; never raises."""
        child = self._child
        status = child.reader.status() if child is not None and child.alive else None
        return vitals.health(status, self._serial, self._degraded)

    def check(self) -> None:
        """Raise the fault of a guard that is dead or hangs, or has lost sensor or robot."""
        health = self.health()
        fault = vitals.fault(health) if self.running else GuardDied("no guard process")
        given_up = not self.running or (health.alive and not health.sensor_open)
        if given_up and self._fault is not None:
            fault = self._fault.with_traceback(None)  # or it would grow each time it is raised
        if fault is not None:
            raise fault

    # --- inside

    async def _until_started(self, started: asyncio.Future[None]) -> None:
        timeout_s = self._settings.start_timeout_s
        try:
            async with asyncio.timeout(timeout_s):
                await started
        except TimeoutError:
            raise GuardDied(f"not ready within {timeout_s:g} s after its start") from None

    def _set_up(self) -> Message:
        settings = self._settings
        rotation = settings.flange_T_sensor.rotation.as_matrix()
        return {
            "sensor": self._sensor,
            "stop_channel": self._stop,
            "flange_R_sensor": rotation.ravel().tolist(),
            "beat_s": settings.beat_s,
            "stop_confirm_s": settings.stop_confirm_s,
            "fifo_priority": settings.fifo_priority,
            "cpu": settings.cpu,
            "lock_memory": settings.lock_memory,
        }

    async def _request(self, do: str, wait_s: float = 0.0, **fields: Any) -> Any:
        return await self._requests.ask(self._require_child().send, {"do": do, **fields}, wait_s)

    def _require_child(self) -> GuardChild:
        if self._child is None or not self._child.alive:
            raise GuardDied("no guard process")
        return self._child

    def _take(self, message: Message) -> None:
        event = message.get("event")
        if event is None:
            self._requests.take(message)
        elif event == "trip":
            self._latch(trip_from_json(message["trip"]))
        elif event == "ready":
            self._serial, self._degraded = message["serial"], tuple(message["degraded"])
            if message["channel"]:
                self._channel(up=True, fault=None)
        elif event == "channel":
            fault = message["fault"]
            self._channel(up=message["up"], fault=fault and fault_from_json(fault))
        else:
            self._fault = fault_from_json(message)
            _log.error("guard reports a fault", fault=str(self._fault))
            self._settle_start(self._fault)

    def _channel(self, *, up: bool, fault: CellError | None) -> None:
        if up:
            self._settle_start(None)
        elif fault is not None:
            _log.warning("stop channel is down", fault=str(fault))
            self._settle_start(fault)

    def _settle_start(self, fault: CellError | None) -> None:
        if self._started is None or self._started.done():
            return
        if fault is None:
            self._ready = True
            self._started.set_result(None)
        else:
            self._started.set_exception(fault)

    def _latch(self, trip: GuardTrip) -> None:
        if self._trip is None or self._trip.reason is not TripReason.GUARD_DIED:
            self._trip = trip
        _log.warning("guard has stopped the robot", trip=str(trip))

    def _died(self, how: str) -> None:
        self._fail(GuardDied(how))
        if self._ready and not self._stopping:
            self._fault = None
            self._latch(GuardTrip(TripReason.GUARD_DIED, now_s(), how))

    def _fail(self, fault: GuardDied) -> None:
        """Whoever waits for the guard hears that it will not answer."""
        self._settle_start(fault)
        self._requests.fail(fault)
