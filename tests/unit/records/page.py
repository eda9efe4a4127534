"""Reads an exported report as a browser would."""

from html.parser import HTMLParser
from pathlib import Path

VOID = {"meta", "br", "img", "link", "hr", "input"}
UNSEEN = {"style", "title", "metadata"}


class Checker(HTMLParser):
    """Open and close tags must match; collects text and addresses."""

    def __init__(self) -> None:
        super().__init__()
        self.stack: list[str] = []
        self.texts: list[str] = []
        self.shown: list[str] = []
        """The part of ``texts`` that a reader sees."""
        self.addresses: list[str] = []
        self.tags: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("src", "href")]
        if tag not in VOID:
            self.stack.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        pass

    def handle_endtag(self, tag: str) -> None:
        assert self.stack.pop() == tag

    def handle_data(self, data: str) -> None:
        self.texts.append(data.strip())
        if not UNSEEN.intersection(self.stack):
            self.shown.append(data.strip())


def read(report: Path) -> Checker:
    checker = Checker()
    checker.feed(report.read_text(encoding="utf-8"))
    assert checker.stack == []
    return checker


def text_of(report: Path) -> str:
    """All words of the page in their order."""
    return " ".join(read(report).texts)
