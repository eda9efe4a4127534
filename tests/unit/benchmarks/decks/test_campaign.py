"""The campaign as its user starts it: in processes, which must find what they are to do."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

DECK = "10kg-1x1m-150mm"


@pytest.mark.figures
def test_a_deck_is_measured_and_mated_in_a_process_of_its_own(tmp_path: Path) -> None:
    options = ("-n", "1", "--workers", "1", "--only", DECK, "--page", str(tmp_path / "decks.md"))
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.decks.campaign", *options],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    (figures,) = json.loads((tmp_path / "decks.json").read_text("utf-8")).values()
    assert (figures["deck"], figures["outcome"]) == (DECK, "good")
    assert "| 10 kg | 1 × 1 | 150 | 1 of 1 |" in (tmp_path / "decks.md").read_text("utf-8")
