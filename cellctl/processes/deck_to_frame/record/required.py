"""What every deck has to be measured for, with the limits of its recipe."""

from collections.abc import Iterator

from cellctl.geometry.pose import MM
from cellctl.processes.deck_to_frame.mating.planned_settings import mating_settings
from cellctl.processes.deck_to_frame.poses.seat_error import judged_holes
from cellctl.processes.deck_to_frame.record import keys
from cellctl.processes.deck_to_frame.record.mating_record import RESULT_UNITS, result_limits
from cellctl.processes.deck_to_frame.run_facts import RunFacts
from cellctl.records.figures import NO_LIMIT, Limit
from cellctl.records.required.required_figures import RequiredFigure, required
from cellctl.vision.registration.part_pose import RESIDUAL_LIMIT_M


def required_figures(facts: RunFacts) -> tuple[RequiredFigure, ...]:
    """Figures that a run must measure: of the seated deck, then of the mating, then of the way
    there."""
    return (*_seated(facts), *_mating(facts), *_before_mating(facts), *_fits())


def _seated(facts: RunFacts) -> Iterator[RequiredFigure]:
    recipe = facts.recipe
    for hole in judged_holes(facts.deck_features.holes):
        key = f"{keys.PIN_OFFSETS}.{hole.name}"
        yield required(key, "mm", Limit(upper=recipe.seated_limit_mm))
    gap_mm = recipe.seated_gap_limit_mm
    yield required(keys.GAP_BY_VISION, "mm", Limit(-gap_mm, gap_mm))
    for axis, most_deg in zip("xyz", recipe.seated_limits_deg, strict=True):
        yield required(f"{keys.SEATED_ERROR}.r{axis}", "°", Limit(-most_deg, most_deg))


def _mating(facts: RunFacts) -> Iterator[RequiredFigure]:
    payload_kg = facts.payload.mass_kg
    settings = mating_settings(
        facts.cell.force_config, facts.recipe, facts.commissioned, payload_kg
    )
    for key, limit in result_limits(settings).items():
        yield required(key, RESULT_UNITS[key], limit)
    most_n = facts.recipe.mating.limit_force_n
    yield required(keys.FORCE_WHILE_VERIFIED, "N", Limit(upper=most_n))


def _before_mating(facts: RunFacts) -> Iterator[RequiredFigure]:
    """The worst component of each; that of the angle has the threshold of its own axis."""
    settings = facts.recipe.pose_correction
    yield required(keys.POSITION_ERROR, "mm", Limit(upper=settings.threshold_mm))
    angles_deg = set(settings.thresholds_deg)
    alike = Limit(upper=angles_deg.pop()) if len(angles_deg) == 1 else NO_LIMIT
    yield required(keys.ANGLE_ERROR, "°", alike)


def _fits() -> Iterator[RequiredFigure]:
    for part in keys.FITTED:
        key = f"{keys.WORST_RESIDUAL}.{part}"
        yield required(key, "µm", Limit(upper=RESIDUAL_LIMIT_M / MM * 1e3))
