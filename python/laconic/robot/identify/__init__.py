"""`laconic identify`: parameters of a scene from recorded runs, each with its interval."""
