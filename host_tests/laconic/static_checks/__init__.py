"""What tools find without running anything: MISRA C:2012 by cppcheck's addon, clang-tidy, and proofs by Frama-C."""
