"""Mutants of the C sources: one small fault each, which some C test must notice. `operators.py` makes them,
`programs.py` knows what the tests are linked of, `trial.py` tries one, `switches.py` many of a file at once,
`campaign.py` those of a part, `results.py` keeps what came out, and `equivalent.py` reads the list of those that
nothing can notice."""

from laconic.mutation.campaign import Campaign, Tally
from laconic.mutation.equivalent import EQUIVALENTS, Equivalent, read_equivalents
from laconic.mutation.operators import OPERATORS, Mutant, mutants_of

__all__ = ["EQUIVALENTS", "OPERATORS", "Campaign", "Equivalent", "Mutant", "Tally", "mutants_of", "read_equivalents"]
