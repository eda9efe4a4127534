"""Lines of keys: in tables, arrays of tables, inline tables, behind lists of several lines."""

from hypothesis import given
from hypothesis import strategies as st

from cellctl.config.document.lines import key_lines, left_open, line_of

TEXT = """name = "a = b [c]"
[plc]
port = 5020   # port = 1
list = [
  "x = 1",
  "[no.table]",
]
after = 1
[[recipes]]
id = 1
[recipes.mating]
force = 1
[[recipes]]
id = 2
settings = { host = "h = 1", port = 2 }
left.serial = "1"
"""


def test_every_key_has_its_line() -> None:
    lines = key_lines(TEXT)
    assert {key: lines[key] for key in ("name", "plc", "plc.port", "plc.after")} == {
        "name": 1,
        "plc": 2,
        "plc.port": 3,
        "plc.after": 8,
    }
    assert (lines["recipes.0.id"], lines["recipes.1.id"]) == (10, 14)
    assert lines["recipes.0.mating.force"] == 12
    assert lines["recipes.1.settings.port"] == 15
    assert lines["recipes.1.left.serial"] == 16
    assert "no.table" not in lines


def test_a_missing_key_has_the_line_of_its_table() -> None:
    lines = key_lines(TEXT)
    assert line_of("plc.heartbeat_timeout_s", lines) == 2
    assert line_of("recipes.1.mating.limit", lines) == 13
    assert line_of("robots", lines) is None


def test_marks_count_but_for_the_line_that_explains_them() -> None:
    text = "# fill in what is marked FILL IN\na = 1 # FILL IN: the port\nb = 2\n"
    assert left_open(text) == {2: "a"}


def test_a_mark_names_what_it_is_of() -> None:
    text = """# FILL IN: all of it
[robots.main.settings]
listen_host = "a"   # FILL IN
# FILL IN: the box
# of the flange
low_mm = [1]
rows = [
  [0, 1],   # FILL IN: by the data sheet
]
switch = { host = "b" }   # FILL IN

[[recipes]]
# FILL IN
name = "c"
# FILL IN: what the drawing says.
# tip = [[0.0, 1.0], ...]
mass = 1
# FILL IN: poses
"""
    settings = "robots.main.settings"
    assert list(left_open(text).values()) == [
        settings,
        f"{settings}.listen_host",
        f"{settings}.low_mm",
        f"{settings}.rows",
        f"{settings}.switch",
        "recipes.0.name",
        "recipes.0.tip",
        "recipes.0.mass",
    ]
    assert left_open("# FILL IN") == {1: ""}


@given(st.text(alphabet="[]{}=.#\"' \nab1", max_size=200))
def test_any_text_has_lines_of_its_own_only(text: str) -> None:
    lines = key_lines(text)
    assert all(1 <= number <= len(text.splitlines()) for number in lines.values())
