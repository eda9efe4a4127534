"""What an insertion has found beside its requirements: evidence of the verdict, first contacts."""

from collections.abc import Mapping, Sequence
from typing import Any

from cellctl.records.report.sections import ReportTable, TableCell, TableRow
from cellctl.records.report.text import facts, fixed

_JUDGED = frozenset(
    {"seat_force_n", "seat_slope_n_m", "held_way_m", "unrubbed_way_m", "with_feed_n", "dropped_n",
     "keyed_directions", "held_pull_n"}
)  # fmt: skip
"""Evidence that the acceptance table has as it is."""


def evidence_facts(result: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    """What the verdict rests on and the acceptance table does not have."""
    evidence = result.get("evidence", {})
    rest = {
        key: value
        for key, value in evidence.items()
        if key not in _JUDGED | {"capture"} and value is not None
    }
    return tuple(facts({"evidence": rest}))


def contact_table(contacts: Sequence[Mapping[str, Any]]) -> ReportTable:
    """The first contacts by their classes; times count from the first one."""
    begun_s = contacts[0]["time_s"]
    rows = tuple(
        TableRow(
            (
                TableCell(str(one["class"])),
                TableCell(fixed(one["time_s"] - begun_s, 1)),
                *(TableCell(_place(one[name])) for name in ("x_mm", "y_mm", "depth_mm")),
            )
        )
        for one in contacts
    )
    columns = ("first contact", "after s", "x mm", "y mm", "depth mm")
    return ReportTable(columns, rows)


def _place(value_mm: float) -> str:
    # A place of less than a digit is written as none, and not as a negative one.
    return fixed(round(value_mm, 3) + 0.0, 3)
