"""Mutants of the C sources: one small fault each, which some C test must notice. `operators.py` makes them,
`programs.py` knows what the tests are linked of, `trial.py` tries one, `switches.py` many of a file at once,
`campaign.py` those of a part, and `results.py` keeps what came out. `equivalent.py` reads the list of those that
nothing can notice, `alike.py` has the laws by which C reads two texts alike, and `listed.py` says by both whether a
fault is one of them; `faults.py` reads those of another sampler."""

from laconic.mutation.campaign import Campaign, Tally
from laconic.mutation.equivalent import EQUIVALENTS, Equivalent, read_equivalents
from laconic.mutation.faults import Fault, read_faults
from laconic.mutation.listed import Listed
from laconic.mutation.operators import OPERATORS, Mutant, mutants_of

__all__ = ["EQUIVALENTS", "OPERATORS", "Campaign", "Equivalent", "Fault", "Listed", "Mutant", "Tally", "mutants_of",
           "read_equivalents", "read_faults"]
