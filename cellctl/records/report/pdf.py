"""The report as PDF: the same page as in HTML, laid out on A4 by WeasyPrint."""

import logging
from pathlib import Path

from cellctl.errors.records import PdfNotMade

_SHEET = Path(__file__).with_name("report.pdf.css")


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
    sheet = f"<style>{_SHEET.read_text(encoding='utf-8')}</style>"
    page = page.replace("</head>", f"{sheet}</head>", 1)
    data: bytes = HTML(string=page, url_fetcher=fetcher).write_pdf()
    return data
