"""Many made-up vehicles beside their true motion: errors of a method over all of them, and the worst as a scene."""
