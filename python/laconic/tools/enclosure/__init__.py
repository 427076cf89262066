"""Proved enclosures: the true motion of a scene in ball arithmetic, and how far the core's result is from it."""
