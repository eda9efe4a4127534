"""One line of JSON for each seed, in a folder that belongs to one study of one state of the source.

A study of thousands of seeds is ended and begun again many times. Figures of two states of the
software in one table would be figures of neither, so the folder remembers what it was made with.
"""

import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.study.outcome import StudyOutcome
from cellctl.version import ROOT, software

_SOURCES = ("cellctl", "drivers", "fakes", "benchmarks", "tests/rigs", "config")
_ENDINGS = frozenset({".py", ".toml", ".c", ".h", ".json"})


class AnotherStudy(RuntimeError):
    """The folder holds results that may not be mixed with those that are asked for."""


@dataclass(frozen=True, slots=True)
class StudySource:
    """What decides the result of a seed."""

    kind: str
    scales: Mapping[str, float]
    software: str
    source: str
    """SHA-256 of all files that can decide; two changed checkouts have one revision."""


def source_digest(root: Path = ROOT) -> str:
    """Digest of the names and contents of all sources below a checkout."""
    found = hashlib.sha256()
    for path in sorted(_files(root)):
        found.update(f"{path.relative_to(root)}\0".encode())
        found.update(hashlib.sha256(path.read_bytes()).digest())
    return found.hexdigest()


def present_source(kind: str, scales: Mapping[str, float]) -> StudySource:
    """The source of a study of this checkout."""
    return StudySource(kind, dict(scales), software(), source_digest())


def _files(root: Path) -> Iterator[Path]:
    for name in _SOURCES:
        for folder, _, files in os.walk(root / name):
            for file in files:
                if Path(file).suffix in _ENDINGS:
                    yield Path(folder) / file


class StudyResults:
    """The results of a folder. One program writes them."""

    def __init__(self, folder: Path, source: StudySource) -> None:
        """Open or begin; raises ``AnotherStudy``, ``OSError``."""
        folder.mkdir(parents=True, exist_ok=True)
        self._file = folder / "results.jsonl"
        head = folder / "study.json"
        if head.exists():
            _require_same(json.loads(head.read_text(encoding="utf-8")), asdict(source), folder)
        else:
            if self._file.exists():
                raise AnotherStudy(f"{self._file} has no study.json beside it")
            head.write_text(json.dumps(asdict(source), indent=2) + "\n", encoding="utf-8")
        self._outcomes = {one.seed: one for one in self._read()}

    @property
    def outcomes(self) -> list[StudyOutcome]:
        """Outcomes of all seeds so far, by seed."""
        return [self._outcomes[seed] for seed in sorted(self._outcomes)]

    def has(self, seed: int) -> bool:
        """Whether a seed needs no run."""
        return seed in self._outcomes

    def add(self, outcome: StudyOutcome) -> None:
        """Keep a result; it is on the disk when this returns."""
        with self._file.open("a", encoding="utf-8") as file:
            file.write(json.dumps(outcome.row()) + "\n")
            file.flush()
            os.fsync(file.fileno())
        self._outcomes[outcome.seed] = outcome

    def _read(self) -> Iterator[StudyOutcome]:
        if not self._file.exists():
            return
        data = self._file.read_bytes()
        whole, _, cut = data.rpartition(b"\n")
        if cut:
            # A program that was killed in the middle of a line: that seed runs again.
            os.truncate(self._file, len(data) - len(cut))
        for line in whole.splitlines():
            yield StudyOutcome.of(json.loads(line))


def _require_same(before: Mapping[str, object], now: Mapping[str, object], folder: Path) -> None:
    other = [key for key in now if before.get(key) != now[key]]
    if other:
        told = "; ".join(f"{key} {before.get(key)!s:.60}, now {now[key]!s:.60}" for key in other)
        raise AnotherStudy(
            f"{folder} holds results of another study ({told}). They are not mixed: give another "
            "--out, or remove the folder"
        )
