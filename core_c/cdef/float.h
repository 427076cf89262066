/* Empty: cffi knows the standard types; this keeps the compiler's <float.h> out of the preprocessed contract. */
