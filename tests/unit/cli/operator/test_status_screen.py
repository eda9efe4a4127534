"""Lines of `cellctl status` that have nothing to show."""

from cellctl.api.local_socket.report import AxisReport, ForceReport
from cellctl.cli.operator.status_screen import _force


def test_a_force_that_is_not_shown_says_why() -> None:
    # After a free move, as in Held: known, and in axes whose signs say nothing of the part.
    hidden = ForceReport(
        sensor="force",
        age_s=0.001,
        compensated=True,
        limit_n=50.0,
        wrench=(AxisReport(axis="Fz", unit="N", value=None),),
    )
    assert str(_force(hidden)).startswith("in the axes of the sensor; shown")
    shown = hidden.model_copy(update={"wrench": (AxisReport(axis="Fz", unit="N", value=-12.34),)})
    assert str(_force(shown)) == "Fz -12.3 N; limit 50 N"
    old = hidden.model_copy(update={"age_s": 24.9, "stale": True})
    assert str(_force(old)) == "not known: the newest sample is 25 s old"
