"""How far the project is checked beyond its tests; run.py lists the parts."""
