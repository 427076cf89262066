/* fmu_fuzz FILE…               replays those inputs
 * fmu_fuzz --seconds S --seed N --out FILE   random inputs for S seconds; when a sanitizer
 *                              ends the program, FILE holds the input that caused it
 * fmu_fuzz --inputs I …        so many, the same ones each time */
#define _POSIX_C_SOURCE 200809L
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fuzz.h"

enum { LARGEST = 6000 };
static uint8_t bytes[1 << 20];

static void replay(const char *name) {
    FILE *file = fopen(name, "rb");
    if (file == NULL) {
        fprintf(stderr, "fmu_fuzz: %s cannot be read\n", name);
        exit(2);
    }
    const size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    fuzz_one(bytes, size);
}

static uint64_t scramble(uint64_t *state) {
    uint64_t x = *state += 0x9E3779B97F4A7C15U;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9U;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBU;
    return x ^ (x >> 31);
}

/* The sanitizers call this before they end the program. */
void __sanitizer_set_death_callback(void (*callback)(void)) __attribute__((weak));

static const char *culprit_name;
static size_t culprit_size;

static void keep_culprit(void) {
    FILE *file = culprit_name != NULL ? fopen(culprit_name, "wb") : NULL;
    if (file == NULL) return;
    fwrite(bytes, 1, culprit_size, file);
    fclose(file);
}

static unsigned long soak(double seconds, unsigned long inputs, uint64_t seed) {
    const time_t end = time(NULL) + (time_t)seconds;
    unsigned long played = 0;
    do {
        uint64_t state = seed + played;
        const size_t size = 200 + scramble(&state) % (LARGEST - 200);
        for (size_t k = 0; k < size; k++) bytes[k] = (uint8_t)(scramble(&state) >> 24);
        culprit_size = size;
        fuzz_one(bytes, size);
        played++;
    } while (inputs > 0 ? played < inputs : time(NULL) < end);
    return played;
}

int main(int argc, char **argv) {
    double seconds = 0.0;
    unsigned long inputs = 0;
    uint64_t seed = 1;
    for (int k = 1; k < argc; k++) {
        if (strcmp(argv[k], "--seconds") == 0 && k + 1 < argc)
            seconds = atof(argv[++k]);
        else if (strcmp(argv[k], "--inputs") == 0 && k + 1 < argc)
            inputs = strtoul(argv[++k], NULL, 10);
        else if (strcmp(argv[k], "--seed") == 0 && k + 1 < argc)
            seed = strtoull(argv[++k], NULL, 10);
        else if (strcmp(argv[k], "--out") == 0 && k + 1 < argc)
            culprit_name = argv[++k];
        else
            replay(argv[k]);
    }
    if (__sanitizer_set_death_callback != NULL) __sanitizer_set_death_callback(keep_culprit);
    if (seconds > 0.0 || inputs > 0) printf("%lu\n", soak(seconds, inputs, seed));
    return 0;
}
