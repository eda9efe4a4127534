"""What `cellctl doctor` prints: whole lines for programs, and for people none wider than theirs."""

import io

from rich.console import Console

from cellctl.cli.commissioning.doctor import show
from cellctl.doctor.diagnosis import Subject
from cellctl.doctor.finding import bad, good

FOUND = "the account 'cellctl' may not run anything in real time: RLIMIT_RTPRIO is 0, of 20 needed"
REMEDY = (
    "add LimitRTPRIO=20 to the unit, then `systemctl daemon-reload` and restart the service, or "
    "/etc/security/limits.d for a daemon that is started by hand"
)
SUBJECTS = (Subject("Scheduling", (bad("rights", FOUND, REMEDY), good("clock", "steady"))),)


def printed(*, terminal: bool) -> list[str]:
    words = io.StringIO()
    console = Console(
        file=words, force_terminal=terminal, width=80, soft_wrap=True, no_color=True, markup=False,
        highlight=False, color_system=None,
    )  # fmt: skip
    show(console, SUBJECTS)
    return words.getvalue().splitlines()


def test_on_a_terminal_lines_go_on_below_their_text() -> None:
    lines = printed(terminal=True)
    assert all(len(line) <= 80 for line in lines), lines
    assert lines[1].startswith("  ✗ rights: the account")
    assert lines[2].startswith("    ")
    assert lines[3].startswith("      add LimitRTPRIO=20")
    assert lines[4].startswith("      ")
    assert " ".join(" ".join(lines).split()).count(f"{FOUND} {REMEDY}") == 1


def test_for_a_program_each_stays_one_line() -> None:
    assert printed(terminal=False) == [
        "Scheduling",
        f"  ✗ rights: {FOUND}",
        f"      {REMEDY}",
        "  ✓ clock: steady",
        "1 bad, 0 doubtful",
    ]
