"""Connectors in rendered images against truth.

- ``outcomes``: one image by the default and by the paper's method
- ``bench``: the rows B1 to B6
- ``timing``: B15
"""
