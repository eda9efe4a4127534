"""What an integrator adapts in the job files before they are loaded.

Section 1 of the installation sheet (drivers/robot/siasun/job/README.md): name, limit of a step and
dead man's time. Address and port stay: the fake controller has a route of its own.
"""

import re
from dataclasses import dataclass
from pathlib import Path

from fakes.robot_jobs.lexer import JobError
from fakes.robot_jobs.program import Program, load_program, read_program

SHIPPED = Path(__file__).parents[2] / "drivers" / "robot" / "siasun" / "job"
"""Folder of the delivery."""
_ROUNDING_MM = 0.0005
"""A step may be longer by this than the job says, because of the last decimal of its numbers."""


@dataclass(frozen=True, slots=True)
class Adaptation:
    """Figures of one site."""

    robot_name: str
    step_max_mm: float
    deadman_ms: int

    def applied(self, text: str, job: str) -> str:
        """The text of a job with these figures; raises ``JobError`` where the sheet names a place
        that the file does not have."""
        text = _replaced(r"(HELLO,SJL,2,[A-Z]{3}),[^,]+,", rf"\g<1>,{self.robot_name},", text, job)
        text = _replaced(r"STEPMAX=[0-9.]+", f"STEPMAX={self.step_max_mm:.4f}", text, job)
        text = _replaced(r"DEADMAN=[0-9]+", f"DEADMAN={self.deadman_ms}", text, job)
        if job == "SJLMAIN":
            limit = f"IF R[14] > {self.step_max_mm + _ROUNDING_MM:.4f} "
            return _replaced(r"IF R\[14\] > [0-9.]+ ", limit, text, job)
        return _replaced(r"(IF I\[[34]03\] <=) [0-9]+ ", rf"\g<1> {self.deadman_ms} ", text, job)


def installed(folder: Path, adaptation: Adaptation | None) -> dict[str, Program]:
    """The jobs of a folder by name, adapted, or as they are shipped."""
    if adaptation is None:
        return {path.stem: load_program(path) for path in sorted(folder.glob("*.job"))}
    return {
        path.stem: read_program(path.stem, adaptation.applied(path.read_text("ascii"), path.stem))
        for path in sorted(folder.glob("*.job"))
    }


def _replaced(pattern: str, replacement: str, text: str, job: str) -> str:
    text, count = re.subn(pattern, replacement, text)
    if count != 1:
        raise JobError(f"{job}: {pattern} stands there {count} times, once was expected")
    return text
