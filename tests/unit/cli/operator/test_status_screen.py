"""Lines of `cellctl status` that have nothing to show."""

from cellctl.api.local_socket.report import AxisReport, ForceReport, RunReport, StatusReport
from cellctl.cli.operator.status_screen import _force, _measured
from cellctl.clock import utc_now
from tests.unit.cli.agreeable import AT_REST


def test_a_force_that_is_not_shown_says_why() -> None:
    # After a free move, as in Held: known, and in axes whose signs say nothing of the part.
    hidden = ForceReport(
        sensor="force",
        age_s=0.001,
        compensated=True,
        limit_n=50.0,
        wrench=(AxisReport(axis="Fz", unit="N", value=None),),
    )
    assert str(_force(hidden, limited=True)).startswith("in the axes of the sensor; shown")
    shown = hidden.model_copy(update={"wrench": (AxisReport(axis="Fz", unit="N", value=-12.34),)})
    assert str(_force(shown, limited=True)) == "Fz -12.3 N; limit 50 N"
    assert str(_force(shown, limited=False)) == "Fz -12.3 N"
    old = hidden.model_copy(update={"age_s": 24.9, "stale": True})
    assert str(_force(old, limited=True)) == "not known: the newest sample is 25 s old"


def test_figures_of_a_run_that_has_ended_name_it() -> None:
    off = AxisReport(axis="x", unit="mm", value=8.0)
    ended = RunReport(
        number=3, serial="PIN-2", recipe="pin", mode="production", started=utc_now(), result="bad"
    )
    shows = {**AT_REST, "errors": (off,), "last_run": ended}
    rows = dict(_measured(StatusReport(**{**shows, "state": "ABORTED"})))
    assert str(rows["errors"]) == "of run 3, which has ended, part against target: x 8.0000 mm"
    rows = dict(_measured(StatusReport(**{**shows, "state": "EXECUTE"})))
    assert str(rows["errors"]) == "x 8.0000 mm"
