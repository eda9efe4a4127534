"""Writes planned viewpoints into a cell file, whose comments and order stay."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import tomlkit

from cellctl.planning.views.plan_viewpoints import PlannedViews


def with_viewpoints_written(text: str, planned: Sequence[PlannedViews]) -> str:
    """The text of a cell file with these joints in place of the taught ones."""
    document = tomlkit.parse(text)
    robots: Any = document["robots"]
    for views in planned:
        heads = views.placement.measurement.heads
        for head, viewpoint in zip(heads, views.best.viewpoints, strict=True):
            joints_deg = np.round(np.degrees(viewpoint.joints_rad), 4).tolist()
            written = tomlkit.item(joints_deg)
            written.comment(f"planned: worst {views.best.predicted.worst:.2f} of a threshold")
            robots[head.robot]["poses_deg"][head.pose] = written
    return tomlkit.dumps(document)
