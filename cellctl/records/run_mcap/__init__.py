"""A run as one MCAP file for Foxglove and other viewers.

``export`` composes it from what the record of the run holds, when somebody asks for it: nothing is
done for it while the cell works, and the record itself stays what counts. Each module brings one
sort of messages; ``topics`` lists all topics with their units and frames.
"""
