/* Sequences of FMI calls, of both versions, as a target of libFuzzer: one process, with feedback. */
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);
const char *__asan_default_options(void);

/* Instances are taken and given back in each input, and memory is the sanitizer's most expensive part. What was freed
 * is held back until some dozen instances have been; then their memory is used again. */
const char *__asan_default_options(void) {
    return "max_malloc_fill_size=0:malloc_context_size=4:quarantine_size_mb=2:allocator_release_to_os_interval_ms=-1";
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    fuzz_one(bytes, size);
    return 0;
}
