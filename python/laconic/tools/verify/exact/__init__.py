"""Steps and motions in 50 digits, from the equations alone: they share no code with the core."""
