"""A controller that runs job files of the RC 5.0 language on the fake arm."""
