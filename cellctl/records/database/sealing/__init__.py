"""How the store shows that nothing of a run was changed: a chain of hashes over what is final.

``sealed`` names the rows and columns that may no longer change, ``canonical`` writes equal contents
as equal text, and ``ledger`` chains the hashes of both. Details of a run that is still open are
sealed as they are written: ``sealed_details``, by the running hash of ``written_details``.
"""
