"""Base model and common types of all sections of the cell file."""

from enum import Enum, auto
from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

# The bounds refuse what no cell can hold. TOML has ``inf`` and ``nan``, which must not pass for a
# length either: every comparison with ``nan`` is false.
Millimetres = Annotated[float, Field(ge=-20_000, le=20_000, allow_inf_nan=False)]
Degrees = Annotated[float, Field(ge=-360, le=360, allow_inf_nan=False)]
WrittenPose = tuple[Millimetres, Millimetres, Millimetres, Degrees, Degrees, Degrees]
"""X, Y, Z in mm, A, B, C in degrees; R = Rz(A) Ry(B) Rx(C)."""
JointsDeg = tuple[Degrees, Degrees, Degrees, Degrees, Degrees, Degrees]


class LessSafe(Enum):
    """Stands beside a key of a model, in its ``Annotated``: which other values are less safe.

    Where figures of a cell file contradict each other, `cellctl check` names every key that could
    give way. By this it names the less safe ways last, and says what they are.
    """

    WITH_MORE = auto()
    """The arm presses harder, or goes on for longer, before anything stops it."""
    WITH_LESS = auto()
    """An upper bound of what the cell is: with less the arm is driven faster than it may be."""


class Section(BaseModel):
    """A section: immutable, and an unknown key is an error."""

    # A misspelt key would otherwise leave its default in force, and a limit that somebody has set
    # would not hold. Frozen, because a cell file that is changed while the daemon runs holds only
    # after a restart.
    model_config = ConfigDict(extra="forbid", frozen=True)
