"""The base of a robot in a large-field head, from turning its first two axes."""
