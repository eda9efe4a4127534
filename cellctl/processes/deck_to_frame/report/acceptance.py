"""What an assembly must fulfil: the seated deck first, then the mating, then the way there."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from cellctl.geometry.coverage import COVERAGE_FACTOR
from cellctl.processes.deck_to_frame.record import keys
from cellctl.processes.deck_to_frame.record.worst_component import expanded
from cellctl.records.entries import RunRecord
from cellctl.records.figures import KNOWN_TO, Limit
from cellctl.records.parts import mate_serial
from cellctl.records.report.acceptance.requirement import (
    Requirement,
    RequirementGroup,
    guarded,
    of_figures,
    unmeasured,
)
from cellctl.records.report.sections import Part
from cellctl.records.required.required_figures import REQUIRED

_MATING = {
    "seat_gap": "gap deck to frame by travel of the arm",
    "hold_force": "seating force along the approach, held",
    "hold_lateral": "lateral force while seated",
    "released_force": "force after release",
    keys.PEAK_FORCE: "greatest force along the approach, single samples",
    keys.FORCE_WHILE_VERIFIED: "greatest force along the approach while the seat was verified",
    "peak_filtered_force": "greatest force along the approach, mean of 5 ms",
    "peak_lateral": "greatest lateral force, single samples, with the guard's margin",
    "peak_moment": "greatest moment, single samples, with the guard's margin",
}
_SEATED = {
    keys.PIN_OFFSETS: "lateral offset at the pin holes",
    keys.GAP_BY_VISION: "gap deck to frame, by vision",
    keys.SEAT_ROTATION: "rotation deck to frame",
}
"""What every verification finds."""
_MATED = ("seat_gap", "hold_force", "released_force", keys.PEAK_FORCE)
"""What every mating finds; the further figures are of the same curves."""
_ERRORS = {
    keys.POSITION_ERROR: "error of the position, worst axis",
    keys.ANGLE_ERROR: "error of the angle, worst axis",
}
_FITTED_PARTS = ("frame", "deck", "deck before mating", "seated deck")
_FITS = {
    f"{keys.WORST_RESIDUAL}.{kind}": f"greatest residual of a hole, {part}"
    for kind, part in zip(keys.FITTED, _FITTED_PARTS, strict=True)
}
_WORDS = {
    "approach.speed": "approach: speed, derived",
    "approach.predicted_peak": "approach: greatest force predicted",
    "approach.touch": "approach: force at which the touch is noticed",
    "approach.latency": "approach: force that builds up until the stop takes effect",
    "approach.ramp": "approach: force that builds up while braking",
    "approach.impact": "approach: force of the impact",
    "approach.tare": "approach: allowance for the zero of the sensor",
    "approach.stop_latency": "approach: time from decision to stop",
    "approach.stale": "approach: greatest age of a force sample",
    "approach.stiffness": "approach: contact stiffness assumed",
    "window.expected": "contact window: expected travel",
    "window.earliest": "contact window: least travel",
    "window.latest": "contact window: greatest travel",
    "window.clear": "contact window: travel without contact",
    "target_force": "seating force demanded",
    "limit_force": "limit of the force along the approach",
    "touch_travel": "travel at the first touch",
    "touch_force": "force at the first touch",
    "creep_steps": "steps from touch to seating force",
    "stiffness": "contact stiffness measured",
    "duration": "duration of the mating",
    f"{keys.POSITION_ERROR}{KNOWN_TO}": "before mating: expanded uncertainty of the position error",
    f"{keys.ANGLE_ERROR}{KNOWN_TO}": "before mating: expanded uncertainty of the angle error",
    **{f"seated_error.{axis}": f"seated deck: error along {axis} of the frame" for axis in "xyz"},
    **{
        f"seated_error.r{axis}": f"seated deck: rotation about {axis} of the frame"
        for axis in "xyz"
    },
    f"{keys.GAP_BY_VISION}_{keys.UNCERTAINTY}": "seated deck: expanded uncertainty of the gap",
    f"{keys.SEAT_ROTATION}_{keys.UNCERTAINTY}": "seated deck: expanded uncertainty of the rotation",
}


def words(record: RunRecord) -> Mapping[str, str]:
    """Standard terms for the figures without a limit, by their keys."""
    prefix = f"{keys.PIN_OFFSETS}_{keys.UNCERTAINTY}."
    holes = [key for key in record.newest_figures if key.startswith(prefix)]
    title = "seated deck: expanded uncertainty of the offset at hole "
    return {**_WORDS, **{key: title + key.removeprefix(prefix) for key in holes}}


def parts(record: RunRecord) -> tuple[Part, ...]:
    """The deck carries the serial number of the run."""
    return (Part("deck", record.head.serial), Part("frame", mate_serial(record)))


def acceptance(record: RunRecord) -> tuple[RequirementGroup, ...]:
    """Every requirement on an assembly; what its run has ended without is not measured."""
    return (
        RequirementGroup(
            "Seated deck",
            (*_seated(record), *unmeasured(record, {**_seat_titles(record), **_SEATED}, _SEATED)),
            "deck against frame after release, by the stereo heads, in the axes of the frame",
        ),
        RequirementGroup(
            "Mating",
            (
                *of_figures(record, _MATING),
                *unmeasured(record, _MATING, _MATED),
            ),
            "in the axes of the deck, gravity removed; without U, because nobody has evaluated an "
            "uncertainty of the force sensor",
        ),
        RequirementGroup(
            "Deck at the stand-off, before mating",
            (
                *_before_mating(record),
                *(replace(one, threshold=True) for one in unmeasured(record, _ERRORS, ())),
            ),
            "last pass, in the axes of the frame; ends the correction and is no "
            "requirement on the part",
        ),
        RequirementGroup(
            "Measurements",
            (*of_figures(record, _FITS), *unmeasured(record, _FITS, ())),
            "distance of a hole from its place on the drawing, after registration",
        ),
    )


def _seat_titles(record: RunRecord) -> Mapping[str, str]:
    """Of the figures of the seat that a run requires; those of earlier versions name none."""
    offsets, turns = f"{keys.PIN_OFFSETS}.", f"{keys.SEATED_ERROR}.r"
    asked = record.document(REQUIRED)
    return {
        **{key: _offset_title(key) for key in asked if key.startswith(offsets)},
        keys.GAP_BY_VISION: _SEATED[keys.GAP_BY_VISION],
        **{key: _turn_title(key[-1]) for key in asked if key.startswith(turns)},
    }


def _offset_title(key: str) -> str:
    return f"lateral offset at hole {key.removeprefix(f'{keys.PIN_OFFSETS}.')}"


def _turn_title(axis: str) -> str:
    return f"rotation deck to frame about {axis}"


def _seated(record: RunRecord) -> Iterator[Requirement]:
    prefix = f"{keys.PIN_OFFSETS}."
    holes = [key.removeprefix(prefix) for key in record.newest_figures if key.startswith(prefix)]
    wanted = [
        (f"{prefix}{hole}", _offset_title(f"{prefix}{hole}"),
         f"{keys.PIN_OFFSETS}_{keys.UNCERTAINTY}.{hole}")
        for hole in holes
    ]  # fmt: skip
    wanted += [
        (keys.GAP_BY_VISION, _SEATED[keys.GAP_BY_VISION],
         f"{keys.GAP_BY_VISION}_{keys.UNCERTAINTY}"),
    ]  # fmt: skip
    for key, title, uncertainty in wanted:
        found = guarded(record, key, title, record.value(uncertainty))
        if found is not None:
            yield found
    yield from _rotations(record)


def _rotations(record: RunRecord) -> Iterator[Requirement]:
    """About each axis, whose limits differ; runs of earlier versions judged the worst one alone."""
    axes = [
        guarded(
            record,
            f"{keys.SEATED_ERROR}.r{axis}",
            _turn_title(axis),
            _times_coverage(record.value(f"{keys.SEATED_SIGMA}.r{axis}")),
        )
        for axis in "xyz"
    ]
    judged = [replace(found, stands_for=keys.SEAT_ROTATION) for found in axes if found is not None]
    title, known = "rotation deck to frame, worst axis", f"{keys.SEAT_ROTATION}_{keys.UNCERTAINTY}"
    worst = guarded(record, keys.SEAT_ROTATION, title, record.value(known))
    yield from judged or ([] if worst is None else [worst])


def _before_mating(record: RunRecord) -> Iterator[Requirement]:
    """Every component of the last pass with its own threshold."""
    for key, part in ((keys.POSITION_ERROR, slice(0, 3)), (keys.ANGLE_ERROR, slice(3, 6))):
        worst = record.newest_figures.get(key)
        for component in record.passes[-1].components[part] if record.passes else ():
            if component.limit is not None:
                limit = Limit(-component.limit, component.limit)
                yield Requirement(
                    title=f"error {component.name}",
                    value=component.value,
                    unit=component.unit,
                    required=limit,
                    verdict=limit.judge(component.value),
                    expanded=expanded(component),
                    threshold=True,
                    phase=None if worst is None else worst.phase,
                    stands_for=key,
                )


def _times_coverage(sigma: float | None) -> float | None:
    return None if sigma is None else COVERAGE_FACTOR * sigma
