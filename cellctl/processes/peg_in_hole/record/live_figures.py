"""What a streamed contact feels while it lasts, for line, page and terminal."""

import numpy as np

from cellctl.cell.contact_motion.ticks import ContactTick, TickObserver
from cellctl.geometry.pose import MM
from cellctl.runtime.progress import ProgressBoard

_EVERY_S = 0.2
"""Nobody reads faster, and a tick has better things to do."""


class LiveFigures(TickObserver):
    """Tip against the seat, and the greatest forces and moments since the stream began.

    Position in frame A, so along z it is the depth less that of the seat; in the plane the target
    is where the hole is believed to be.
    """

    def __init__(self, board: ProgressBoard, seat_depth_m: float) -> None:
        self._board, self._seat_m = board, np.array([0.0, 0.0, seat_depth_m])
        self._greatest = np.zeros(6)
        self._shown_s = -np.inf

    def take(self, tick: ContactTick) -> None:
        """See ``TickObserver``."""
        sample = tick.sample
        felt = np.concatenate([sample.force_n, sample.moment_n_m])
        self._greatest = np.maximum(self._greatest, np.abs(felt))
        if sample.time_s - self._shown_s < _EVERY_S:
            return
        self._shown_s = sample.time_s
        away_mm = (sample.task_position_tip_m - self._seat_m) / MM
        turned_deg = np.degrees(sample.task_rotation_tip_rad)
        self._board.update(
            error_mm_deg=(*away_mm.tolist(), *turned_deg.tolist()),
            force_peaks=tuple(self._greatest.tolist()),
        )
