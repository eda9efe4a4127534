"""What a report is made of: values that a process fills in and the template places.

A process knows what its run means, this package knows how a report looks. A ``ReportBuilder`` of a
process returns ``ProcessPages``; it never writes HTML.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum

from cellctl.records.entries import Artefact, RunRecord
from cellctl.records.report.acceptance.requirement import RequirementGroup


@dataclass(frozen=True, slots=True)
class Tile:
    """One headline figure with its bound."""

    title: str
    value: str
    bound: str
    passed: bool | None
    """Whether the check was passed; None where there is nothing to judge."""


class RowMark(Enum):
    """How a row of a table stands out."""

    NONE = ""
    GOOD = "good"
    BAD = "bad"
    LIMIT = "threshold"
    """The limits of the columns above it."""
    GROUP = "group"
    """The heading of the rows below it: one cell over the whole width."""


@dataclass(frozen=True, slots=True)
class TableCell:
    """One cell; ``small`` is a second line in small print, such as an uncertainty."""

    text: str
    small: str = ""


@dataclass(frozen=True, slots=True)
class TableRow:
    """The first cell is the heading of the row; ``facts`` follow below it over the whole width."""

    cells: tuple[TableCell, ...]
    mark: RowMark = RowMark.NONE
    facts: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class ReportTable:
    """A table with a heading of its own, or none."""

    columns: tuple[str, ...]
    rows: tuple[TableRow, ...]
    numbers: bool = True
    """Columns after the first are numbers, aligned at their right."""


@dataclass(frozen=True, slots=True)
class Drawing:
    """A drawing as an ``<svg>`` element of ``cellctl.plot_style``."""

    svg: str
    caption: str


@dataclass(frozen=True, slots=True)
class FactList:
    """Labels and values, in two columns."""

    facts: tuple[tuple[str, str], ...]


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading within a section."""

    text: str
    small: str = ""
    warning: bool = False
    """``small`` is something to worry about."""


@dataclass(frozen=True, slots=True)
class Note:
    """A paragraph in small print."""

    text: str


ReportBlock = Heading | ReportTable | Drawing | FactList | Note


@dataclass(frozen=True, slots=True)
class ReportSection:
    """A section of the report; one without blocks is left out."""

    title: str
    blocks: tuple[ReportBlock, ...]


@dataclass(frozen=True, slots=True)
class Part:
    """One of the parts that a run is about."""

    role: str
    serial: str
    """Serial number; empty where nobody has named it."""


class RecordPart(Enum):
    """Parts of a record that a process may show better than the pages for any run do."""

    PASSES = "passes"
    GAUGES = "gauges"


@dataclass(frozen=True, slots=True)
class ProcessPages:
    """What a process adds to the report of its run."""

    tiles: tuple[Tile, ...] = ()
    """Headline figures, in place of the first figures with limits."""
    acceptance: tuple[RequirementGroup, ...] = ()
    """Requirements of the acceptance table, those that decide about the part first. Figures with a
    limit that are not among them follow by themselves."""
    parts: tuple[Part, ...] = ()
    """The parts of the run with their serial numbers; by default the one that the run names."""
    words: Mapping[str, str] = field(default_factory=dict)
    """What the figures without a limit are called in standard terms, by their keys."""
    sections: tuple[ReportSection, ...] = ()
    """Sections that come after the poses, in this order."""
    shows: frozenset[RecordPart] = frozenset()
    """Parts that ``sections`` show, so that they are not shown twice."""
    documents: frozenset[str] = frozenset()
    """Keys of the run's documents that ``sections`` show."""
    tabulated: frozenset[str] = frozenset()
    """Keys of a pose's detail that ``sections`` show."""


ReadArtefact = Callable[[Artefact], bytes]
"""The bytes of a file of the run."""

ReportBuilder = Callable[[RunRecord, ReadArtefact], ProcessPages]
"""How a process makes its pages. It must accept any record of its process, also of a run that
ended before its first figure."""


def no_pages(_record: RunRecord, _read: ReadArtefact) -> ProcessPages:
    """No pages, for the report of a run whose process is not installed."""
    return ProcessPages()
