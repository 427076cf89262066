/* Which widths a build has: the narrowest alone where coverage is measured, for which that is enough. */
#ifndef LACONIC_LANES_BUILDS_H
#define LACONIC_LANES_BUILDS_H

#ifdef __GNUC__
#define LANES_OF_16
#if defined(__x86_64__) && !defined(LACONIC_PLAIN_INLINE)
#define LANES_OF_32
#define LANES_OF_64
#endif
#endif

typedef int lanes_builds; /* a file whose width a build lacks would be empty, which C forbids */

#endif
