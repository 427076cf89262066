/* Empty: cffi knows the standard types; this keeps the compiler's <stdint.h> out of the preprocessed contract. */
