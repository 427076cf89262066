/* Empty: cffi knows the standard types; this keeps the compiler's <stdbool.h> out of the preprocessed contract. */
