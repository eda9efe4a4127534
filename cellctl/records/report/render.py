"""The view as one HTML page: no scripts, no foreign addresses, ready to print on A4."""

from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from cellctl.records.report import text
from cellctl.records.report.acceptance.identification import SIGNATURES
from cellctl.records.report.sections import (
    Drawing,
    FactList,
    Heading,
    Note,
    ReportBlock,
    RowMark,
    TableRow,
)
from cellctl.records.report.view import ReportView


def render(view: ReportView) -> str:
    """The report as one HTML page."""
    environment = Environment(
        loader=PackageLoader("cellctl.records.report", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        # A name that the template has wrong must fail in the tests and not print nothing.
        undefined=StrictUndefined,
    )
    environment.filters |= {
        "when": text.when,
        "short": text.short,
        "zip": zip,
        "block_kind": _block_kind,
        "passed": _passed,
        "svg": Markup,  # drawings are made from numbers by plot_style, never from outside text
    }
    css = files("cellctl.records.report").joinpath("report.css").read_text(encoding="utf-8")
    return environment.get_template("report.html").render(
        view=view,
        run=view.record.head,
        record=view.record,
        css=Markup(css),  # a file of this package
        signatures=SIGNATURES,
        duration=text.duration(view.record.head.started, view.record.head.ended),
    )


def _passed(row: TableRow) -> bool | None:
    """What the mark of a row says; None where it says nothing, or a cell has words for it."""
    # Colour alone is lost in grey print.
    if any(cell.text.startswith(("✓", "✗")) for cell in row.cells):
        return None
    return {RowMark.GOOD: True, RowMark.BAD: False}.get(row.mark)


def _block_kind(block: ReportBlock) -> str:
    """Which macro of the template places a block."""
    match block:
        case Heading():
            return "heading"
        case Drawing():
            return "drawing"
        case FactList():
            return "facts"
        case Note():
            return "note"
        case _:
            return "table"
