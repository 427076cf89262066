"""Controllers that know nothing of us, unchanged, in front of a played vehicle on any board."""
