"""The daemon, with a clock that the campaign can set back: the PC's own is everybody's.

``python -m benchmarks.faults.daemon run CELL …`` is ``cellctl run CELL …``. The file that the
environment names holds the seconds by which the time of day is off; without it the clock is right.
"""

import os
from datetime import datetime, timedelta
from pathlib import Path

from cellctl import clock

CLOCK_FILE = "CELLCTL_FAULTS_CLOCK"
_true_utc_now = clock.utc_now


def shifted_utc_now() -> datetime:
    """The time of day as the set clock shows it."""
    try:
        off_s = float(Path(os.environ[CLOCK_FILE]).read_text(encoding="ascii"))
    except (FileNotFoundError, KeyError):
        off_s = 0.0
    return _true_utc_now() + timedelta(seconds=off_s)


if __name__ == "__main__":
    # The other modules import the function by its name, so it is replaced before they are imported.
    clock.utc_now = shifted_utc_now
    from cellctl.cli.app import main

    main()
