"""The templates mark every value that the commissioning guide wants to be filled in."""

import re
from pathlib import Path

import pytest

from cellctl.config.document.lines import FILL_IN

ROOT = Path(__file__).parents[3]
GUIDE = ROOT / "docs" / "commissioning.md"
TEMPLATES = ("cell.toml", "deck-gige.toml", "antenna-gige.toml")
# The order of leaving a zone and a TCP port have values that fit most cells; what records are
# traced by, and the spread of what was taught, may be left out.
MAY_STAY = {"port", "retreat", "uncertainty_mm", "every_h"}


def keys_to_fill_in() -> set[str]:
    text = GUIDE.read_text(encoding="utf-8")
    section = text.split("### Every value to fill in")[1].split("**Pose checks need")[0]
    firsts = [row.split("|")[1] for row in section.splitlines() if row.startswith("| `")]
    return {key for cell in firsts for key in re.findall(r"`(\w+)`", cell)} - MAY_STAY


def unmarked(text: str) -> set[str]:
    """Keys at the begin of lines without a mark: on the line, or in the comment above its block."""
    found, covered, in_comment = set(), False, False
    for line in text.splitlines():
        if line.startswith("#"):
            covered = FILL_IN in line or (covered and in_comment)
        elif not line or (line.startswith("[") and not in_comment):
            covered = False
        in_comment = line.startswith("#")
        key = re.match(r"(\w+)(?:\.\w+)* =", line)
        if key and not covered and FILL_IN not in line:
            found.add(key[1])
    return found


@pytest.mark.parametrize("name", TEMPLATES)
def test_every_value_of_the_guide_is_marked(name: str) -> None:
    text = (ROOT / "config" / name).read_text(encoding="utf-8")
    assert unmarked(text) & keys_to_fill_in() == set()


def test_the_guide_names_what_templates_have() -> None:
    keys = keys_to_fill_in()
    assert {"workspace_min_mm", "flange_T_sensor", "dh", "plug", "fast_speed_mm_s"} <= keys


def test_a_mark_is_for_its_line_its_block_or_its_table() -> None:
    text = (
        "a = 1  # FILL IN\nb = 2\n# FILL IN: two\nc = 3\nd = 4\n# other\ne = 5\n"
        "\n# FILL IN: table\n[t]\nf = 6\n\n[u]\ng = 7\n"
    )
    assert unmarked(text) == {"b", "e", "g"}
