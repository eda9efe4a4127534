"""What the PC says to a job program, in the form of the protocol that its hello names."""

from collections.abc import Sequence
from typing import Protocol

from drivers.robot.siasun import protocol
from drivers.robot.siasun.codec.compact.words import CompactWords
from drivers.robot.siasun.codec.records import Hello


class Words(Protocol):
    """Records as bytes. Arguments as in ``protocol.py``."""

    @property
    def least_acceleration_mm_s2(self) -> float:
        """Smallest acceleration of a straight move that the job program carries out as it is told;
        0: any."""

    def accept_hello(self, session: int) -> bytes:
        """Accept a robot and number its session."""

    def refuse_hello(self, reason: str) -> bytes:
        """Refuse a robot."""

    def move_joint(
        self, session: int, seq: int, joints_deg: Sequence[float], percent: int
    ) -> bytes:
        """Move to joint angles in degrees."""

    def move_linear(
        self,
        session: int,
        seq: int,
        xyzabc: Sequence[float],
        speed_mm_s: float,
        acceleration_mm_s2: float,
    ) -> bytes:
        """Move straight to a pose in mm and degrees."""

    def step(self, session: int, seq: int, xyzabc: Sequence[float], speed_mm_s: float) -> bytes:
        """A short straight move."""

    def rearm(self, session: int, seq: int) -> bytes:
        """Release the stop latch."""

    def beat(self, session: int, count: int) -> bytes:
        """Heartbeat."""

    def abort(self, session: int, abort_id: int) -> bytes:
        """Stop now and latch."""


def words_of(hello: Hello) -> Words:
    """The form that a job program with this hello understands."""
    if hello.compact:
        return CompactWords(hello.acceleration_max_mm_s2)
    return protocol
