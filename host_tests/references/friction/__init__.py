"""The friction step by other means: its convex problem, a conic solver polished to 30 digits, and its residual."""
