"""The view as one HTML page: no scripts, no foreign addresses, ready to print on A4."""

from importlib.resources import files

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from cellctl.records.report import text
from cellctl.records.report.view import COMPONENTS, ReportView, worst_share


def render(view: ReportView) -> str:
    """The page."""
    environment = Environment(
        loader=PackageLoader("cellctl.records.report", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=StrictUndefined,
    )
    environment.filters |= {
        "when": text.when,
        "fixed": text.fixed,
        "short": text.short,
        "plain": text.plain,
        "zip": zip,
        "svg": Markup,  # figures are made here, from numbers
    }
    css = files("cellctl.records.report").joinpath("report.css").read_text(encoding="utf-8")
    return environment.get_template("report.html").render(
        view=view,
        run=view.record.head,
        record=view.record,
        css=Markup(css),  # a file of this package
        components=COMPONENTS,
        duration=text.duration(view.record.head.started, view.record.head.ended),
        worst_share=worst_share,
    )
