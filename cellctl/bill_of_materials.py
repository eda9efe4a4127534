"""Bill of materials and licences of a folder of wheels: `python -m cellctl.bill_of_materials`.

Made for the bundle that a PC without a network is installed from (`make bundle`). The bill follows
CycloneDX 1.6 (ECMA-424); package URLs and licences are those that each wheel states of itself.
"""

import hashlib
import json
import sys
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from email.message import Message
from email.parser import Parser
from pathlib import Path
from typing import Any

from cellctl import __version__

_LICENCE_FILES = ("LICENSE", "LICENCE", "COPYING", "NOTICE", "AUTHORS")
_CLASSIFIER = "License :: OSI Approved :: "


@dataclass(frozen=True, slots=True)
class Wheel:
    """What one wheel says of itself."""

    name: str
    version: str
    licence: str
    """SPDX expression where it states one, else its own words; empty when it says nothing."""
    is_expression: bool
    sha256: str
    texts: dict[str, str]
    """Licence files by their names."""


def read_wheel(path: Path) -> Wheel:
    """Read one wheel; raises ``ValueError`` for a file that is none."""
    try:
        with zipfile.ZipFile(path) as archive:
            # A wheel may carry others within a package of its own; those are part of it.
            files = [name for name in archive.namelist() if _is_about_itself(name)]
            (metadata,) = (name for name in files if name.endswith(".dist-info/METADATA"))
            head = Parser().parsestr(archive.read(metadata).decode("utf-8"))
            texts = {
                Path(name).name: archive.read(name).decode("utf-8", errors="replace")
                for name in files
                if Path(name).name.upper().startswith(_LICENCE_FILES)
            }
    except (zipfile.BadZipFile, ValueError) as error:
        raise ValueError(f"{path} is not a wheel: {error}") from error
    expression = str(head.get("License-Expression", "")).strip()
    return Wheel(
        name=str(head["Name"]),
        version=str(head["Version"]),
        licence=expression or _in_words(head),
        is_expression=bool(expression),
        sha256=hashlib.sha256(path.read_bytes()).hexdigest(),
        texts=texts,
    )


def bill(wheels: list[Wheel]) -> dict[str, Any]:
    """The CycloneDX document."""
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "version": 1,
        "metadata": {
            "component": {"type": "application", "name": "cellctl", "version": __version__}
        },
        "components": [_component(wheel) for wheel in wheels],
    }


def write(wheels: Path, folder: Path) -> None:
    """Write ``sbom.cdx.json`` and ``licences/`` of all wheels of a folder into another folder."""
    found = [read_wheel(path) for path in sorted(wheels.glob("*.whl"))]
    text = json.dumps(bill(found), indent=2)
    (folder / "sbom.cdx.json").write_text(f"{text}\n", encoding="utf-8")
    (folder / "licences").mkdir()
    for wheel in found:
        parts = (f"{wheel.name} {wheel.version}: {wheel.licence or 'says nothing'}", *_texts(wheel))
        (folder / "licences" / f"{wheel.name}.txt").write_text("\n".join(parts), encoding="utf-8")


def _component(wheel: Wheel) -> dict[str, Any]:
    component: dict[str, Any] = {
        "type": "library",
        "name": wheel.name,
        "version": wheel.version,
        "purl": f"pkg:pypi/{wheel.name.lower().replace('_', '-')}@{wheel.version}",
        "hashes": [{"alg": "SHA-256", "content": wheel.sha256}],
    }
    if wheel.is_expression:
        component["licenses"] = [{"expression": wheel.licence}]
    elif wheel.licence:
        component["licenses"] = [{"license": {"name": wheel.licence}}]
    return component


def _is_about_itself(name: str) -> bool:
    return Path(name).parts[0].endswith(".dist-info")


def _in_words(head: Message) -> str:
    """Of wheels older than PEP 639; some put the whole text where a name belongs."""
    classifiers = [str(one) for one in head.get_all("Classifier", [])]
    approved = [one.removeprefix(_CLASSIFIER) for one in classifiers if one.startswith(_CLASSIFIER)]
    if approved:
        return ", ".join(approved)
    return str(head.get("License", "")).strip().split("\n", maxsplit=1)[0]


def _texts(wheel: Wheel) -> Iterator[str]:
    for name, text in sorted(wheel.texts.items()):
        yield f"\n--- {name}\n{text}"


if __name__ == "__main__":
    write(Path(sys.argv[1]), Path(sys.argv[2]))
