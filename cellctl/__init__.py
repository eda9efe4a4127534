"""cellctl: the core of the cell controller. Knows neither drivers nor fakes."""

from importlib.metadata import version

__version__ = version("cellctl")
