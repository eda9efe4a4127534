"""What the API answers, as models: they make the answers, and the document describes them.

Older answers, of which the page was the only reader, are plain objects in their routes.
"""
