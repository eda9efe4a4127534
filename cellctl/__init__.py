"""cellctl: the core of the cell controller. Knows neither drivers nor fakes."""

import sys

# First of all, and in words that every Python 3 can parse: ``python -m cellctl`` begins here, and
# an older Python would otherwise end in the traceback of whatever import it fails at.
if sys.version_info < (3, 11):  # noqa: UP036 - the check is for those who run an older Python
    sys.exit("cellctl needs Python 3.11 or newer; this is Python {}.{}.".format(*sys.version_info))

from importlib.metadata import version

__version__ = version("cellctl")
