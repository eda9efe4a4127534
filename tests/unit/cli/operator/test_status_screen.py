"""Lines of `cellctl status` that have nothing to show."""

from typing import Any

import pytest

from cellctl.api.local_socket.report import (
    AxisReport,
    FaultReport,
    ForceReport,
    RunReport,
    StatusReport,
)
from cellctl.cli.operator.status_screen import _force, _measured, _next, _rows
from cellctl.clock import utc_now
from tests.unit.cli.agreeable import AT_REST

STARTING = "F510 Force guard is not running: no guard process"
DIED = FaultReport(number=510, text="F510 Force guard is not running", cause="", remedy="")


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


@pytest.mark.parametrize(
    ("shows", "said"),
    [
        ({}, "good"),
        ({"links": {"robots.main": "", "force_sensors.force": STARTING}}, STARTING),
        ({"faults": (DIED,)}, DIED.text),
        ({"links": {"force_sensors.force": DIED.text}, "faults": (DIED,)}, DIED.text),
        (
            {"guard_trip": "raw limit", "links": {"force_sensors.force": "F502"}},
            "stop requested: raw limit; F502",
        ),
        (
            {"guard_touch": "touch: after 12 ms"},
            "good; stopped at the touch that the step looks for: touch: after 12 ms",
        ),
    ],
)
def test_a_guard_is_good_only_while_nothing_is_wrong_with_it(
    shows: dict[str, Any], said: str
) -> None:
    rows = dict(_rows(StatusReport(**AT_REST | shows)))
    assert str(rows["guard"]) == said


@pytest.mark.parametrize(
    ("mode", "result", "said"),
    [
        ("production", "good", "fasten a joined part"),
        # A dry run is recorded as bad, and so is a run that Complete has ended before its end.
        ("dry_run", "bad", "What hangs free: leave its gripper closed"),
        ("production", "bad", "What hangs free: leave its gripper closed"),
    ],
)
def test_a_gripper_is_opened_only_after_a_part_was_joined(
    mode: str, result: str, said: str
) -> None:
    ended = RunReport(
        number=3, serial="D-2", recipe="deck", mode=mode, started=utc_now(), result=result
    )
    report = StatusReport(**AT_REST | {"state": "COMPLETED", "last_run": ended})
    report = report.model_copy(update={"state_requested": "COMPLETED"})
    assert said in _next(report)
