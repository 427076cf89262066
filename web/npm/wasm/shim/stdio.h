/* As much of it as core_c/tests/bits/trajectory_hash.c uses, for a module without a C library; hash.c has the
 * function. */
#ifndef LACONIC_SHIM_STDIO_H
#define LACONIC_SHIM_STDIO_H
int printf(const char *format, ...);
#endif
