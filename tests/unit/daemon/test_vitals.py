"""What the daemon tells of itself."""

from cellctl.daemon.vitals import LOOKED_BACK_S, DaemonVitals


def late_s(told: DaemonVitals) -> float | None:
    found: float | None = told.snapshot()["loop_late_s"]
    return found


def test_the_latest_turn_is_told_as_long_as_somebody_may_ask_for_it() -> None:
    clock = [100.0]
    told = DaemonVitals(lambda: 0.4, lambda: clock[0])
    assert late_s(told) is None, "before the first turn"
    for at_s, turn_s in ((100.0, 0.01), (101.0, 0.3), (102.0, 0.02), (103.0, 0.05), (104.0, 0.0)):
        clock[0] = at_s
        told.turn(turn_s)
    assert late_s(told) == 0.3
    clock[0] = 101.0 + LOOKED_BACK_S
    assert late_s(told) == 0.3
    clock[0] += 0.1
    assert late_s(told) == 0.05, "of those that came after it"
    clock[0] = 104.1 + LOOKED_BACK_S
    assert late_s(told) is None, "a loop that takes no turns is not called punctual"


def test_memory_is_that_of_this_process() -> None:
    found = DaemonVitals(lambda: None).snapshot()
    assert found["line_beat_age_s"] is None
    assert 10e6 < found["resident_bytes"] < 50e9
