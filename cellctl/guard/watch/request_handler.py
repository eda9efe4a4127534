"""Carries out what the daemon asks of the guard."""

from collections.abc import Callable

from cellctl.errors.force import GuardRefused
from cellctl.guard.messages import Message, limits_from_json
from cellctl.guard.watch.monitor import WrenchMonitor
from cellctl.guard.watch.stop_supervisor import StopSupervisor
from cellctl.interfaces.ft_sensor import FtHealth

TARE_GRACE_S = 0.5
"""A tare that has not ended this long after its duration gets no samples and is given up.

Samples are milliseconds late as a rule. It has to be shorter than the ``reply_timeout_s`` of
``GuardSettings``, or the daemon would call the guard dead before it hears that the tare has failed.
"""


class RequestHandler:
    """Answers requests; ``cellctl.guard.client.GuardClient`` says what each one means.

    A tare is answered later, when its samples are in: waiting for them here would keep the guard
    from judging those very samples.
    """

    def __init__(
        self, monitor: WrenchMonitor, supervisor: StopSupervisor, health: Callable[[], FtHealth]
    ) -> None:
        self.quit = False
        """True once the daemon has asked for the end."""
        self._monitor = monitor
        self._supervisor = supervisor
        self._health = health
        self._tare: tuple[int, float] | None = None
        """Number of the request for the running tare, and when to give it up."""
        self._now_s = 0.0
        self._actions: dict[str, Callable[[Message], None]] = {
            "arm": self._arm,
            "disarm": lambda _: self._monitor.disarm(),
            "stop": lambda _: self._stop(),
            "acknowledge": lambda _: self._acknowledge(),
            "gravity_compensation": self._set_gravity_compensation,
            "wrench_frame": self._set_wrench_frame,
            "tare": self._begin_tare,
            "quit": lambda _: self._quit(),
        }

    def answer(self, request: Message, now_s: float) -> Message | None:
        """Carry out a request; its answer, or None when that comes later.

        A request that makes no sense is refused, not raised: a defect of the daemon must not end
        the guard while the robot moves.
        """
        self._now_s = now_s
        try:
            self._actions[request["do"]](request)
        except GuardRefused as refusal:
            return {"id": request["id"], "refused": refusal.detail}
        except (KeyError, TypeError, ValueError) as error:
            return {"id": request["id"], "refused": f"not understood: {error!r}"}
        return None if request["do"] == "tare" else {"id": request["id"], "result": None}

    def late_answer(self, now_s: float) -> Message | None:
        """The answer to a running tare, once there is one."""
        if self._tare is None:
            return None
        request, give_up_s = self._tare
        sums = self._monitor.tare_result
        if sums is not None:
            self._tare = self._monitor.tare_result = None
            result = {"mean": sums.mean, "sigma": sums.sigma, "samples": sums.samples}
            return {"id": request, "result": result}
        if now_s > give_up_s:
            self._tare = None
            self._monitor.cancel_tare()
            return {"id": request, "refused": "no samples came in for the tare"}
        return None

    def _arm(self, request: Message) -> None:
        # The monitor does no I/O, so it is told what it judges by: the channel as it is now.
        self._monitor.channel_up = self._supervisor.up
        self._monitor.arm(limits_from_json(request["limits"]), self._health(), self._now_s)

    def _stop(self) -> None:
        self._supervisor.stop(self._now_s)
        self._monitor.brake(self._now_s)

    def _acknowledge(self) -> None:
        self._monitor.acknowledge()
        self._supervisor.release()

    def _set_gravity_compensation(self, request: Message) -> None:
        self._monitor.require_unarmed()
        load, offset, base_down = request["load"], request["offset"], request["base_down"]
        # Checked before anything changes: a wrong shape that shows halfway would leave a
        # compensation that is half old and half new.
        if [len(row) for row in load] != [3] * 6 or len(offset) != 6 or len(base_down) != 3:
            raise ValueError("a load is 6x3, an offset 6, a direction 3 numbers")
        depends_on_pose = any(value != 0.0 for row in load for value in row)
        # Without a channel no flange pose ever comes, so a hanging load could not be subtracted.
        if depends_on_pose and not self._supervisor.present:
            raise GuardRefused("a load that depends on the pose needs a stop channel")
        self._monitor.contact.set_gravity_compensation(load, offset, base_down)
        self._monitor.signal_jumped()

    def _set_wrench_frame(self, request: Message) -> None:
        self._monitor.require_unarmed()
        rotation, translation_m = request["rotation"], request["translation_m"]
        self._monitor.contact.set_wrench_frame(tuple(rotation), translation_m)
        self._monitor.signal_jumped()

    def _begin_tare(self, request: Message) -> None:
        duration_s = float(request["duration_s"])
        self._monitor.begin_tare(duration_s, self._now_s)
        self._tare = (request["id"], self._now_s + duration_s + TARE_GRACE_S)

    def _quit(self) -> None:
        self.quit = True
