"""One line for a mistake, with all that it contradicts."""

from cellctl.config.issue import ConfigIssue, WrittenValue


def test_a_line_names_what_else_may_be_wrong_and_what_it_would_have_to_be() -> None:
    against = (WrittenValue("b", "2", 7, "at most 1"), WrittenValue("c", "3"))
    assert str(ConfigIssue("a", "5", "at least 6", line=4, against=against)) == (
        "line 4: a = 5: at least 6; or line 7 is wrong: b = 2: at most 1; or this is wrong: c = 3"
    )
