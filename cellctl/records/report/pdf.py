"""The report as PDF: the same page as in HTML, laid out on A4 by WeasyPrint."""

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib.resources import files

from cellctl.errors.records.store import PdfNotMade


class _Told(logging.Handler):
    """Hands on what WeasyPrint says of its progress."""

    def __init__(self, tell: Callable[[str], None]) -> None:
        super().__init__(logging.INFO)
        self._tell = tell

    def emit(self, record: logging.LogRecord) -> None:
        """Called by ``logging``."""
        self._tell(record.getMessage())


def to_pdf(page: str, tell: Callable[[str], None] = lambda _: None) -> bytes:
    """A report of ``render``, with its pictures inside, as PDF.

    ``tell`` hears how far it is, page by page: a long report takes minutes on a busy computer.
    Nothing is fetched from disk or net. Raises ``PdfNotMade`` when the libraries of the system
    that WeasyPrint draws text with are not there (Pango, https://doc.courtbouillon.org/weasyprint).
    """
    try:
        # Here, because it takes a second, and few commands make a PDF.
        from weasyprint import HTML
        from weasyprint.urls import URLFetcher
    except OSError as error:
        raise PdfNotMade(str(error).splitlines()[0]) from error
    # It warns about properties that only browsers know; they change nothing on paper.
    logging.getLogger("weasyprint").setLevel(logging.ERROR)
    fetcher = URLFetcher(allowed_protocols={"data"})
    # Within the page: what WeasyPrint takes beside it counts less than the page's own style.
    css = files("cellctl.records.report").joinpath("report.pdf.css").read_text(encoding="utf-8")
    page = page.replace("</head>", f"<style>{css}</style></head>", 1)
    with _told(tell):
        data: bytes = HTML(string=page, url_fetcher=fetcher).write_pdf()
    return data


@contextmanager
def _told(tell: Callable[[str], None]) -> Iterator[None]:
    progress, handler = logging.getLogger("weasyprint.progress"), _Told(tell)
    level = progress.level
    progress.setLevel(logging.INFO)
    progress.addHandler(handler)
    try:
        yield
    finally:
        progress.removeHandler(handler)
        progress.setLevel(level)
