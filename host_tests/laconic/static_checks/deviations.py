"""Rules of MISRA C:2012 that the project's C deviates from, each with its reason; every other rule has no violation."""

from __future__ import annotations

from dataclasses import dataclass

ANY = -1  # a matter of style or of the tool: places are counted, and have no limit


@dataclass(frozen=True)
class Deviation:
    """`most`: in which part, and in how many places at most; ANY: without a limit."""

    category: str  # of the rule: Advisory or Required; Mandatory rules are not deviated from
    reason: str
    most: dict[str, int]


def everywhere(category: str, reason: str) -> Deviation:
    """Of all parts, without a limit."""
    return Deviation(category, reason, {"core": ANY, "node": ANY, "FMU": ANY})


def counted(category: str, reason: str, **most: int) -> Deviation:
    """Of the named parts, in so many places at most."""
    return Deviation(category, reason, dict(most))


A, R = "Advisory", "Required"
DEVIATIONS = {
    "2.3": counted(A, "types whose size the compiler checks (an array type of length −1 does not compile), and "
                      "types that one build of several uses", FMU=8),
    "2.4": everywhere(A, "a tag equals its typedef's name, so that debuggers and other languages show it"),
    "2.5": everywhere(A, "a header's macros are for whoever includes it; not every file uses each"),
    "5.5": counted(R, "FMI's own headers give their functions a prefix by macros", FMU=200),
    "5.7": everywhere(R, "a tag equals its typedef's name (2.4); beside that a function's name equals a tag of "
                         "another file"),
    "5.9": everywhere(A, "names of static functions differ over the core, which is also compiled as one file (a "
                         "test holds it); elsewhere small helpers of different files may share a name"),
    "7.2": counted(R, "UINT64_C gives the suffix; the addon does not look into it", core=4),
    "8.5": everywhere(R, "declared once in a header; the addon counts each file that includes it"),
    "8.7": everywhere(A, "methods and functions that another library, a test or a table links from outside of "
                         "what is looked at"),
    "8.9": everywhere(A, "a table stands beside the others of its kind, before the functions of its subject"),
    "8.11": counted(A, "arrays of generated tables, whose count is declared beside them", FMU=3),
    "8.14": counted(R, "restrict on what a pass of the solver alone points to: its numbers stay in registers",
                    core=12),
    "9.2": counted(R, "structs and arrays within structs are filled in order where the type makes plain what is "
                      "meant", core=12, FMU=4),
    "9.3": everywhere(R, "{0} and ALL_ZERO set everything to zero; of other arrays the rest is zero and says so"),
    "10.1": everywhere(R, "bitwise operators between flags as a condition, shifts by a constant of a checked unsigned "
                          "type, sums of verdicts as 0 or 1"),
    "10.3": everywhere(R, "a number of bits or items that fits the narrower type by what was checked before"),
    "10.4": everywhere(R, "int and int32_t, enumerations and their numbers meet; the compilers' -Wconversion and "
                          "-Wsign-conversion are errors"),
    "10.6": everywhere(R, "the composite expression cannot exceed the narrower type: both are bounded by "
                          "constants"),
    "10.7": counted(R, "products in 32 bits of what fits 32 bits, used in 64", node=2, FMU=6),
    "10.8": everywhere(R, "casts of a whole expression say in which type its result is meant"),
    "11.1": counted(R, "callbacks are kept as the type that FMI gives them", FMU=8),
    "11.5": everywhere(A, "void pointers carry what memory is made of: offsets into a vehicle by its table, and "
                          "FMI's instances"),
    "12.1": everywhere(A, "* before +, && before ||, and comparison before both, as physicists write; compilers "
                          "warn of all others (-Wparentheses)"),
    "12.3": everywhere(A, "declarations of several numbers of one kind on one line, such as x_m, y_m"),
    "13.3": everywhere(A, "*to++ = … fills what is packed"),
    "13.4": everywhere(A, "one value given to two names: a = b = …"),
    "14.1": counted(R, "a loop scales a number by 4 or 16, exactly, until it is near 1, where every number "
                       "comes to", core=2),
    "14.2": everywhere(R, "a loop over text moves on by a place's length inside of its body"),
    "14.4": everywhere(R, "flags & BIT and counts as conditions"),
    "15.5": everywhere(A, "a function ends where its answer is known: each refusal is one line, and nothing is "
                          "nested"),
    "15.6": everywhere(R, "a single statement needs no braces; the layout is clang-format's, and -Wmisleading- "
                          "indentation is an error"),
    "15.7": everywhere(R, "an else that does nothing is not written"),
    "17.1": counted(R, "one function takes the arguments of printf, for log messages of FMI", FMU=10),
    "17.2": counted(R, "outputs of which one group needs another: the call goes one level deep", FMU=4),
    "17.7": everywhere(R, "what memcpy and functions that return their last argument or a place say is not "
                          "always needed"),
    "17.8": everywhere(A, "a parameter by value is the function's own; it moves on as text and counts are read"),
    "18.4": everywhere(A, "text + 2, in place of &text[2], for parts of frames"),
    "19.2": counted(A, "the bits of a number, for a first guess of its root", core=2),
    "20.1": counted(A, "a header that cffi reads includes what it needs behind its own declarations", node=10),
    "20.4": counted(R, "restrict is __restrict in C++, of which the core is a part, too", core=1),
    "20.7": everywhere(R, "macros of rows, whose arguments are names and types, in which parentheses are no C"),
    "20.10": everywhere(A, "rows of fields make names: LACONIC_FIELD_ and the identifier"),
    "21.3": counted(R, "FMI lets a host make instances; the core and the node have no heap", FMU=10),
    "21.6": counted(R, "text of log messages, and the file of start values; the core and the node use no stdio", FMU=6),
}
