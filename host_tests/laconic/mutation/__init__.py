"""Mutants of the C sources: one small fault each, which some C test must notice. `operators.py` makes them,
`programs.py` knows what the tests are linked of, `trial.py` tries one, `campaign.py` many, and `results.py` keeps what
came out."""

from laconic.mutation.campaign import Campaign, Tally
from laconic.mutation.operators import OPERATORS, Mutant, mutants_of
from laconic.mutation.results import EQUIVALENTS, Equivalent, read_equivalents

__all__ = ["EQUIVALENTS", "OPERATORS", "Campaign", "Equivalent", "Mutant", "Tally", "mutants_of", "read_equivalents"]
