"""What an insertion must fulfil: the inserted part first, then the way there."""

from collections.abc import Mapping

from cellctl.processes.peg_in_hole.record import keys
from cellctl.processes.peg_in_hole.verdict.judgement import (
    ALIVE,
    DEPTH,
    DROPPED,
    HELD,
    HIGH_FORCE,
    KEYED,
    LOW_FORCE,
    PLAY_X,
    PLAY_Y,
    PULL,
    RESISTED,
    RETOUCH,
    SLIP,
    SLOPE,
    STEADY,
    UNRUBBED,
    WITH_FEED,
)
from cellctl.records.entries import RunRecord
from cellctl.records.report.acceptance.requirement import (
    RequirementGroup,
    of_figures,
    unmeasured,
)
from cellctl.records.report.text import quantity

_PART = {
    keys.check(DEPTH): "distance from the seat of the drawing",
    keys.check(LOW_FORCE): "force at the seat, least",
    keys.check(HIGH_FORCE): "force at the seat, greatest",
    keys.check(SLOPE): "rise of the force at the seat",
    keys.check(RESISTED): "directions of four in which the hole resists",
    keys.check(PLAY_X): "play along x",
    keys.check(PLAY_Y): "play along y",
    keys.check(STEADY): "change of depth when pushed sideways",
    keys.check(ALIVE): "change of the force when pushed sideways, over its noise",
    keys.check(KEYED): "directions of two in which a turn is resisted",
    keys.check(PULL): "pull that was held",
}
_INSERTION = {
    keys.PEAK: "greatest force along the axis, from the entry to the seat",
    keys.check(SLIP): "greatest force since the grip, over the grip force",
    keys.check(RETOUCH): "height of the rear after release, from the drawing",
    keys.check(HELD): "way on which the part was held back before the seat",
    keys.check(WITH_FEED): "greatest force with the feed",
    keys.check(DROPPED): "greatest drop of the force in the feed",
    keys.check(UNRUBBED): "way on which the contacts were not felt",
}
_FACE = {
    keys.PANEL_SHIFT: "shift of the face from its reference",
    keys.PANEL_TURN: "turn of the face from its reference",
}
_ONLY_SOME = {
    keys.check(KEYED): ("fit", "keys"),
    keys.check(PULL): ("seat", "pull_n"),
    keys.check(UNRUBBED): ("fit", "contacts"),
}
"""What is measured of some parts alone, and where their task says it."""
WORDS = {
    keys.FACE_HEIGHT: "face: height over where it was believed to be",
    keys.FACE_TILT: "face: tilt against the attitude of the insertion",
    keys.SEARCH_TIME: "search: time from the first touch to the last",
    keys.TOUCHES: "search: touches",
}
"""Standard terms for the figures without a limit."""


def acceptance(record: RunRecord) -> tuple[RequirementGroup, ...]:
    """Every requirement on an insertion; what its run has ended without is not measured."""
    return (
        _group(
            record,
            "Inserted part",
            _PART,
            "by touch, depths from the face that was touched in this run",
        ),
        _group(record, "Insertion", _with_forces(record), _note(record)),
        _group(record, "Face", _FACE, ""),
    )


def _group(record: RunRecord, title: str, titles: Mapping[str, str], note: str) -> RequirementGroup:
    always = [key for key in titles if _always(record, key)]
    rows = *of_figures(record, titles), *unmeasured(record, titles, always)
    return RequirementGroup(title, rows, note)


def _always(record: RunRecord, key: str) -> bool:
    """Whether an insertion of this part measures it when it comes to its end."""
    # The face is compared where a reference is; a touch on the rear stands for the grip force.
    if key in _FACE or key == keys.check(RETOUCH):
        return False
    if key == keys.check(SLIP) and keys.check(RETOUCH) in record.newest_figures:
        return False
    if key not in _ONLY_SOME:
        return True
    section, name = _ONLY_SOME[key]
    return (record.document(keys.TASK).get(section) or {}).get(name) is not None


def _with_forces(record: RunRecord) -> Mapping[str, str]:
    """Titles of the insertion; a ratio of forces names both."""
    forces = slip_forces(record)
    title = _INSERTION[keys.check(SLIP)]
    return {**_INSERTION, keys.check(SLIP): f"{title}: {forces}" if forces else title}


def slip_forces(record: RunRecord) -> str:
    """Both forces of which the ratio is judged; empty where the run has not judged it."""
    evidence = record.document(keys.CYCLE).get("evidence", {})
    greatest_n, grip_n = evidence.get("greatest_force_n"), evidence.get("grip_force_n")
    if greatest_n is None or grip_n is None:
        return ""
    return f"{quantity(greatest_n, 'N')} of {quantity(grip_n, 'N')}"


def _note(record: RunRecord) -> str:
    bound_n = record.document(keys.TASK).get("felt", {}).get("greatest_n")
    if not bound_n:
        return ""
    return (
        "along the axis. The greatest force since the grip is that of the insertion, at least "
        f"{quantity(bound_n, 'N')}: so much may have acted in the search before the guard stops it"
    )
