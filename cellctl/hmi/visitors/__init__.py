"""Who asks: persons, programs and places, what each of them may do, and how often.

``access`` finds out for each request; ``people`` knows secrets, ``sessions`` who has signed in,
``hosts`` by which name somebody came, and ``rates`` how often they may ask.
"""
