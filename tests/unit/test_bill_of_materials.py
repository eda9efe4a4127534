"""The bill of a bundle names every wheel, with what it says of its licence."""

import hashlib
import json
import zipfile
from pathlib import Path

import pytest

from cellctl.bill_of_materials import read_wheel, write

EXPRESSION = "License-Expression: MIT OR Apache-2.0\n"
CLASSIFIER = "License: the whole text\nClassifier: License :: OSI Approved :: BSD License\n"
WORDS = "License: PSF-2.0\n with more lines\n"


def wheel(folder: Path, name: str, licence: str, **files: str) -> Path:
    path = folder / f"{name}-1.0-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as archive:
        head = f"Metadata-Version: 2.4\nName: {name}\nVersion: 1.0\n{licence}"
        archive.writestr(f"{name}-1.0.dist-info/METADATA", head)
        for file, text in files.items():
            archive.writestr(f"{name}-1.0.dist-info/licenses/{file}", text)
    return path


@pytest.mark.parametrize(
    ("licence", "said"),
    [
        (EXPRESSION, [{"expression": "MIT OR Apache-2.0"}]),
        (CLASSIFIER, [{"license": {"name": "BSD License"}}]),
        (WORDS, [{"license": {"name": "PSF-2.0"}}]),
        ("", None),
    ],
)
def test_a_component(tmp_path: Path, licence: str, said: object) -> None:
    path = wheel(tmp_path, "some_package", licence, LICENSE="You may.")
    (tmp_path / "out").mkdir()
    write(tmp_path, tmp_path / "out")
    bill = json.loads((tmp_path / "out" / "sbom.cdx.json").read_text())
    (component,) = bill["components"]
    assert component["purl"] == "pkg:pypi/some-package@1.0"
    assert component["hashes"][0]["content"] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert component.get("licenses") == said
    text = (tmp_path / "out" / "licences" / "some_package.txt").read_text()
    assert "You may." in text
    assert text.startswith("some_package 1.0: ")


def test_wheels_within_a_wheel_are_part_of_it(tmp_path: Path) -> None:
    path = wheel(tmp_path, "outer", EXPRESSION)
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr(
            "outer/_vendor/inner-2.0.dist-info/METADATA", "Name: inner\nVersion: 2.0\n"
        )
    assert read_wheel(path).name == "outer"


def test_what_is_no_wheel_is_named(tmp_path: Path) -> None:
    path = tmp_path / "broken.whl"
    path.write_bytes(b"PK")
    with pytest.raises(ValueError, match=r"broken\.whl is not a wheel"):
        read_wheel(path)
