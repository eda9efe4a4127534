"""Commands that plan, teach and judge from files, without a cell.

- ``trial_file``: the looks and figures of one plugging; ``teach_file``, ``turn_file`` likewise
- ``commands``: what the entry points name
"""
