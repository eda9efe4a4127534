"""A bundle is installed as it was packed, by somebody whose signature counts, or not at all."""

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(
    shutil.which("ssh-keygen") is None, reason="signatures need ssh-keygen of OpenSSH"
)


def key(folder: Path, name: str) -> Path:
    path = folder / name
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", path], check=True)
    return path


def list_files(bundle: Path) -> None:
    """List the files as `make bundle` does."""
    command = "find . -type f -not -name 'SHA256SUMS*' -print0 | xargs -0 sha256sum > SHA256SUMS"
    subprocess.run(command, shell=True, cwd=bundle, check=True)


def sign(bundle: Path, signer: Path) -> None:
    command = f"ssh-keygen -q -Y sign -n cellctl-bundle -f {signer} {bundle / 'SHA256SUMS'}"
    (bundle / "SHA256SUMS.sig").unlink(missing_ok=True)
    subprocess.run(command.split(), check=True)


@pytest.fixture
def bundle(tmp_path: Path) -> Path:
    """One that is signed, with the least that the installation looks at before it builds."""
    folder = tmp_path / "cellctl-1.2.3-abc"
    (folder / "systemd").mkdir(parents=True)
    shutil.copy(ROOT / "systemd" / "install.sh", folder / "systemd")
    (folder / "pyproject.toml").write_text('version = "1.2.3"\n')
    (folder / "RELEASE").write_text("abc\n")
    (folder / "requirements.lock").write_text("a-package-of-nobody==1 --hash=sha256:00\n")
    signer = key(tmp_path, "signer")
    list_files(folder)
    sign(folder, signer)
    (tmp_path / "signers").write_text(f"cell@example {signer.with_suffix('.pub').read_text()}")
    return folder


def install(
    bundle: Path, signers: Path | str, python: Path | str = "python3"
) -> subprocess.CompletedProcess[str]:
    settings = {"PATH": "/usr/bin:/bin", "INTO": str(bundle.parent / "pc"), "PYTHON": str(python)}
    return subprocess.run(
        [bundle / "systemd" / "install.sh", "install"],
        env={**settings, "SIGNERS": str(signers), "PIP_NO_INDEX": "1"},
        capture_output=True,
        text=True,
        check=False,
    )


def changed_file(bundle: Path) -> None:
    (bundle / "RELEASE").write_text("abd\n")


def further_file(bundle: Path) -> None:
    (bundle / "systemd" / "more.sh").write_text("echo\n")


def another_list(bundle: Path) -> None:
    changed_file(bundle)
    list_files(bundle)


def signed_by_another(bundle: Path) -> None:
    sign(bundle, key(bundle.parent, "stranger"))


def unsigned(bundle: Path) -> None:
    (bundle / "SHA256SUMS.sig").unlink()


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (changed_file, "files of this bundle are not those that were packed"),
        (further_file, "the bundle has 5 files, its list 4"),
        (another_list, "the signature does not fit"),
        (signed_by_another, "nobody in"),
        (unsigned, "this bundle is not signed"),
    ],
)
def test_another_bundle_is_refused(bundle: Path, spoil: Callable[[Path], None], words: str) -> None:
    spoil(bundle)
    refused = install(bundle, bundle.parent / "signers")
    assert refused.returncode == 1
    assert words in refused.stderr
    assert not (bundle.parent / "pc").exists()


def test_without_a_list_of_signers_nobody_counts(bundle: Path) -> None:
    refused = install(bundle, bundle.parent / "nowhere")
    assert "that says whose signature counts" in refused.stderr


@pytest.mark.figures  # makes an environment
def test_one_that_is_whole_is_built(bundle: Path) -> None:
    """Up to its packages, which this one has not."""
    built = install(bundle, bundle.parent / "signers")
    assert "installing release 1.2.3-abc" in built.stdout
    assert "a-package-of-nobody" in built.stderr


def test_an_unsigned_one_is_built_where_that_is_said(bundle: Path) -> None:
    """Up to its environment, in which nothing would differ from that of a signed one."""
    unsigned(bundle)
    python = bundle.parent / "python"
    python.write_text(
        '#!/bin/sh\n[ "$1" != -m ] && exec python3 "$@"\necho makes no "$2" >&2\nexit 1\n'
    )
    python.chmod(0o755)
    built = install(bundle, "none", python)
    assert "installing release 1.2.3-abc" in built.stdout
    assert "makes no venv" in built.stderr
