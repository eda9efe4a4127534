"""The table of values to fill in names every key that the template of a cell file marks."""

import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
MARK = "FILL IN"
_KEY = re.compile(r"^(?:\[+(?P<table>[\w.\-]+)\]+|(?:# )?(?P<key>\w+) = )")
_ANY = re.compile(r"\b(\w+) = ")


def marked(template: str) -> Iterator[tuple[int, list[str]]]:
    """Line of each mark, and the keys on its line, or of the lines that follow a remark."""
    lines = template.splitlines()
    for index, line in enumerate(lines):
        if MARK not in line or index == 0:  # the first line says how to use the file
            continue
        if not line.startswith("#"):
            yield index + 1, _ANY.findall(line.split("#", 1)[0])
            continue
        after = (one for one in lines[index + 1 :] if _KEY.match(one))
        first = next(after)
        if (found := _KEY.match(first)) and found["table"]:
            first = next(after)
        yield index + 1, _ANY.findall(first.removeprefix("# "))


def test_every_marked_key_is_in_the_table_of_the_guide() -> None:
    page = (ROOT / "docs" / "commissioning.md").read_text(encoding="utf-8")
    section = page.split("### Every value to fill in", 1)[1].split("**Pose checks", 1)[0]
    named = set(re.findall(r"`(?:[\w]+\.)*(\w+)`", section))
    missing = {}
    template = (ROOT / "config" / "cell.toml").read_text(encoding="utf-8")
    found = list(marked(template))
    for line, keys in found:
        assert keys, f"config/cell.toml, line {line}: a mark of no key"
        if not named & set(keys):
            missing[line] = keys
    assert missing == {}
    assert len(found) == template.count(MARK) - 1
