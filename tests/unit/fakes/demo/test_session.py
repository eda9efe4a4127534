"""What a demonstration says of the computer that it ran on."""

from fakes.demo.session import too_slow


def test_it_says_how_much_was_lost_and_what_to_do() -> None:
    said = too_slow(lost_s=5.3, passed_s=72.4)
    assert "5.3 s of 72 s" in said
    assert "run it again" in said
