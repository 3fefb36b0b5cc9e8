"""The circuit as a picture."""
