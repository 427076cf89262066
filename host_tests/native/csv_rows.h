#ifndef LACONIC_CSV_ROWS_H
#define LACONIC_CSV_ROWS_H

#include <stddef.h>
#include <stdint.h>

#define LACONIC_CSV_NUMBER 25 /* characters that a number takes at most, with what separates it from the next */

/* Writes `rows` lines of `columns` numbers; returns how many characters. `text` has room for LACONIC_CSV_NUMBER a
 * number. `powers`: 10^k for k = -292 … 324 as 128 bits, rounded up, the highest set; the upper half first. */
size_t laconic_csv_rows(char *text, const double *numbers, size_t rows, size_t columns, const uint64_t *powers);

#endif
