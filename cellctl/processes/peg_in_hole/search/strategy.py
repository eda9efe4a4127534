"""The interface of a search strategy, and what it answers."""

from abc import ABC, abstractmethod
from typing import ClassVar

from cellctl.processes.peg_in_hole.plan.choice import SearchName
from cellctl.processes.peg_in_hole.search.probe import TouchProbe


class SearchStrategy(ABC):
    """One way to find a hole."""

    name: ClassVar[SearchName]

    @abstractmethod
    async def find(self, probe: TouchProbe) -> bool:
        """True when the peg has entered; False when everything was tried that it knows.

        Raises ``SearchGaveUp`` at the deadline.
        """
