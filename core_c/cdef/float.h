/* Empty: cffi knows the standard types; this keeps the compiler's <float.h> out of the preprocessed contract. */
#define LACONIC_CDEF /* what cffi does not read is left out */
