/* Empty: cffi knows the standard types; this keeps the compiler's <stddef.h> out of the preprocessed contract. */
