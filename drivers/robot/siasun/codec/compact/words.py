"""SJL/2 records that the PC sends (docs/protocols/sjl-2.md): fields of fixed width, without I/O."""

from collections.abc import Sequence
from dataclasses import dataclass

_COUNT_OFFSET = 1_000_000
_VALUE_OFFSET = 500_000.0
"""Added so that no number has a sign, a leading zero or another length."""


@dataclass(frozen=True, slots=True)
class CompactWords:
    """The words of SJL/2. ``acceleration_max_mm_s2`` is what 100 percent mean on this
    controller."""

    acceleration_max_mm_s2: float

    @property
    def least_acceleration_mm_s2(self) -> float:
        """1 %: the job program moves with whole percents that are written out in it, and with its
        smallest where it is told less."""
        return self.acceleration_max_mm_s2 / 100.0

    def accept_hello(self, session: int) -> bytes:
        """Accept a robot and give it the number of its session."""
        return _short("OKAY", session, 0)

    def refuse_hello(self, reason: str) -> bytes:  # noqa: ARG002  other forms send it
        """The reason stays in the log of the PC: the job program could not show it."""
        return _short("NOPE", 0, 0)

    def move_joint(
        self, session: int, seq: int, joints_deg: Sequence[float], percent: int
    ) -> bytes:
        """MOVJ, as in SJL/1."""
        return _long("MOVJ", session, seq, (*joints_deg, float(percent), 0.0))

    def move_linear(
        self,
        session: int,
        seq: int,
        xyzabc: Sequence[float],
        speed_mm_s: float,
        acceleration_mm_s2: float,
    ) -> bytes:
        """MOVL; the acceleration in percent of the controller's."""
        percent = 100.0 * acceleration_mm_s2 / self.acceleration_max_mm_s2
        return _long("MOVL", session, seq, (*xyzabc, speed_mm_s, min(percent, 100.0)))

    def step(self, session: int, seq: int, xyzabc: Sequence[float], speed_mm_s: float) -> bytes:
        """STEP, as in SJL/1. The arm takes a tenth of a second to reach its speed."""
        # A step of SJL/1 has no acceleration, but the percents of this form need one.
        percent = 100.0 * 10.0 * speed_mm_s / self.acceleration_max_mm_s2
        return _long("STEP", session, seq, (*xyzabc, speed_mm_s, min(percent, 100.0)))

    def rearm(self, session: int, seq: int) -> bytes:
        """REARM; its values are all 0."""
        return _long("REAR", session, seq, (0.0,) * 8)

    def beat(self, session: int, count: int) -> bytes:
        """BEAT, which answers a report."""
        return _short("BEAT", session, count % _COUNT_OFFSET)

    def abort(self, session: int, abort_id: int) -> bytes:
        """ABORT, at any time; the same ``abort_id`` may be repeated."""
        return _short("ABRT", session, abort_id)


def _short(word: str, session: int, count: int) -> bytes:
    numbers = (session + _COUNT_OFFSET, count + _COUNT_OFFSET)
    return b"%s%d%d%d;" % (word.encode("ascii"), *numbers, sum(numbers))


def _long(word: str, session: int, seq: int, values: Sequence[float]) -> bytes:
    counts = (session + _COUNT_OFFSET, seq + _COUNT_OFFSET)
    texts = [f"{value + _VALUE_OFFSET:.4f}" for value in values]
    # The sum is that of the numbers as they are written, so that the controller finds the same one.
    total = sum(counts) + sum(float(text) for text in texts)
    return f"{word}{counts[0]}{counts[1]}{''.join(texts)}{total:.4f};".encode("ascii")
