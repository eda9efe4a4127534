"""The demonstration: fake cell, daemon and line PLC as processes, watched in a terminal.

What is shared is here: children and their end, the live view, the record, the verdict. What differs
from process to process is a ``Demo`` (``fakes.demo.demo``), found by its entry point in the group
``fakes.demo``; the deck is the first.
"""
