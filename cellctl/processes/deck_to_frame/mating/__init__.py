"""The force-limited mating: from the stand-off to a judged seat (paper 2.4.2).

``mate`` runs one attempt through the ``phases``: tare, fast travel while clear, slow travel to the
touch, creep to the force (``seating``), hold, judge, relax. ``plan`` derives speeds and windows
before anything moves; ``retreat`` decides what follows a violation; ``comply`` gives way to pins.
"""
