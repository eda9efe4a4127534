"""The operator during a teaching: plugs what waits above the socket, brings the next module."""

from dataclasses import dataclass
from typing import Literal

Errand = Literal["plug", "load"]


@dataclass(slots=True)
class StandingBy:
    """What is to be done, from what the operator sees; asked at times that never run backwards."""

    patience_s: float
    on: bool = False
    _waiting_since_s: float | None = None

    def errand(self, time_s: float, *, waits_above: bool, left_in_socket: bool) -> Errand | None:
        """``waits_above``: the held plug rests above its socket. ``left_in_socket``: the module is
        plugged, and the arm has gone."""
        if not (self.on and waits_above):
            self._waiting_since_s = None
        elif self._waiting_since_s is None:
            self._waiting_since_s = time_s
        elif time_s - self._waiting_since_s >= self.patience_s:
            self._waiting_since_s = None
            return "plug"
        return "load" if self.on and left_in_socket else None
