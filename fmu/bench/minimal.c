/* A minimal FMU: six first-order lags, checks of call order and references, references resolved by a switch. Its
 * cost is the least that the calls of FMI 2 and FMI 3 cost in any FMU that makes these checks. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

enum { INPUT_COUNT = 4, OUTPUT_COUNT = 6 };

typedef struct minimal {
    int stepping;
    double input[INPUT_COUNT], output[OUTPUT_COUNT], time;
} minimal;

void *minimal_create(void);
void minimal_destroy(void *instance);
int minimal_set(void *instance, const uint32_t *references, size_t count, const double *values, size_t value_count);
int minimal_get(void *instance, const uint32_t *references, size_t count, double *values, size_t value_count);
int minimal_step(void *instance, double at_s, double step_s);

void *minimal_create(void) {
    minimal *m = calloc(1, sizeof *m);
    if (m != NULL) m->stepping = 1;
    return m;
}

void minimal_destroy(void *instance) { free(instance); }

int minimal_set(void *instance, const uint32_t *references, size_t count, const double *values, size_t value_count) {
    minimal *m = instance;
    if (m == NULL || !m->stepping || references == NULL || values == NULL || value_count != count) return 3;
    for (size_t k = 0; k < count; k++) {
        switch (references[k]) {
        case 0: m->input[0] = values[k]; break;
        case 1: m->input[1] = values[k]; break;
        case 2: m->input[2] = values[k]; break;
        case 3: m->input[3] = values[k]; break;
        default: return 3;
        }
    }
    return 0;
}

int minimal_get(void *instance, const uint32_t *references, size_t count, double *values, size_t value_count) {
    minimal *m = instance;
    if (m == NULL || !m->stepping || references == NULL || values == NULL || value_count != count) return 3;
    for (size_t k = 0; k < count; k++) {
        switch (references[k]) {
        case 0: values[k] = m->output[0]; break;
        case 1: values[k] = m->output[1]; break;
        case 2: values[k] = m->output[2]; break;
        case 3: values[k] = m->output[3]; break;
        case 4: values[k] = m->output[4]; break;
        case 5: values[k] = m->output[5]; break;
        default: return 3;
        }
    }
    return 0;
}

int minimal_step(void *instance, double at_s, double step_s) {
    minimal *m = instance;
    if (m == NULL || !m->stepping || !(step_s > 0.0) || at_s < m->time - 0.5 * step_s) return 3;
    for (int k = 0; k < OUTPUT_COUNT; k++) m->output[k] += step_s * (m->input[k % INPUT_COUNT] - m->output[k]);
    m->time = at_s + step_s;
    return 0;
}
