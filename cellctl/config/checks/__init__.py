"""What one section of a cell file says, held against the others, its drivers, and common sense.

Every check yields ``ConfigIssue``; ``config/load.py`` calls them all and reports what they find
together. Those of ``plausible`` are asked by `cellctl check` alone.
"""
