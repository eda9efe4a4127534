"""Views that do not fit the others are left out, by their residuals."""

import numpy as np
from numpy.typing import NDArray

from cellctl.geometry.pose import Array

_BAD_VIEW = 2.5
"""A view is bad when its rms is so many times the median view's."""
MAX_REJECTED_RATIO = 0.2


def good_views(view_rms: Array) -> NDArray[np.bool_]:
    """Which views are good, from the rms residual of each, shape (views,)."""
    good = view_rms <= _BAD_VIEW * np.median(view_rms)
    allowed = int(MAX_REJECTED_RATIO * len(view_rms))
    # The worst may go, up to the share that is allowed; all others stay, however bad.
    for index in np.argsort(-view_rms)[allowed:]:
        good[index] = True
    return np.asarray(good, dtype=np.bool_)
