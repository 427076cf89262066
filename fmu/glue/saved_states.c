/* Saved states: a copy within the process, or bytes that the same FMU can read in any process and on any machine.
 *
 * Bytes: "LACSTATE", then numbers of 64 bits, little-endian: version, hash of the instantiation token, size of the
 * whole, kind, mode, event mode used, clock, model; at the end the checksum of all before. */
#include <stdlib.h>
#include <string.h>

#include "model_interface.h"

#define STATE_VERSION 8U
static const char magic[8] = {'L', 'A', 'C', 'S', 'T', 'A', 'T', 'E'};

struct fmu_snapshot {
    uint64_t token_hash;
    fmu_kind kind;
    fmu_mode mode;
    bool event_mode_used;
    fmu_clock clock;
    fmu_model model;
};

fmu_status fmu_save(fmu_instance *instance, fmu_snapshot **snapshot) {
    fmu_snapshot *copy;
    if (snapshot == NULL) return fmu_refuse(instance, "GetFMUState: the pointer to the state is missing (NULL)");
    copy = *snapshot != NULL ? *snapshot : calloc(1, sizeof *copy);
    if (copy == NULL) return fmu_refuse(instance, "GetFMUState: out of memory");
    copy->token_hash = instance->token_hash;
    copy->kind = instance->kind;
    copy->mode = instance->mode;
    copy->event_mode_used = instance->event_mode_used;
    copy->clock = instance->clock;
    copy->model = instance->model;
    *snapshot = copy;
    return FMU_OK;
}

static fmu_status check_origin(const fmu_instance *instance, const fmu_snapshot *snapshot) {
    if (snapshot == NULL) return fmu_refuse(instance, "the saved state is missing (NULL)");
    if (snapshot->token_hash != instance->token_hash)
        return fmu_refuse(instance, "the saved state belongs to another FMU");
    if (snapshot->kind != instance->kind || snapshot->event_mode_used != instance->event_mode_used)
        return fmu_refuse(instance, "the saved state belongs to an instance of the other kind (Model Exchange, "
                                    "Co-Simulation, with or without event mode)");
    return FMU_OK;
}

fmu_status fmu_restore(fmu_instance *instance, const fmu_snapshot *snapshot) {
    const fmu_status status = check_origin(instance, snapshot);
    if (status != FMU_OK) return status;
    instance->clock = snapshot->clock;
    instance->model = snapshot->model;
    fmu_enter(instance, snapshot->mode);
    return FMU_OK;
}

void fmu_drop(fmu_snapshot **snapshot) {
    if (snapshot == NULL) return;
    free(*snapshot);
    *snapshot = NULL;
}

static void serialize_clock(fmu_stream *stream, fmu_clock *clock) {
    fmu_stream_reals(stream, &clock->start_s, 1);
    fmu_stream_reals(stream, &clock->stop_s, 1);
    fmu_stream_bool(stream, &clock->stop_defined);
    fmu_stream_reals(stream, &clock->anchor_s, 1);
    fmu_stream_reals(stream, &clock->anchor_rest_s, 1);
    fmu_stream_reals(stream, &clock->step_s, 1);
    fmu_stream_u64(stream, &clock->ticks);
    fmu_stream_reals(stream, &clock->communication_s, 1);
    fmu_stream_u64(stream, &clock->communication_ticks);
    fmu_stream_reals(stream, &clock->completed_s, 1);
}

/* Everything but magic and checksum. */
static bool serialize(fmu_stream *stream, fmu_snapshot *snapshot, uint64_t *version, uint64_t *size) {
    int32_t kind = (int32_t)snapshot->kind, mode = (int32_t)snapshot->mode;
    fmu_stream_u64(stream, version);
    fmu_stream_u64(stream, &snapshot->token_hash);
    fmu_stream_u64(stream, size);
    fmu_stream_i32(stream, &kind, FMU_MODEL_EXCHANGE, FMU_CO_SIMULATION);
    fmu_stream_i32(stream, &mode, FMU_INSTANTIATED, FMU_MODE_COUNT - 1);
    fmu_stream_bool(stream, &snapshot->event_mode_used);
    serialize_clock(stream, &snapshot->clock);
    snapshot->kind = (fmu_kind)kind;
    snapshot->mode = (fmu_mode)mode;
    return fmu_model_serialize(stream, &snapshot->model);
}

static size_t whole_size(fmu_snapshot *snapshot) {
    fmu_stream counter = {0};
    uint64_t version = 0, size = 0;
    serialize(&counter, snapshot, &version, &size);
    return sizeof magic + counter.at + 8;
}

/* What is behind a bus terminal has parts that only this process can use. */
static fmu_status check_bytes(const fmu_instance *instance) {
    if (FMU_MODEL_PORTS == 0) return FMU_OK;
    return fmu_refuse(instance, "the state of this FMU cannot be serialized, only kept by GetFMUState");
}

