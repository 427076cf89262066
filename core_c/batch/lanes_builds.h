/* Which widths a build has: none where coverage is measured, which counts the methods' text once. */
#ifndef LACONIC_LANES_BUILDS_H
#define LACONIC_LANES_BUILDS_H

#if defined(__GNUC__) && !defined(LACONIC_PLAIN_INLINE)
#define LANES_OF_16
#ifdef __x86_64__
#define LANES_OF_32
#define LANES_OF_64
#endif
#endif

typedef int lanes_builds; /* a file whose width a build lacks would be empty, which C forbids */

#endif
