"""What the store has to know about one kind of calibration, as data.

A process defines its kinds and hands them over; nothing else in the core names one of them.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from cellctl.errors import CellError
from cellctl.errors.calibration import CalibrationRecordInvalid

T = TypeVar("T")


def verdict_is_pass(record: Mapping[str, Any]) -> bool:
    """How most records say that their figures were within the limits."""
    return record.get("verdict") == "pass"


@dataclass(frozen=True, slots=True, kw_only=True)
class CalibrationKind(Generic[T]):
    """One kind of calibration; ``T`` is the type of its result.

    Raises ``ValueError`` for a kind of each recipe that names a register.
    """

    name: str
    """Name of its file without ``.json``, of its rows in the run store and in messages."""
    parse: Callable[[Mapping[str, Any]], T]
    """From the record to the result; ``KeyError``, ``TypeError`` and ``ValueError`` mean that the
    record is damaged."""
    register: str | None = None
    """The PLC register ``validity_<register>`` shows its remaining hours; several kinds may share
    one, which then shows the least."""
    invalidated_by: frozenset[type[CellError]] = frozenset()
    """Faults after which it is no longer to be trusted: exactly these classes, not what derives
    from them."""
    device: str | None = None
    """Role of the device that it was made for, whose serial number must match; None where the
    result does not belong to an exchangeable device."""
    holds_for: str | None = None
    """Key of its record under which stand the taught joints in degrees, by role, for which alone
    it holds; None where it holds for every pose."""
    procedures: tuple[int, ...] = ()
    """Numbers of the Maintenance procedures that make it, in the order of their work."""
    accepted: Callable[[Mapping[str, Any]], bool] = verdict_is_pass
    """Whether a record says of itself that it passed."""
    required: bool = True
    """Whether production refuses to start without it. One that is not required only replaces a
    bound of the recipe by a better figure. Production does without one that was never made; one
    that was invalidated says that something has moved, which a bound need not have foreseen."""
    serves_production: bool = True
    """Whether production reads it at all, so that it does not start while it is invalidated."""
    per_recipe: bool = False
    """Whether every recipe has one of its own; see ``for_recipe``."""

    def __post_init__(self) -> None:
        # The line reads its registers before it has chosen a recipe.
        if self.per_recipe and self.register is not None:
            raise ValueError(f"{self.name}: of each recipe one, so no register can show it")

    def for_recipe(self, recipe_id: int) -> "CalibrationKind[T]":
        """The kind of one recipe's parts; itself when it does not depend on the recipe."""
        if not self.per_recipe:
            return self
        return replace(self, name=f"{self.name}_{recipe_id}", per_recipe=False)

    def includes(self, name: str) -> bool:
        """Whether a file of this name is of this kind, of whatever recipe."""
        if not self.per_recipe:
            return name == self.name
        start, _, recipe = name.rpartition("_")
        return start == self.name and recipe.isdecimal()

    @property
    def made_by(self) -> str:
        """The procedures that make it, for messages; empty when it has none."""
        numbers = " and ".join(str(number) for number in self.procedures)
        return f"procedure{'s' * (len(self.procedures) > 1)} {numbers}" if numbers else ""

    def result(self, record: Mapping[str, Any]) -> T:
        """The parsed record; raises ``CalibrationRecordInvalid`` when it cannot be parsed."""
        try:
            return self.parse(record)
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise CalibrationRecordInvalid(f"{self.name}: {error!r}") from error


Kinds = Iterable[CalibrationKind[Any]]


def unparsed(name: str) -> CalibrationKind[Mapping[str, Any]]:
    """The kind of a file that no installed process knows: its record as it is."""
    return CalibrationKind(name=name, parse=dict, required=False)


def kinds_invalidated_by(fault: CellError, kinds: Kinds) -> list[CalibrationKind[Any]]:
    """Kinds that a fault makes worthless, in their order; mostly none."""
    # By the exact class: a fault that is derived later from one of these must not invalidate
    # anything without being named.
    return [kind for kind in kinds if type(fault) in kind.invalidated_by]
