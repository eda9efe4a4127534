"""The procedures of Maintenance, each with its guide and with where it stands."""

from collections.abc import Mapping
from typing import Any, Literal

from cellctl.hmi.answers.form import Form

AT_REST = frozenset({"IDLE", "STOPPED", "ABORTED", "COMPLETED"})
Stage = Literal["at rest", "under way", "ended"]


class Renewed(Form):
    """A calibration that a procedure renews."""

    kind: str
    made: str | None
    """Null where there is none, or it cannot be read."""
    valid_until: str | None
    problem: str
    """Why the cell would not use it; empty where nothing is wrong, or where it was never made."""


class ProcedureTold(Form):
    """One procedure of this cell."""

    number: int
    """For `{"request": "procedure", "number": …}` of `POST /commands`."""
    name: str
    set_up: tuple[str, ...]
    """What has to be so before it is started; a person sees to each."""
    moves: tuple[str, ...]
    """What will move."""
    then: tuple[str, ...]
    """What is to be done afterwards."""
    renews: tuple[Renewed, ...]
    stage: Stage
    """`ended` until the cell is reset; nobody has to look on for it to go on."""
    progress: str
    """What it is doing; empty unless it is under way."""
    run: int | None
    """Number of its run while it is under way, and when it has ended."""
    result: str
    """How it ended; empty unless it has."""


class ProcedureList(Form):
    """All procedures, in the order of the cell."""

    procedures: tuple[ProcedureTold, ...]


def procedure_told(
    one: Mapping[str, Any], description: Mapping[str, Any], snapshot: Mapping[str, Any]
) -> ProcedureTold:
    """One of the description's procedures; all in one language."""
    stage = _stage(one["number"], snapshot)
    run, begun = snapshot.get("run", {}), stage != "at rest"
    return ProcedureTold(
        number=one["number"],
        name=one["name"],
        set_up=tuple(one.get("set_up", ())),
        moves=tuple(one.get("moves", ())),
        then=tuple(one.get("then", ())),
        renews=tuple(_renewed(kind, description) for kind in one.get("renews", ())),
        stage=stage,
        progress=snapshot.get("step", {}).get("text", "") if stage == "under way" else "",
        run=(run.get("number") or None) if begun else None,
        result=run.get("result", "") if stage == "ended" else "",
    )


def _stage(number: int, snapshot: Mapping[str, Any]) -> Stage:
    recipe, state = snapshot.get("run", {}).get("recipe"), snapshot.get("state")
    if snapshot.get("mode") != "MAINTENANCE" or recipe != number or state in (None, "IDLE"):
        return "at rest"
    return "ended" if state in AT_REST else "under way"


def _renewed(kind: str, description: Mapping[str, Any]) -> Renewed:
    found = (one for one in description.get("calibrations", ()) if one["kind"] == kind)
    one: Mapping[str, Any] = next(found, {})
    return Renewed(
        kind=kind,
        made=one.get("made"),
        valid_until=one.get("valid_until"),
        problem=one.get("problem", ""),
    )
