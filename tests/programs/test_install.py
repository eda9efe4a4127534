"""`make install` and `make rollback`, into a folder that stands for the PC."""

import os
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from cellctl import __version__
from cellctl.records.database.schema_version import SCHEMA_VERSION
from tests.rigs.sweeps import sweep

ROOT = Path(__file__).parents[2]
STORE = "var/lib/cellctl/store.sqlite"


def make(target: str, into: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    settings = [f"{name}={value}" for name, value in variables.items()]
    return subprocess.run(
        ["make", "--no-print-directory", target, f"INTO={into}", *settings],
        cwd=ROOT,
        check=False,
        capture_output=True,
        text=True,
        # What an outer make has set for its own tests is left out.
        env={name: value for name, value in os.environ.items() if not name.startswith("MAKE")},
    )


@pytest.fixture
def upgraded(tmp_path: Path) -> Path:
    """A PC with two releases, whose programs are those of this very environment."""
    releases = tmp_path / "opt/cellctl/releases"
    for name in ("old", "new"):
        (releases / name).mkdir(parents=True)
        (releases / name / ".venv").symlink_to(Path(sys.prefix))
        for folder in ("systemd", "config"):
            (releases / name / folder).symlink_to(ROOT / folder)
    (tmp_path / "opt/cellctl/current").symlink_to("releases/new")
    (tmp_path / "opt/cellctl/previous").symlink_to("releases/old")
    (tmp_path / STORE).parent.mkdir(parents=True)
    return tmp_path


def write_store(path: Path, form: int) -> None:
    with sqlite3.connect(path) as store:
        store.execute(f"PRAGMA user_version = {form}")
    store.close()


def form_of(path: Path) -> int:
    with sqlite3.connect(path) as store:
        form: int = store.execute("PRAGMA user_version").fetchone()[0]
    store.close()
    return form


def current(pc: Path) -> str:
    return os.readlink(pc / "opt/cellctl/current")


def test_one_command_goes_back_and_another_forth(upgraded: Path) -> None:
    write_store(upgraded / STORE, SCHEMA_VERSION)
    cell_file = upgraded / "etc/cellctl/cell.toml"
    cell_file.parent.mkdir(parents=True)
    cell_file.write_text("# of this cell")
    for expected in ("releases/old", "releases/new"):
        done = make("rollback", upgraded)
        assert done.returncode == 0, done.stderr
        assert current(upgraded) == expected
    assert form_of(upgraded / STORE) == SCHEMA_VERSION
    assert cell_file.read_text() == "# of this cell"
    unit = (upgraded / "etc/systemd/system/cellctl.service").read_text()
    assert f"ExecStart={upgraded}/opt/cellctl/current/.venv/bin/cellctl run" in unit
    assert (upgraded / "usr/share/man/man1/cellctl.1").read_text().startswith(".TH CELLCTL 1")
    completion = upgraded / "usr/share/bash-completion/completions/cellctl"
    assert "complete -o default -F _cellctl_completion cellctl" in completion.read_text()
    for program in ("cellctl", "cellctl-hmi"):
        assert (upgraded / "usr/local/bin" / program).exists()


@pytest.mark.parametrize("before", sweep(("releases/old", "releases/of-nobody"), ("releases/old",)))
def test_an_installation_ends_at_the_release_that_it_has_made(
    upgraded: Path, tmp_path_factory: pytest.TempPathFactory, before: str
) -> None:
    """With its packages there already, for these take minutes."""
    source = tmp_path_factory.mktemp("source")
    for part in ("systemd", "config", "pyproject.toml"):
        (source / part).symlink_to(ROOT / part)
    (source / "RELEASE").write_text("newest\n")
    releases = upgraded / "opt/cellctl/releases"
    (releases / "new").rename(releases / f"{__version__}-newest")
    (releases / f"{__version__}-newest/.complete").touch()
    point = upgraded / "opt/cellctl/current"
    if before == "releases/old":
        (upgraded / "opt/cellctl/previous").unlink()
    point.unlink()
    point.symlink_to(before)
    done = subprocess.run(
        ["sh", source / "systemd/install.sh", "install"],
        check=False,
        capture_output=True,
        text=True,
        env=os.environ | {"INTO": str(upgraded), "PYTHON": sys.executable},
    )
    assert done.returncode == 0, done.stderr
    assert f"installed {__version__}-newest. Next:" in done.stdout
    assert current(upgraded) == f"releases/{__version__}-newest"
    # A point to nothing says nothing of a release before.
    assert os.readlink(upgraded / "opt/cellctl/previous") == "releases/old"
    assert (upgraded / "usr/local/bin/cellctl").resolve().exists()


def test_a_store_that_the_older_release_cannot_read_is_not_left_to_it(upgraded: Path) -> None:
    store = upgraded / STORE
    write_store(store, SCHEMA_VERSION + 1)
    refused = make("rollback", upgraded)
    assert refused.returncode != 0
    assert "cannot read this run store" in refused.stderr
    assert "is not there" in refused.stderr
    write_store(store.with_name(f"store-schema-{SCHEMA_VERSION}.sqlite"), SCHEMA_VERSION)
    refused = make("rollback", upgraded)
    assert refused.returncode != 0
    assert "STORE=back" in refused.stderr
    assert current(upgraded) == "releases/new"
    assert form_of(store) == SCHEMA_VERSION + 1


def test_the_store_of_the_newer_release_is_set_aside_on_demand(upgraded: Path) -> None:
    store = upgraded / STORE
    write_store(store, SCHEMA_VERSION + 1)
    write_store(store.with_name(f"store-schema-{SCHEMA_VERSION}.sqlite"), SCHEMA_VERSION)
    done = make("rollback", upgraded, STORE="back")
    assert done.returncode == 0, done.stderr
    assert current(upgraded) == "releases/old"
    assert form_of(store) == SCHEMA_VERSION
    (aside,) = store.parent.glob("set-aside-*/store.sqlite")
    assert form_of(aside) == SCHEMA_VERSION + 1


def test_without_a_release_before_nothing_goes_back(tmp_path: Path) -> None:
    refused = make("rollback", tmp_path)
    assert refused.returncode != 0
    assert "there is no release before this one" in refused.stderr


def test_an_interpreter_that_is_not_there(tmp_path: Path) -> None:
    refused = make("install", tmp_path, PYTHON="python-of-nobody")
    assert refused.returncode != 0
    assert "there is no interpreter python-of-nobody" in refused.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.long  # downloads and unpacks every package of the lock file
@pytest.mark.timeout(600)
def test_a_whole_installation(tmp_path: Path) -> None:
    done = make("install", tmp_path, PYTHON=sys.executable)
    assert done.returncode == 0, done.stderr
    program = tmp_path / "usr/local/bin/cellctl"
    release = os.readlink(tmp_path / "opt/cellctl/current").removeprefix("releases/")
    said = (tmp_path / "opt/cellctl/current/RELEASE").read_text().strip()
    assert release == f"{__version__}-{said}"
    cell_file = tmp_path / "etc/cellctl/cell.toml"
    checked = subprocess.run(
        [program, "check", cell_file], capture_output=True, text=True, check=False
    )
    # The template says itself what is to be filled in, and finds its drawings beside it.
    assert "= FILL IN (mark of the template)" in checked.stdout
    assert "features" not in checked.stdout
    again = make("install", tmp_path, PYTHON=sys.executable)
    assert again.returncode == 0, again.stderr
    assert not (tmp_path / "opt/cellctl/previous").exists()
