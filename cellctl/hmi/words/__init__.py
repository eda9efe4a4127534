"""The languages of the page and of the API."""
