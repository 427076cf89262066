"""Motions whose end is known in closed form after any number of steps."""
