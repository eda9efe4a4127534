"""The part of a process that a cell file needs: models of its keys, its roles, its checks."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from cellctl import plugins
from cellctl.config.base import Section
from cellctl.config.cell import CellConfig
from cellctl.config.issue import ConfigIssue
from cellctl.config.model_file import StatedModel
from cellctl.config.recipe import Recipe
from cellctl.config.roles import Role
from cellctl.config.stated.moves import StatedMove
from cellctl.errors.config import UnknownDriver

if TYPE_CHECKING:
    from cellctl.config.stated.views import StatedMeasurement


class NoSettings(Section):
    """Settings of a process that has none."""


class ProcessDefinition(ABC):
    """The static half of a process; ``cellctl.runtime.process.Process`` adds what it does."""

    name: ClassVar[str]
    """Name in the cell file and of the entry point, for example ``deck-to-frame``."""
    recipe_model: ClassVar[type[Recipe]]
    """Keys of its ``[[recipes]]``."""
    settings_model: ClassVar[type[Section]] = NoSettings
    """Keys of ``[processes.NAME]``: what holds for all recipes of the process."""
    roles: ClassVar[Mapping[str, Role]]
    stores: ClassVar[tuple[str, ...]] = ()
    """Names of its calibrations, those of each recipe without their number: by them a folder of
    calibrations is known as that of another cell. Here, because who reads a cell file loads no
    solver; empty where the process stores none, or does not say."""

    @classmethod
    @abstractmethod
    def check(
        cls, cell: CellConfig, recipe: Recipe, key: str, folder: Path
    ) -> Iterable[ConfigIssue]:
        """Everything else that is wrong with a recipe in this cell; touches no hardware.

        Called when the cell has a device for every role and nothing is wrong with it. ``key`` is
        the recipe's place in the file, for example ``recipes.0``; ``folder`` is that of the cell
        file.
        """

    @classmethod
    def check_plausible(
        cls,
        cell: CellConfig,  # noqa: ARG003
        recipe: Recipe,  # noqa: ARG003
        key: str,  # noqa: ARG003
        folder: Path,  # noqa: ARG003
    ) -> Iterable[ConfigIssue]:
        """What could be meant as it stands, and in all likelihood is a slip; by default nothing.

        Asked by ``cellctl check`` alone, after ``check`` has found nothing: a daemon takes it.
        """
        return ()

    @classmethod
    def check_placed(
        cls,
        cell: CellConfig,  # noqa: ARG003
        recipe: Recipe,  # noqa: ARG003
        key: str,  # noqa: ARG003
        folder: Path,  # noqa: ARG003
        bases: Mapping[str, Sequence[float]],  # noqa: ARG003
    ) -> Iterable[ConfigIssue]:
        """The same for what depends on where the arms stand, as whether a camera sees its part.

        ``bases`` holds ``cell_T_base`` in its written form by robot, as the model of the cell has
        it; empty where there is no model. Asked after ``check_plausible`` has found nothing.
        """
        return ()

    @classmethod
    def check_model(
        cls,
        cell: CellConfig,  # noqa: ARG003
        recipe: Recipe,  # noqa: ARG003
        key: str,  # noqa: ARG003
        model: StatedModel,  # noqa: ARG003
    ) -> Iterable[ConfigIssue]:
        """Bodies of the model that contradict a recipe, so that planning would answer for another
        cell; by default nothing.

        Asked by ``cellctl check`` after ``check_placed`` has found nothing, and by planning.
        """
        return ()

    @classmethod
    def remarks(
        cls,
        cell: CellConfig,  # noqa: ARG003
        recipe: Recipe,  # noqa: ARG003
        key: str,  # noqa: ARG003
        folder: Path,  # noqa: ARG003
    ) -> Iterable[ConfigIssue]:
        """What may well be meant as it stands and is worth a second look; by default nothing.

        Shown by ``cellctl check`` beside a file that is good.
        """
        return ()

    @classmethod
    def not_yet_checked(
        cls,
        cell: CellConfig,  # noqa: ARG003
        recipe: Recipe,  # noqa: ARG003
        folder: Path,  # noqa: ARG003
    ) -> Iterable[str]:
        """What nothing in a good file contradicts before a calibration is stored; by default
        nothing. Each is a line of ``cellctl check``.
        """
        return ()

    @classmethod
    def moves(
        cls,
        cell: CellConfig,  # noqa: ARG003
        recipe: Recipe,  # noqa: ARG003
        folder: Path,  # noqa: ARG003
    ) -> Iterable[StatedMove]:
        """Every move that the process can command with a recipe, from every place where it begins.

        Asked by offline planning alone, with a cell file that was checked; by default none. Raises
        ``ArmNotDescribed`` where the kinematics of an arm are needed and not known.
        """
        return ()

    @classmethod
    def measurements(
        cls,
        cell: CellConfig,  # noqa: ARG003
        recipe: Recipe,  # noqa: ARG003
        folder: Path,  # noqa: ARG003
    ) -> "Iterable[StatedMeasurement]":
        """What the process measures with heads that arms carry; by default nothing.

        Asked by offline planning alone, with a cell file that was checked. Raises
        ``HeadNotDescribed`` where a head is not calibrated or not mounted.
        """
        return ()


def process_definition(name: str) -> type[ProcessDefinition]:
    """The process of this name; raises ``UnknownDriver`` when it is not installed."""
    found = plugins.load(plugins.PROCESS, name)
    if not issubclass(found, ProcessDefinition):
        raise UnknownDriver(f"{plugins.PROCESS} '{name}' is not a Process")
    return found


def installed_processes() -> list[str]:
    """Names of the processes that could be named by a recipe."""
    return plugins.names(plugins.PROCESS)
