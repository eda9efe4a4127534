"""The daemon's side of a guard: start it, ask it, read what it has seen, notice its death."""

from functools import partial
from typing import Any

import numpy as np
from scipy.spatial.transform import RigidTransform

from cellctl import log
from cellctl.clock import now_s
from cellctl.errors.base import CellError
from cellctl.errors.force import GuardDied, SensorSilent
from cellctl.force.gravity.gravity_compensation import GravityCompensation
from cellctl.guard.ahead import ChildAhead
from cellctl.guard.awaited_start import AwaitedStart
from cellctl.guard.child import GuardChild
from cellctl.guard.health import GuardHealth
from cellctl.guard.limits import GuardLimits, GuardSettings
from cellctl.guard.messages import (
    OPEN,
    Message,
    fault_from_json,
    gravity_compensation_to_json,
    limits_to_json,
    set_up_to_json,
    trip_from_json,
    wrench_frame_to_json,
)
from cellctl.guard.report import GuardSample, GuardSamples, GuardTrip, TareResult, TripReason
from cellctl.guard.settling import USUAL, Settling

_log = log.get(__name__)


class GuardClient:
    """One force sensor, and the channel over which it stops one robot.

    A cell has one client for each sensor that must be able to stop a robot. Used from the event
    loop only. The guard itself is a process, so that nothing in the daemon can delay a stop.

    Requests raise ``GuardRefused`` with the guard's reason, or ``GuardDied``. When the guard dies,
    ``trip`` becomes ``GUARD_DIED`` and stays until ``acknowledge``, which starts a new guard.

    ``stop_plugin`` None makes a guard that only measures, for instance for a test. ``module`` is
    what the process runs; a benchmark brings its own. ``settling`` says when this load is still.
    """

    def __init__(
        self,
        sensor_plugin: str,
        sensor_config: dict[str, Any],
        stop_plugin: str | None,
        stop_config: dict[str, Any] | None,
        settings: GuardSettings,
        *,
        module: str = "cellctl.guard.watch.main",
        settling: Settling = USUAL,
    ) -> None:
        self.settling = settling
        self._settings = settings
        stop = {"name": stop_plugin, "config": stop_config or {}}
        set_up = set_up_to_json(
            {"name": sensor_plugin, "config": sensor_config},
            None if stop_plugin is None else stop,
            settings,
        )
        begin = partial(GuardChild, set_up, settings, self._take_event, self._died, module=module)
        self._ahead = ChildAhead(begin)
        self._child: GuardChild | None = None
        self._start = AwaitedStart()
        self._stopping = False
        """Whether the end was asked for. A death counts as a trip only if it comes after a start
        and was not asked for."""
        self._trip: GuardTrip | None = None
        self._fault: CellError | None = None
        """Why the guard could not start, or gave up its sensor."""
        self._serial = ""  # serial number and firmware, as the sensor's driver says them
        self._degraded: tuple[str, ...] = ()
        self._gravity_compensation: Message | None = None
        self.hidden_axial_n: float | None = None  # axial force in the zero; None: no zero taken
        self._wrench_frame: Message | None = None
        """The wrench frame that was set last; None for the sensor's own."""

    # --- start and end

    def load(self) -> None:
        """Have the process of the next ``start`` load meanwhile; it opens nothing before that."""
        self._ahead.begin()

    async def start(self) -> None:
        """Start the guard and wait until its sensor and its stop channel are open. Idempotent.

        Raises what the drivers raise in the guard, or ``GuardDied``.
        """
        if self.running:
            return
        if self._child is not None:
            await self.stop()
        self._stopping = False
        self._fault = self.hidden_axial_n = None
        settled = self._start.begin()
        self._child = self._ahead.take()
        try:
            self._child.send(OPEN)
            await self._start.until(settled, self._settings.start_timeout_s)
            await self._restore()
        # Also when the caller is cancelled: a guard that nobody knows of would keep sensor and stop
        # channel for itself.
        except BaseException as error:
            await self.stop()
            self._fault = error if isinstance(error, CellError) else None
            raise
        for measure in self._degraded:
            _log.warning("guard runs degraded", measure=measure, sensor=self._serial)
        _log.info("guard runs", pid=self._child.pid, sensor=self._serial)

    async def stop(self) -> None:
        """End the guard, which stops the robot. Idempotent."""
        self._stopping = True
        await self._ahead.dismiss()
        if self._child is not None:
            child, self._child = self._child, None
            await child.quit()
        self._start.settle(GuardDied("the guard was stopped"))

    async def _restore(self) -> None:
        """Give a new process the gravity compensation and the wrench frame of the one before.

        Not its tare: only the caller knows when nothing touches the part.
        """
        load, frame = self._gravity_compensation, self._wrench_frame
        if load is not None:
            await self._request("gravity_compensation", **load)
        if frame is not None:
            await self._request("wrench_frame", **frame)

    @property
    def running(self) -> bool:
        """True while the process lives."""
        return self._child is not None and self._child.alive

    @property
    def pid(self) -> int:
        """Process number of the guard; 0 while there is none."""
        return self._child.pid if self._child is not None and self._child.alive else 0

    # --- requests

    async def set_gravity_compensation(self, compensation: GravityCompensation) -> None:
        """Subtract what hangs on the sensor from now on; drops the tare."""
        load = gravity_compensation_to_json(compensation)
        await self._request("gravity_compensation", **load)
        self._gravity_compensation, self.hidden_axial_n = load, None

    @property
    def gravity_compensated(self) -> bool:
        """True while the weight of a load is subtracted; not after a compensation of nothing."""
        load = (self._gravity_compensation or {"load": ()})["load"]
        return any(any(row) for row in load)

    async def set_wrench_frame(self, sensor_T_wrench: RigidTransform | None) -> None:
        """Give wrenches in this frame of the part from now on; drops the tare.

        Forces and moments, and with them limits and touch, are then about its origin and in its
        axes. None, and until the first call, is the sensor frame itself.
        """
        own = RigidTransform.identity()
        frame = wrench_frame_to_json(own if sensor_T_wrench is None else sensor_T_wrench)
        await self._request("wrench_frame", **frame)
        self._wrench_frame, self.hidden_axial_n = None if sensor_T_wrench is None else frame, None

    @property
    def in_part_frame(self) -> bool:
        """False in the sensor's own axes: the signs of a wrench say nothing of a part then."""
        return self._wrench_frame is not None

    async def tare(self, duration_s: float, *, hides_axial_n: float = 0.0) -> TareResult:
        """Subtract the mean of the next ``duration_s`` from then on; it may hide a contact."""
        result = await self._request("tare", duration_s, duration_s=duration_s)
        self.hidden_axial_n = hides_axial_n
        mean, sigma = np.array(result["mean"]), np.array(result["sigma"])
        return TareResult(mean, sigma, int(result["samples"]))

    async def arm(self, limits: GuardLimits) -> None:
        """Watch these limits from now on; they replace those watched before."""
        await self._request("arm", limits=limits_to_json(limits))

    async def disarm(self) -> None:
        """Watch nothing. A latched trip stays latched."""
        await self._request("disarm")

    async def stop_robot(self) -> None:
        """Have the guard stop its robot on its own channel until ``acknowledge``; limits stay."""
        await self._request("stop")

    async def acknowledge(self) -> None:
        """Release the latch and a stop that was asked for; disarms.

        A guard that has died, hangs or has given up its sensor is replaced; raises as ``start``.
        """
        health = self.health()
        if health.alive and health.sensor_open:
            await self._request("acknowledge")
        else:
            await self.stop()
            await self.start()
        self._trip = None

    # --- what the guard has seen

    @property
    def trip(self) -> GuardTrip | None:
        """The latched trip, or None."""
        return self._trip

    def newest(self) -> GuardSample | None:
        """The newest sample of any age; None before the first and without a guard."""
        return None if self._child is None else self._child.reader.latest()

    def latest(self) -> GuardSample:
        """The newest sample; raises ``GuardDied`` or ``SensorSilent`` when there is none."""
        sample = self._require_child().reader.latest()
        if sample is None:
            raise SensorSilent("no sample since the guard's start")
        return sample

    def samples(self, since_s: float) -> GuardSamples:
        """All samples later than ``since_s`` that the ring still holds; may raise ``GuardDied``."""
        return self._require_child().reader.since(since_s)

    def health(self) -> GuardHealth:
        """How the guard is doing; never raises."""
        child = self._child
        status = child.reader.status() if child is not None and child.alive else None
        return GuardHealth.from_status(status, now_s(), self._serial, self._degraded)

    def check(self) -> None:
        """Raise the fault of a guard that is dead or hangs, or has lost sensor or robot."""
        health = self.health()
        fault = health.fault() if self.running else GuardDied("no guard process")
        # Why it did not start, or gave up its sensor, says more than that it is not there.
        given_up = not self.running or (health.alive and not health.sensor_open)
        if given_up and self._fault is not None:
            fault = self._fault.with_traceback(None)  # or it would grow each time it is raised
        if fault is not None:
            raise fault

    # --- inside

    async def _request(self, do: str, wait_s: float = 0.0, **fields: Any) -> Any:
        return await self._require_child().ask({"do": do, **fields}, wait_s)

    def _require_child(self) -> GuardChild:
        if self._child is None or not self._child.alive:
            raise GuardDied("no guard process")
        return self._child

    def _take_event(self, message: Message) -> None:
        event = message["event"]
        if event == "trip":
            self._latch(trip_from_json(message["trip"]))
        elif event == "ready":
            self._serial, self._degraded = message["serial"], tuple(message["degraded"])
            # With a channel ``start`` goes on waiting, for the event that tells of the channel.
            if not message["has_channel"]:
                self._start.settle(None)
        elif event == "channel":
            self._take_channel(up=message["up"], fault=message["fault"])
        else:  # failed: no start; sensor_fault: the sensor was given up
            self._fault = fault_from_json(message)
            _log.error("guard reports a fault", fault=str(self._fault), sensor=self._serial)
            self._start.settle(self._fault)

    def _take_channel(self, *, up: bool, fault: Message | None) -> None:
        if up:
            self._start.settle(None)
        elif fault is not None:
            reason = fault_from_json(fault)
            _log.warning("stop channel is down", fault=str(reason), sensor=self._serial)
            self._start.settle(reason)

    def _latch(self, trip: GuardTrip) -> None:
        # The death stays until it is acknowledged: it is the reason why there is no guard.
        if self._trip is None or self._trip.reason is not TripReason.GUARD_DIED:
            self._trip = trip
        _log.warning("guard has stopped the robot", trip=str(trip), sensor=self._serial)

    def _died(self, how: str) -> None:
        self._start.settle(GuardDied(how))
        # A death during the start is the failure of that start, and one that was asked for is none.
        if self._start.succeeded and not self._stopping:
            # A fault that the guard has told before, such as a lost sensor, is not why it died.
            self._fault = None
            self._latch(GuardTrip(TripReason.GUARD_DIED, now_s(), how))
