"""Mutants of the C sources: one small fault each, which some C test must notice. `operators.py` makes them,
`programs.py` knows what the tests are linked of, `compiled.py` what a file is compiled to, `trial.py` tries one mutant,
`switches.py` many of a file at once, `campaign.py` those of a part, and `results.py` keeps what came out.
`equivalent.py` reads the list of those that nothing can notice, `alike.py` has the laws by which C reads two texts
alike, and `listed.py` says by both whether a fault is one of them, `same_code.py` whether it is compiled to the same;
`faults.py` reads those of another sampler."""

from laconic.mutation.campaign import Campaign, Tally
from laconic.mutation.compiled import Compiled
from laconic.mutation.equivalent import EQUIVALENTS, Equivalent, read_equivalents
from laconic.mutation.faults import Fault, read_faults
from laconic.mutation.listed import Listed
from laconic.mutation.operators import OPERATORS, Mutant, mutants_of
from laconic.mutation.same_code import SameCode

__all__ = ["EQUIVALENTS", "OPERATORS", "Campaign", "Compiled", "Equivalent", "Fault", "Listed", "Mutant", "SameCode",
           "Tally", "mutants_of", "read_equivalents", "read_faults"]
