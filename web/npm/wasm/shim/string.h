/* As much of it as core_c/tests/bits/trajectory_hash.c uses: WebAssembly has instructions for both. */
#ifndef LACONIC_SHIM_STRING_H
#define LACONIC_SHIM_STRING_H
#define memcpy __builtin_memcpy
#define memset __builtin_memset
#endif
