"""Computing a run anew from its record: what was recorded beside what comes out today.

``recorded_run`` gives whoever computes the files, images and inputs of a run; ``replayed`` holds
one number against the other, ``procedure_result`` the whole result of a procedure.
"""
