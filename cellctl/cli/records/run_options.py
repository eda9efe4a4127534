"""Options of the commands that look into records; the same for one store and for a fleet."""

from datetime import datetime, timedelta
from typing import Annotated

import typer

from cellctl.errors.base import fault_number
from cellctl.records.entries import RunResult
from cellctl.records.run_filter import RunFilter
from cellctl.records.seals import LedgerHead
from cellctl.spelling import nearest

_DAY = ["%Y-%m-%d"]
_HASH_DIGITS = 64
_RESULTS = (*RunResult, "open")


def _known(result: str) -> str:
    """A result that no run can have finds none, which looks like an answer."""
    if result and result not in _RESULTS:
        raise typer.BadParameter(f"{nearest(result, _RESULTS)}one of {', '.join(_RESULTS)}")
    return result


AsJson = Annotated[bool, typer.Option("--json", help="For programs.")]
Serial = Annotated[str, typer.Option(help="Only this serial number.")]
RecipeName = Annotated[str, typer.Option(help="Only of the recipe with this name.")]
Operator = Annotated[str, typer.Option(help="Only this operator's.")]
Result = Annotated[str, typer.Option(help=f"{', '.join(_RESULTS)}.", callback=_known)]
FaultNumber = Annotated[
    int | None,
    typer.Option(
        parser=fault_number,
        help="Only where it came up, such as F529 or 529.",
        metavar="NUMBER",
    ),
]
CalibrationId = Annotated[str, typer.Option(help="Only what used it; its identity.")]
Since = Annotated[datetime | None, typer.Option(help="First day.", formats=_DAY)]
Until = Annotated[datetime | None, typer.Option(help="Last day.", formats=_DAY)]


def wanted_runs(
    *,
    serial: str,
    recipe: str,
    operator: str,
    result: str,
    fault: int | None,
    calibration: str,
    since: datetime | None,
    until: datetime | None,
) -> RunFilter:
    """What the options ask for."""
    return RunFilter(
        serial=serial,
        recipe=recipe,
        operator=operator,
        result=result,
        fault=fault,
        calibration=calibration,
        # A day without a zone is one of this computer's, and the last one counts to its end.
        since=since and since.astimezone(),
        until=until and (until + timedelta(days=1)).astimezone(),
    )


def printed_head(head: str) -> LedgerHead | None:
    """The head of the ledger from the text on a report; raises ``typer.BadParameter``."""
    if not head:
        return None
    length, _, found = head.partition(":")
    if not length.isdecimal() or len(found) != _HASH_DIGITS:
        raise typer.BadParameter("it reads LENGTH:HASH", param_hint="--head")
    return LedgerHead(int(length), found)
