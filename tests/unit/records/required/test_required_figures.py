"""What a run requires is told as missing until it was measured, or what counts in its place."""

from cellctl.records import RunResult, RunStore
from cellctl.records.figures import NO_LIMIT, Limit, figure
from cellctl.records.required.required_figures import (
    missing_figures,
    not_measured,
    required,
    required_document,
    states_required,
)
from tests.unit.records.conftest import start

WANTED = (
    required("seat.gap", "mm", Limit(-0.1, 0.1)),
    required("slip", "", Limit(upper=0.6), instead="retouch"),
    required("angle", "°", NO_LIMIT),
)


def test_what_is_required_is_missing_until_it_was_measured(store: RunStore) -> None:
    run = start(store)
    assert not states_required(store.run(run))
    store.add(run, required_document(WANTED))
    record = store.run(run)
    assert states_required(record)
    assert [one.key for one in missing_figures(record)] == ["seat.gap", "slip", "angle"]
    assert not_measured(record) == (), "an open run may measure it yet"
    gap = missing_figures(record)[0]
    assert (gap.label, gap.unit, gap.value) == ("seat: gap", "mm", None)
    assert (gap.lower, gap.upper) == (-0.1, 0.1)
    store.add(run, figure("retouch", 0.01, "mm"), figure("angle", None, "°"))
    assert [one.key for one in missing_figures(store.run(run))] == ["seat.gap"]
    store.close_run(run, RunResult.ABORTED)
    assert [one.key for one in not_measured(store.run(run))] == ["seat.gap"]
