"""One finding of a check of the cell file."""

from dataclasses import dataclass

from cellctl.errors.config import ConfigInvalid


@dataclass(frozen=True, slots=True)
class ConfigIssue:
    """One error in a cell file or a file that it names."""

    key: str
    value: str
    allowed: str
    number: int = ConfigInvalid.number
    line: int | None = None
    """Where the key stands, or the table that lacks it; None for another file."""

    def __str__(self) -> str:
        """Place, value and what is allowed, in one line."""
        place = "" if self.line is None else f"line {self.line}: "
        return f"{place}{self.key} = {self.value}: {self.allowed}"
