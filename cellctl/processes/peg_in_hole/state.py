"""What the steps of one insertion hand to each other: each state has what the next step needs."""

from dataclasses import dataclass

from cellctl.cell.contact_motion.frames import ContactFrames
from cellctl.processes.peg_in_hole.cycle import CycleResult
from cellctl.processes.peg_in_hole.run import PegRun


@dataclass(frozen=True, slots=True, eq=False)
class AtHome:
    """The arm holds the peg, clear of everything."""

    run: PegRun


@dataclass(frozen=True, slots=True, eq=False)
class AboveHole(AtHome):
    """The tip is over the believed place of the hole."""

    frames: ContactFrames


@dataclass(frozen=True, slots=True, eq=False)
class FaceTouched(AboveHole):
    """Frame A lies on the face now; the tip is clear of it."""

    face_yields_m: float
    """See ``TouchedFace``."""


@dataclass(frozen=True, slots=True, eq=False)
class PegInserted(FaceTouched):
    """The peg is in its hole, judged, and still held."""

    result: CycleResult
