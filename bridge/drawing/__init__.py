"""Shared means of drawing: canvas, colours, inline HTML, a picture and its table."""
