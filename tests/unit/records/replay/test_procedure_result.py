"""The checks of a result are the figures of its run, each with a key of its own."""

from cellctl.calibration.checks import LimitCheck
from cellctl.records.entries import Verdict
from cellctl.records.replay.procedure_result import check_figures


def test_checks_of_one_name_do_not_hide_each_other() -> None:
    """Hand-eye calibrations have a residual in mm and one in degrees."""
    checks = (
        LimitCheck("residual rms", 0.05, 0.1, "mm"),
        LimitCheck("residual rms", 0.02, 0.01, "°"),
        LimitCheck("smaller arc", 90.0, 30.0, "°", "min"),
    )
    found = list(check_figures("camera", {"checks": [check.to_record() for check in checks]}))
    assert [(one.key, one.value, one.unit) for one in found] == [
        ("camera.residual_rms", 0.05, "mm"),
        ("camera.residual_rms_2", 0.02, "°"),
        ("camera.smaller_arc", 90.0, "°"),
    ]
    assert [one.verdict for one in found] == [Verdict.PASS, Verdict.FAIL, Verdict.PASS]
    assert (found[2].lower, found[2].upper) == (30.0, None)


def test_a_result_without_checks_has_no_figures() -> None:
    assert list(check_figures("panel", {"verdict": "pass"})) == []
