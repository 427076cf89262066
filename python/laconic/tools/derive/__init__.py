"""The paper's method: laconic equations of motion of systems with linear constraints, in SymPy.

`equations` holds the three forms (2.3), (2.4) and Maggi's (1.2); `brackets` the paper's section 6 shortcut
(a further constraint by linearity of the brackets); `vehicles` what they are worked for; `scene_system` goes
from a scene's vehicle to its equations; `printing` writes them as LaTeX or C.
"""

from laconic.tools.derive.brackets import Bracketed, bracketed, impose
from laconic.tools.derive.equations import System, laconic_2_3, laconic_2_4, maggi

__all__ = ["Bracketed", "System", "bracketed", "impose", "laconic_2_3", "laconic_2_4", "maggi"]
