"""A stop channel in memory, with the few things of a robot that it needs."""

import socket

from cellctl.clock import now_s
from cellctl.errors.link import LinkLost
from cellctl.geometry.pose import pose_from_xyzabc
from cellctl.interfaces.stop_channel import FlangeState, StopChannel

DEADMAN_S = 0.3
REPORT_S = 0.02
FLANGE = pose_from_xyzabc((1500.0, 0.0, 1000.0, 20.0, -10.0, 170.0))


class InProcessStopChannel(StopChannel):
    """The robot moves until it is stopped, or hears no heartbeat, or loses the link."""

    def __init__(self) -> None:
        self.latched = self.lost = False
        self._running = False
        self._sockets: tuple[socket.socket, socket.socket] | None = None
        self._beat_s = self._report_s = 0.0

    def start_motion(self) -> None:
        self._running = True

    def moving(self) -> bool:
        if now_s() - self._beat_s > DEADMAN_S or self.lost:
            self._stop()
        return self._running

    def open(self) -> None:
        self.close()
        self.lost = False
        self._sockets = socket.socketpair()
        self._sockets[1].send(b"x")
        self._beat_s = now_s()

    def close(self) -> None:
        if self._sockets is not None:
            for end in self._sockets:
                end.close()
            self._sockets = None

    def fileno(self) -> int:
        return -1 if self._sockets is None else self._sockets[0].fileno()

    def request_stop(self) -> None:
        self._check()
        self._stop()
        self.latched = True

    def heartbeat(self) -> None:
        self._check()
        self._beat_s = now_s()

    def poll(self) -> FlangeState | None:
        self._check()
        if now_s() - self._report_s < REPORT_S:
            return None
        self._report_s = now_s()
        x_m, y_m, z_m = FLANGE.translation.tolist()
        rotation = tuple(FLANGE.rotation.as_matrix().ravel().tolist())
        return FlangeState(now_s(), (x_m, y_m, z_m), rotation, self.moving(), self.latched)

    def _stop(self) -> None:
        self.latched = self.latched or self._running
        self._running = False

    def _check(self) -> None:
        if self.lost:
            self._stop()
            self.close()
        if self._sockets is None:
            raise LinkLost("closed")