fmu_status fmu_serialized_size(fmu_instance *instance, const fmu_snapshot *snapshot, size_t *size) {
    fmu_status status = check_origin(instance, snapshot);
    fmu_snapshot *copy = NULL;
    if (status == FMU_OK) status = check_bytes(instance);
    if (status != FMU_OK) return status;
    if (size == NULL) return fmu_refuse(instance, "the pointer to the size is missing (NULL)");
    copy = malloc(sizeof *copy);
    if (copy == NULL) return fmu_refuse(instance, "SerializedFMUStateSize: out of memory");
    *copy = *snapshot;
    *size = whole_size(copy);
    free(copy);
    return FMU_OK;
}

static fmu_status write_bytes(fmu_instance *instance, fmu_snapshot *copy, uint8_t *bytes, size_t size) {
    fmu_stream stream = {0};
    uint64_t version = STATE_VERSION, whole = whole_size(copy), checksum;
    if (size != whole)
        return fmu_refuse(instance, "SerializeFMUState: %zu bytes given for a state of %zu", size, (size_t)whole);
    memcpy(bytes, magic, sizeof magic);
    stream.to = bytes;
    stream.size = size;
    stream.at = sizeof magic;
    serialize(&stream, copy, &version, &whole);
    checksum = fmu_checksum(bytes, size - 8);
    fmu_stream_u64(&stream, &checksum);
    return FMU_OK;
}

fmu_status fmu_serialize(fmu_instance *instance, const fmu_snapshot *snapshot, uint8_t *bytes, size_t size) {
    fmu_status status = check_origin(instance, snapshot);
    fmu_snapshot *copy;
    if (status == FMU_OK) status = check_bytes(instance);
    if (status != FMU_OK) return status;
    if (bytes == NULL) return fmu_refuse(instance, "SerializeFMUState: the memory for the bytes is missing (NULL)");
    copy = malloc(sizeof *copy);
    if (copy == NULL) return fmu_refuse(instance, "SerializeFMUState: out of memory");
    *copy = *snapshot;
    status = write_bytes(instance, copy, bytes, size);
    free(copy);
    return status;
}

static bool mode_suits_kind(const fmu_snapshot *snapshot) {
    if (snapshot->kind == FMU_MODEL_EXCHANGE) return snapshot->mode != FMU_STEP && snapshot->mode != FMU_INTERMEDIATE;
    return snapshot->mode != FMU_CONTINUOUS && snapshot->mode != FMU_INTERMEDIATE &&
           (snapshot->mode != FMU_EVENT || snapshot->event_mode_used);
}

static fmu_status read_bytes(fmu_instance *instance, const uint8_t *bytes, size_t size, fmu_snapshot *made) {
    fmu_stream stream = {0};
    uint64_t version = 0, whole = 0, checksum = 0;
    if (size < sizeof magic + 32 || memcmp(bytes, magic, sizeof magic) != 0)
        return fmu_refuse(instance, "DeserializeFMUState: these %zu bytes are no state of Laconic", size);
    stream.from = bytes;
    stream.size = size;
    stream.at = size - 8;
    fmu_stream_u64(&stream, &checksum);
    stream.at = sizeof magic;
    fmu_stream_u64(&stream, &version);
    if (version != STATE_VERSION)
        return fmu_refuse(instance, "DeserializeFMUState: the state has format version %llu, this FMU reads %u",
                          (unsigned long long)version, STATE_VERSION);
    if (checksum != fmu_checksum(bytes, size - 8))
        return fmu_refuse(instance, "DeserializeFMUState: the %zu bytes are damaged or cut off", size);
    stream.at = sizeof magic;
    stream.size = size - 8;
    if (!serialize(&stream, made, &version, &whole) || stream.at != stream.size || whole != size ||
        !mode_suits_kind(made))
        return fmu_refuse(instance, "DeserializeFMUState: the %zu bytes are no possible state", size);
    return check_origin(instance, made);
}

fmu_status fmu_deserialize(fmu_instance *instance, const uint8_t *bytes, size_t size, fmu_snapshot **snapshot) {
    fmu_snapshot *made;
    if (check_bytes(instance) != FMU_OK) return FMU_ERROR;
    if (bytes == NULL || snapshot == NULL)
        return fmu_refuse(instance, "DeserializeFMUState: the bytes or the pointer to the state are missing (NULL)");
    made = calloc(1, sizeof *made);
    if (made == NULL) return fmu_refuse(instance, "DeserializeFMUState: out of memory");
    const fmu_status status = read_bytes(instance, bytes, size, made);
    if (status == FMU_OK && *snapshot == NULL) {
        *snapshot = made;
        return FMU_OK;
    }
    if (status == FMU_OK) **snapshot = *made;
    free(made);
    return status;
}
