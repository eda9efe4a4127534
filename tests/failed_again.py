"""A pytest plugin: what is tried again when a few of many tests have failed.

With several workers a test shares two processors with whatever tests run beside it, and some hold
drivers to limits of tens of milliseconds. `make test` therefore runs what has failed once more,
alone, as the test runner of CPython does. What fails again counts. Where more than a few have
failed it was not the neighbours, and nothing is tried again.
"""

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--most-again",
        type=int,
        metavar="N",
        help="with --last-failed: end as failed when there are more than N",
    )


def pytest_collection_finish(session: pytest.Session) -> None:
    """Give up where too many have failed, once --last-failed has left out what has passed."""
    most, failed = session.config.getoption("most_again"), len(session.items)
    if most is not None and failed > most:
        pytest.exit(f"{failed} tests have failed, which is too many to try again", returncode=1)


def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> None:
    """Name those that passed this time: they depend on what runs beside them."""
    if config.getoption("most_again") is None:
        return
    for report in terminalreporter.stats.get("passed", []):
        terminalreporter.write_line(f"TRIED AGAIN {report.nodeid}: passed alone")
