"""The software names itself, with the revision of a checkout."""

import subprocess
from pathlib import Path

from cellctl import __version__
from cellctl.version import _revision, software


def git(root: Path, *arguments: str) -> str:
    identity = ("-c", "user.name=test", "-c", "user.email=test@localhost")
    command = ["git", "-C", str(root), *identity, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def test_the_version_comes_first() -> None:
    assert software().startswith(f"cellctl {__version__}")


def test_a_checkout_tells_its_revision_and_whether_files_differ(tmp_path: Path) -> None:
    git(tmp_path, "init")
    (tmp_path / "file").write_text("one")
    git(tmp_path, "add", "file")
    git(tmp_path, "commit", "-m", "first")
    git(tmp_path, "tag", "v9")
    revision = git(tmp_path, "rev-parse", "--short=12", "HEAD")
    assert _revision(tmp_path) == revision
    (tmp_path / "file").write_text("two")
    assert _revision(tmp_path) == f"{revision}-dirty"


def test_without_a_checkout_there_is_none(tmp_path: Path) -> None:
    assert _revision(tmp_path) == ""
    (tmp_path / ".git").mkdir()
    assert _revision(tmp_path) == "", "git cannot tell"


def test_an_installed_release_tells_what_it_was_made_from(tmp_path: Path) -> None:
    (tmp_path / "RELEASE").write_text("1a2b3c4d5e6f\n")
    assert _revision(tmp_path) == "1a2b3c4d5e6f"
