"""The drawing of a part: its named holes, their kinds, and the file that lists them.

A kind of hole is one file with one class (``pin``, ``thread``, ``countersink``, ``disc``). It
states how such a hole looks; the search, the fit of the rim and the paper's method ask it instead
of comparing names. A further kind is a further file and one entry in ``kinds``.
"""
