"""The acceptance table in the units of pages."""

from cellctl.records import RunStore
from cellctl.records.figures import Limit, figure
from cellctl.records.report.acceptance.table import acceptance
from cellctl.records.report.sections import ReportTable
from tests.unit.records.conftest import start


def test_a_rise_of_a_force_is_judged_and_shown_per_mm(store: RunStore) -> None:
    run = start(store)
    store.add(run, figure("slope", 106871.0, "N/m", limit=Limit(lower=29719.0)))
    table = acceptance(store.run(run), ()).blocks[0]
    assert isinstance(table, ReportTable)
    (_, row) = [tuple(cell.text for cell in row.cells) for row in table.rows]
    assert row[1:4] == ("106.9 N/mm", "not stated", "≥ 29.72 N/mm")
