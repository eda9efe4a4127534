"""The report as PDF: the same page as in HTML, laid out on A4 by WeasyPrint."""

import logging
from importlib.resources import files

from cellctl.errors.records import PdfNotMade


def to_pdf(page: str) -> bytes:
    """A report of ``render``, with its pictures inside, as PDF.

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
    data: bytes = HTML(string=page, url_fetcher=fetcher).write_pdf()
    return data
