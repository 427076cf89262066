/* The values an instance starts with.
 *
 * An FMU of the build carries them in its code. One that `laconic fmu` makes for a scene has all of them in
 * resources/start.bin and uses none of the build's, so wheels that its scene lacks stay unset. The file: "LACSTART",
 * then numbers of 64 bits, little-endian: version, scalar, hash of the token, count, and for each value its
 * reference and its bits as a double; at the end the checksum of all before. More pairs are a model's own. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "model_interface.h"

#define FILE_VERSION 2U
#define HEADER_NUMBERS 4U
#define LARGEST_FILE 65536U
static const char magic[8] = {'L', 'A', 'C', 'S', 'T', 'A', 'R', 'T'};

static void apply(fmu_instance *instance, const fmu_start_value *values, size_t count) {
    for (size_t k = 0; k < count; k++) fmu_set_start_value(instance, values[k].reference, values[k].value);
}

uint64_t fmu_token_hash(const char *token) {
    uint64_t hash = 0xCBF29CE484222325U; /* FNV-1a */
    for (; *token != '\0'; token++) hash = (hash ^ (uint8_t)*token) * 0x100000001B3U;
    return hash;
}

static int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

/* The case of a scheme's letters does not matter (RFC 3986). */
static bool is_file_uri(const char *text) {
    static const char lower[] = "file:", upper[] = "FILE:";
    for (size_t k = 0; k < sizeof lower - 1; k++)
        if (text[k] != lower[k] && text[k] != upper[k]) return false;
    return true;
}

/* A URI of the scheme "file" (with %20 for a blank) or a path → the path with "/start.bin". False iff it does not fit,
 * or %00 would end it. */
static bool file_name(char *name, size_t size, const char *resources) {
    static const char tail[] = "/start.bin";
    size_t used = 0;
    bool uri = false;
    if (is_file_uri(resources)) {
        uri = true;
        resources += 5;
        if (strncmp(resources, "//", 2) == 0) {
            resources = strchr(resources + 2, '/'); /* past the host, which is empty or localhost */
            if (resources == NULL) return false;
        }
        if (resources[0] == '/' && resources[1] != '\0' && resources[2] == ':') resources++; /* /C:/… */
    }
    for (; *resources != '\0' && used + sizeof tail < size; resources++) {
        const int high = uri && *resources == '%' ? hex_digit(resources[1]) : -1;
        const int low = high >= 0 ? hex_digit(resources[2]) : -1;
        if (high == 0 && low == 0) return false;
        name[used++] = low >= 0 ? (char)(high * 16 + low) : *resources;
        if (low >= 0) resources += 2;
    }
    if (*resources != '\0') return false;
    while (used > 0 && (name[used - 1] == '/' || name[used - 1] == '\\')) used--;
    memcpy(name + used, tail, sizeof tail);
    return true;
}

static size_t read_file(const char *name, uint8_t *bytes, size_t size) {
    FILE *file = fopen(name, "rb");
    if (file == NULL) return 0;
    const size_t got = fread(bytes, 1, size, file);
    (void)fclose(file); /* it was only read */
    return got;
}

static inline bool take_private(fmu_instance *instance, uint32_t reference, double value) {
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return fmu_model_take_private(instance, reference, bits);
}

/* Exactly as many bytes as the pairs need, whose count is anything. */
static bool has_pairs(uint64_t bytes, uint64_t count) { return bytes % 16 == 0 && count == bytes / 16; }

static bool parse(fmu_instance *instance, const uint8_t *bytes, size_t size, const char *token) {
    fmu_stream stream = {0};
    uint64_t version = 0, scalar = 0, hash = 0, count = 0, checksum = 0, reference = 0;
    double value = 0.0;
    stream.from = bytes;
    stream.size = size;
    if (size < sizeof magic + 8 * (HEADER_NUMBERS + 1) || memcmp(bytes, magic, sizeof magic) != 0) return false;
    stream.at = size - 8;
    fmu_stream_u64(&stream, &checksum);
    if (checksum != fmu_checksum(bytes, size - 8)) return false;
    stream.at = sizeof magic;
    fmu_stream_u64(&stream, &version);
    fmu_stream_u64(&stream, &scalar);
    fmu_stream_u64(&stream, &hash);
    fmu_stream_u64(&stream, &count);
    if (version != FILE_VERSION || hash != fmu_token_hash(token) || !has_pairs(size - stream.at - 8, count))
        return false;
    instance->scalar = scalar != 0;
    for (uint64_t k = 0; k < count; k++) {
        fmu_stream_u64(&stream, &reference);
        fmu_stream_reals(&stream, &value, 1);
        if (reference > UINT32_MAX) return false;
        if (FMU_MODEL_PORTS > 0 && reference >= FMU_PRIVATE_START) {
            if (!take_private(instance, (uint32_t)reference, value)) return false;
            continue;
        }
        if (!fmu_set_start_value(instance, (uint32_t)reference, value)) return false;
    }
    return !stream.failed;
}

static bool load_file(fmu_instance *instance, const char *token, const char *resources) {
    char name[4096];
    uint8_t *bytes = malloc(LARGEST_FILE);
    const bool named = file_name(name, sizeof name, resources);
    if (bytes == NULL) {
        fmu_refuse(instance, "Instantiate: out of memory");
        return false;
    }
    const bool good = named && parse(instance, bytes, read_file(name, bytes, LARGEST_FILE), token);
    free(bytes);
    if (!good)
        fmu_refuse(instance,
                   "the token %s is not this binary's, and %.300s holds no start values for it: import the FMU anew",
                   token, named ? name : resources);
    return good;
}

bool fmu_load_start_values(fmu_instance *instance, const char *token, const char *resources) {
    instance->scalar = instance->version == 2 || FMU_MODEL_PORTS > 0;
    if (strcmp(token, instance->version == 2 ? fmu_token_2 : fmu_token_3) == 0) {
        apply(instance, fmu_built_in_starts, fmu_built_in_start_count);
        return true;
    }
    if (resources != NULL) return load_file(instance, token, resources);
    fmu_refuse(instance, "the token %s is not this binary's, and no resources folder was given", token);
    return false;
}
