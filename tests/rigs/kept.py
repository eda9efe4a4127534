"""What a process keeps: read from /proc at two moments and compared."""

import os
from dataclasses import dataclass
from pathlib import Path

GROWTH_KB = 8_000
"""Growth of resident memory that is no leak: the allocator keeps freed pieces of an image."""

GROWTH_THREADS = 1
"""That is not called one: a worker of a pool or a progress bar may be about to end."""


@dataclass(frozen=True, slots=True)
class Kept:
    """What one process keeps at one moment."""

    descriptors: int
    threads: int
    memory_kb: int
    """Resident."""

    def outgrows(self, before: "Kept") -> bool:
        """Whether something was kept since then that should have been let go."""
        return (
            self.descriptors > before.descriptors
            or self.threads > before.threads + GROWTH_THREADS
            or self.memory_kb > before.memory_kb + GROWTH_KB
        )


def kept(process: int) -> Kept:
    """What a process keeps now; raises ``OSError`` when it is gone."""
    folder = Path("/proc") / str(process)
    status = dict(
        line.split(":", 1) for line in (folder / "status").read_text("ascii").splitlines()
    )
    memory_kb = int(status["VmRSS"].split()[0])
    return Kept(len(os.listdir(folder / "fd")), int(status["Threads"]), memory_kb)
