"""What was planned, in words and figures."""

from collections.abc import Iterator

import numpy as np

from cellctl.geometry.pose import Array
from cellctl.geometry.units import in_mm_deg
from cellctl.planning.views.gains import Gain
from cellctl.planning.views.plan_viewpoints import PlannedPair, PlannedViews
from cellctl.planning.views.prediction import PredictedPose

COMPONENTS = ("x", "y", "z", "about x", "about y", "about z")


def views_lines(views: PlannedViews) -> Iterator[str]:
    """Poses, certainty, what limits it, the runners-up, and what was refused."""
    statement = views.placement.measurement
    yield f"{statement.label}:"
    yield f"  now:     {_certainty(views.taught.predicted)}"
    yield f"  planned: {_certainty(views.best.predicted)}"
    for head, viewpoint in zip(statement.heads, views.best.viewpoints, strict=True):
        joints_deg = np.round(np.degrees(viewpoint.joints_rad), 2).tolist()
        yield f"  {head.name}: {head.robot} at {joints_deg} deg, {_look(viewpoint.look.distance_m)}"
    yield f"  {_pictures(views)}"
    yield f"  {_limit(views.best.predicted)}"
    added = in_mm_deg(np.sqrt(np.diag(views.best.predicted.calibration)))
    yield f"  calibration of the heads adds, always the same: {_figures(added)}"
    for pair in views.runners_up:
        yield f"  runner-up: {_certainty(pair.predicted)}; {_joints(pair)}"
    for head, refused in zip(statement.heads, views.refused, strict=True):
        reasons = "; ".join(f"{why}: {count}" for why, count in refused.most_common())
        yield f"  {head.name}, places refused: {reasons or 'none'}"


def gain_line(gain: Gain) -> str:
    """One change and what it brings."""
    return f"  {gain.change}: {_certainty(gain.predicted)}"


def _certainty(predicted: PredictedPose) -> str:
    worst = int(np.argmax(predicted.shares))
    return (
        f"sigma {_figures(in_mm_deg(predicted.sigma))}; worst {COMPONENTS[worst]}, "
        f"{predicted.worst:.2f} of its threshold"
    )


def _figures(values_mm_deg: Array) -> str:
    lengths = ", ".join(f"{value * 1e3:.1f}" for value in values_mm_deg[:3])
    angles = ", ".join(f"{value:.4f}" for value in values_mm_deg[3:])
    return f"{lengths} um and {angles} deg"


def _look(distance_m: float) -> str:
    return f"{distance_m * 1e3:.0f} mm from its holes"


def _joints(pair: PlannedPair) -> str:
    texts = [
        str(np.round(np.degrees(viewpoint.joints_rad), 1).tolist()) for viewpoint in pair.viewpoints
    ]
    return f"{' and '.join(texts)} deg"


def _pictures(views: PlannedViews) -> str:
    statement = views.placement.measurement
    enough = views.best.predicted.worst <= statement.share
    text = f"{statement.frames} pictures of each head, {views.best.time_s:.1f} s to get there"
    return f"{text}; {'certain enough' if enough else 'NOT certain enough'}"


def _limit(predicted: PredictedPose) -> str:
    worst = int(np.argmax(predicted.shares))
    whole = float(np.diag(predicted.covariance)[worst])
    parts = sorted(predicted.by_source.items(), key=lambda item: -item[1][worst])
    shares = ", ".join(f"{name} {variance[worst] / whole:.0%}" for name, variance in parts)
    return f"what limits {COMPONENTS[worst]}, of its variance: {shares}"
