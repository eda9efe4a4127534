"""What is said of a line that is no TOML."""

import tomllib

import pytest

from cellctl.config.document.toml_hints import toml_hint


def hinted(text: str) -> str:
    with pytest.raises(tomllib.TOMLDecodeError) as raised:
        tomllib.loads(text)
    return toml_hint(text, str(raised.value))


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("speed = 10,5", "a decimal comma: TOML has a point, speed = 10.5"),
        ("name = “cell”", "quotes of a text program"),
        ("name = fake-cell  # new", "a text without quotes"),
        ("simulated = True", "written small"),
        ("port: 5020", "a colon"),
    ],
)
def test_a_usual_slip_is_named_with_its_line(line: str, said: str) -> None:
    hint = hinted(f'a = "x"\n{line}\nb = 2\n')
    assert "line 2 " in hint
    assert said in hint


def test_a_key_that_stands_there_twice_is_named_with_both_lines() -> None:
    assert "port stands in line 1 already" in hinted("port = 1\nb = 2\nport = 3\n")


def test_what_is_not_known_is_left_to_the_parser() -> None:
    assert hinted("a = [1, 2\n") == ""
