"""The guard process of the benchmark: the real one, except that it goes on after each trip."""

import os

from cellctl.guard.watch.loop import GuardLoop
from cellctl.guard.watch.main import main


class RestlessLoop(GuardLoop):
    """Stops as the real loop does, then releases the latch at once: one stop for each sample."""

    def _stop_at_new_trip(self) -> None:
        super()._stop_at_new_trip()
        self._monitor.trip = None
        self._supervisor.release()


if __name__ == "__main__":
    os._exit(main(RestlessLoop))
