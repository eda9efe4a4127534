"""The guard process stays small: no arrays, no event loop, no log machinery."""

import subprocess
import sys

HEAVY = ("numpy", "scipy", "cv2", "asyncio", "structlog", "multiprocessing", "thrift")


def test_the_guard_and_its_drivers_stay_light() -> None:
    code = (
        # Modules that Python brings itself do not count; coverage, for one, needs multiprocessing.
        "import sys; before = set(sys.modules)\n"
        "import cellctl.guard.watch.main, drivers.ftsensor.sri.driver, "
        "drivers.robot.siasun.stop_channel, drivers.robot.siasun_rpc.stop_channel, "
        "drivers.ftsensor.sri.transports.tcp\n"
        f"print(*[name for name in {HEAVY!r} if name in sys.modules.keys() - before])"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], check=False, capture_output=True, text=True, timeout=30
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.split() == []
