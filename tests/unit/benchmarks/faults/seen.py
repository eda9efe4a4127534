"""An observation with nothing wrong, for tests that spoil one thing of it."""

from benchmarks.faults.observation import Effect, Expected, Moved, Observation

EXPECTED = Expected(Effect.AT_ONCE, bound_s=2.0, peak_bound_n=50.0)
BRAKED = Moved("main", begun_s=0.0, ended_s=0.4, travel_mm=12.0, rise_mm=-12.0, turn_deg=0.5)
CALM = Observation(
    fault="emergency-stop",
    phase="contact",
    expected=EXPECTED,
    motions=[BRAKED],
    peak_n=41.0,
    ended_s=1.0,
    state="Aborted",
    shown=[302],
    refused=0,
    record="aborted",
    next_start="Aborted F302 → Stopped → Idle",
    idle_again=True,
    restarted=False,
    lost_s=0.1,
    software="cellctl 0 (abc)",
)
