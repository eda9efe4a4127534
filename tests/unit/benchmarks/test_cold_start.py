"""What a start costs the processors is counted with all that the program has started."""

from pathlib import Path

from benchmarks.cold_start import processors_s
from tests.rigs.waiting import until_blocking
from tests.rigs.whole_cell.own_cell import Program

_WAITS = "import subprocess, sys; subprocess.run([sys.executable, '-c', 'while True: pass'])"


def test_descendants_count(tmp_path: Path) -> None:
    program = Program.start(tmp_path / "parent", "timeit", "-n", "1", _WAITS)
    try:
        # The program itself only waits.
        until_blocking(lambda: processors_s(program) > 0.5, within_s=30.0, look_s=0.05)
    finally:
        program.kill()
    # A process that was killed is there until the kernel has taken it down.
    until_blocking(lambda: processors_s(program) == 0.0, within_s=10.0)
