"""One finding of a check of the cell file."""

from dataclasses import dataclass

from cellctl.errors.config import ConfigInvalid


@dataclass(frozen=True, slots=True)
class WrittenValue:
    """A value that a finding is held against."""

    key: str
    value: str
    line: int | None = None
    """Line in which the key stands; None for another file."""
    allowed: str = ""
    """What it would have to be with all others as they are; empty where that is not known."""

    @property
    def accused(self) -> str:
        """This value as one that may be wrong in place of another."""
        place = "this" if self.line is None else f"line {self.line}"
        return f"{place} is wrong: {self._words}"

    def __str__(self) -> str:
        place = "" if self.line is None else f"line {self.line}: "
        return f"{place}{self._words}"

    @property
    def _words(self) -> str:
        wanted = f": {self.allowed}" if self.allowed else ""
        return f"{self.key} = {self.value}{wanted}"


@dataclass(frozen=True, slots=True)
class ConfigIssue:
    """One error in a cell file or a file that it names."""

    key: str
    value: str
    allowed: str
    number: int = ConfigInvalid.number
    line: int | None = None
    """Line of the key, or of the table that lacks it; None for another file."""
    against: tuple[WrittenValue, ...] = ()
    """What this value contradicts, where nothing decides which of them is wrong."""

    @property
    def written(self) -> WrittenValue:
        """What is wrong, without what is allowed."""
        return WrittenValue(self.key, self.value, self.line)

    def __str__(self) -> str:
        """Place, value and what is allowed, in one line."""
        others = "".join(f"; or {other.accused}" for other in self.against)
        return f"{self.written}: {self.allowed}{others}"
