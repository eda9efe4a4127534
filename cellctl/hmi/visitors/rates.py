"""How often somebody may ask for something."""

from collections import OrderedDict, deque

from cellctl.clock import Monotonic, now_s

KEYS = 1000


class RateLimit:
    """Allows at most ``count`` in any ``period_s`` for each key."""

    def __init__(self, count: int, period_s: float, *, clock: Monotonic = now_s) -> None:
        self._count = count
        self._period_s = period_s
        self._now_s = clock
        self._times_s: OrderedDict[str, deque[float]] = OrderedDict()

    def wait_s(self, key: str) -> float:
        """Take one; 0 when it is allowed, else how long to wait, and nothing is taken."""
        time_s = self._now_s()
        times_s = self._times_s.setdefault(key, deque())
        self._times_s.move_to_end(key)
        while len(self._times_s) > KEYS:
            self._times_s.popitem(last=False)
        while times_s and time_s - times_s[0] >= self._period_s:
            times_s.popleft()
        if len(times_s) >= self._count:
            return self._period_s - (time_s - times_s[0])
        times_s.append(time_s)
        return 0.0
