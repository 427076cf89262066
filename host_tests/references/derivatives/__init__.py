"""Independent derivatives of a step: every method's map in 50 digits, and its differences."""
