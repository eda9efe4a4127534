"""The files that say what a run was made with; the hashes in its record are theirs."""

import json
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from cellctl.config import CellConfig
from cellctl.config.recipe import Recipe
from cellctl.errors.vision import FeatureFileInvalid
from cellctl.records.files.artefacts import CELL_FILE


@dataclass(frozen=True, slots=True)
class Provenance:
    """Files for the record of a run."""

    cell: bytes
    """The whole cell file as it was understood, defaults included."""
    recipe: bytes
    """The recipe likewise, with the SHA-256 of its files."""
    files: dict[str, bytes]
    """The files of the recipe as they are, by the name of their artefact."""

    @property
    def cell_hash(self) -> str:
        """SHA-256 of the cell file's content, independent of its layout."""
        return sha256(self.cell).hexdigest()

    @property
    def recipe_hash(self) -> str:
        """SHA-256 of the recipe with the content of its files."""
        return sha256(self.recipe).hexdigest()

    def require_same_files(self, before: "Provenance") -> None:
        """Raise ``FeatureFileInvalid`` for files of the recipe that differ from those of before."""
        if changed := sorted(dict(self.files.items() ^ before.files.items())):
            raise FeatureFileInvalid(f"{', '.join(changed)}: changed while the run was prepared")

    def artefacts(self) -> list[tuple[str, bytes, str]]:
        """Name, bytes and media type of each file."""
        return [
            (CELL_FILE, self.cell, "application/json"),
            ("recipe.json", self.recipe, "application/json"),
            *((name, data, "application/toml") for name, data in self.files.items()),
        ]


def provenance(config: CellConfig, folder: Path, recipe: Recipe) -> Provenance:
    """The files behind a run with a recipe; ``folder`` holds the cell file.

    Raises ``FeatureFileInvalid``.
    """
    files = {name: _read(folder / path) for name, path in recipe.files().items()}
    hashes = {name: sha256(data).hexdigest() for name, data in files.items()}
    return Provenance(
        cell=_canonical(config.model_dump(mode="json")),
        recipe=_canonical({"recipe": recipe.model_dump(mode="json"), "sha256": hashes}),
        files=files,
    )


def cell_artefact(config: CellConfig) -> tuple[str, bytes, str]:
    """The cell file alone, for the record of a run that has no recipe."""
    return CELL_FILE, _canonical(config.model_dump(mode="json")), "application/json"


def _canonical(document: dict[str, Any]) -> bytes:
    # Sorted, so that the hash depends on the content alone and not on the order in which the file
    # was written.
    return json.dumps(document, sort_keys=True, indent=1).encode()


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise FeatureFileInvalid(f"{path}: {error.strerror or error}") from error
