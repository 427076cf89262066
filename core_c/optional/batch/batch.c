/* A batch in the caller's memory: lanes are put into blocks of one kind of step. */
#include "batch_block.h"
#include "exponential_gauss_8.h"

#define LARGEST_LANE_COUNT (1 << 28)
#define ALIGNMENT 64
#define LANES_WAYS (LANES_METHOD_COUNT + 6 * MOST_STRETCHES + 1) /* in which lanes take a step */

/* ------------------------------------------------------------------------------- widths -- */

#if defined(LANES_OF_64)
#include "processor.h"

static const lanes_width *width_of(int32_t bytes) {
    if (bytes == 64 && processor_has(PROCESSOR_AVX512_F_DQ_VL, PROCESSOR_SAVES_ZMM)) return &laconic_lanes_of_64;
    if (bytes == 32 && processor_has(PROCESSOR_AVX2, PROCESSOR_SAVES_YMM)) return &laconic_lanes_of_32;
    return bytes == 16 ? &laconic_lanes_of_16 : NULL;
}
#elif defined(LANES_OF_16)
static const lanes_width *width_of(int32_t bytes) { return bytes == 16 ? &laconic_lanes_of_16 : NULL; }
#else
static const lanes_width *width_of(int32_t bytes) { return (void)bytes, NULL; }
#endif

int32_t laconic_batch_width(int32_t width_bytes) {
    for (int32_t bytes = 64; bytes >= 16; bytes /= 2)
        if ((width_bytes == 0 || width_bytes == bytes) && width_of(bytes) != NULL) return bytes;
    return width_bytes <= 1 && width_bytes >= 0 ? 1 : 0;
}

/* -------------------------------------------------------------------------------- kinds -- */

static const laconic_method *const steppers[LANES_METHOD_COUNT] = {&laconic_rk4,
                                                                   &laconic_exponential_kahan,
                                                                   &laconic_exponential_kahan_4,
                                                                   &laconic_exact_flow,
                                                                   &laconic_exact_flow_4,
                                                                   &laconic_taylor_8,
#if LACONIC_WITH_EXPONENTIAL_GAUSS
                                                                   &laconic_exponential_gauss_8,
                                                                   &laconic_auto_slow,
                                                                   &laconic_auto_fast
#endif
};

static lanes_kind lanes_kind_of(const laconic_batch_kind *kind) {
    lanes_kind out = ALL_ZERO;
    int method = 0;
    while (method < LANES_METHOD_COUNT && steppers[method] != kind->integrator.chosen) method++;
    out.method = (lanes_method)method;
    out.wheel_count = LACONIC_WHEELS(&kind->model);
    out.stiff = kind->integrator.stiff;
#if LACONIC_WITH_EXPONENTIAL_GAUSS
    out.stretches = kind->integrator.stretches;
    out.has_rest = kind->integrator.has_rest;
#endif
#if LACONIC_WITH_SLOPE
    out.sloped = kind->model.sloped;
#endif
    return out;
}

laconic_status laconic_batch_kind_of(laconic_batch_kind *kind, const laconic_vehicle *vehicle,
                                     const laconic_method *method, laconic_real step_s, laconic_refusal *why) {
    laconic_batch_kind fresh = ALL_ZERO;
    laconic_status status = laconic_prepare(&fresh.model, vehicle, why);
    if (status != LACONIC_OK) return status;
    if (laconic_vehicle_has_friction(vehicle))
        return refuse(why, LACONIC_METHOD_WITHOUT_FRICTION, LACONIC_FIELD_METHOD, 0, R(0), R(0));
    status = laconic_integrator_prepare(&fresh.integrator, method, &fresh.model, step_s, why);
    if (status == LACONIC_OK) *kind = fresh;
    return status;
}

static laconic_number *take(laconic_number *to, const laconic_real *member, size_t bytes) {
    for (size_t i = 0; i < bytes / sizeof(laconic_real); i++) *to++ = member[i];
    return to;
}

/* Members are numbers, arrays of them, or structs of them alone. */
#define TAKE_OF_MODEL(member) to = take(to, (const laconic_real *)&model->member, sizeof model->member);
#define TAKE_OF_INTEGRATOR(member) to = take(to, (const laconic_real *)&integrator->member, sizeof integrator->member);

/* What a step reads of a kind, in the order of lanes_width.h. */
static void constants_of(laconic_number to[LANES_CONSTANTS], const laconic_batch_kind *kind) {
    const laconic_model *model = &kind->model;
    const laconic_integrator *integrator = &kind->integrator;
    LANES_MODEL_MEMBERS(TAKE_OF_MODEL)
    LANES_INTEGRATOR_MEMBERS(TAKE_OF_INTEGRATOR)
    LANES_COLLOCATION_MEMBERS(TAKE_OF_INTEGRATOR)
}

/* ------------------------------------------------------------------------------- layout -- */

/* Kinds that many lanes share have blocks of their own, whose constants are there once; else each block has its own. */
static bool is_by_kind(const laconic_batch_shape *shape) {
    return shape->kind_count == 1 || shape->kind_count <= shape->lane_count / 64;
}

static int32_t blocks_at_most(const laconic_batch_shape *shape, int32_t lanes) {
    const int32_t ways = LANES_WAYS * (LACONIC_MAX_WHEELS + 1) * 4; /* in which lanes of a block are alike */
    const int32_t groups = shape->kind_count < ways || is_by_kind(shape) ? shape->kind_count : ways;
    return (shape->lane_count + lanes - 1) / lanes + groups;
}

static size_t aligned(size_t bytes) { return (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT; }

/* An odd number of cache lines: rows with a power of two between them would share few places of a cache. */
static size_t row_bytes_of(const laconic_batch_shape *shape) {
    return aligned((size_t)shape->lane_count * sizeof(laconic_real)) | ALIGNMENT;
}

/* Where the parts of a batch begin in its memory, and where they end. */
typedef struct layout {
    size_t order, slot_of, kind_of, status, missed, blocks, states, constants, end;
} layout;

static layout layout_of(const laconic_batch_shape *shape, const lanes_width *width) {
    const size_t lanes = (size_t)shape->lane_count;
    const size_t blocks = (size_t)blocks_at_most(shape, lanes_of_width(width));
    const size_t lane_slots = blocks * (size_t)lanes_of_width(width);
    const size_t constants = width == NULL ? 0 : aligned(width->model_bytes) + aligned(width->integrator_bytes);
    layout l;
    l.order = (size_t)ROW_COUNT(shape->wheel_count) * row_bytes_of(shape);
    l.slot_of = l.order + aligned(lane_slots * sizeof(int32_t));
    l.kind_of = l.slot_of + aligned(lanes * sizeof(int32_t));
    l.status = l.kind_of + aligned(lanes * sizeof(int32_t));
    l.missed = l.status + aligned(lanes * sizeof(int32_t));
    l.blocks = l.missed + aligned(lanes * sizeof(uint64_t));
    l.states = l.blocks + aligned(blocks * sizeof(laconic_batch_block));
    l.constants = l.states + aligned(blocks * STATE_NUMBERS * state_stride(width));
    l.end = l.constants + constants * (is_by_kind(shape) ? (size_t)shape->kind_count : blocks);
    return l;
}

static bool is_within_bounds(const laconic_batch_shape *s) {
    return s->lane_count >= 1 && s->lane_count <= LARGEST_LANE_COUNT && s->kind_count >= 1 &&
           s->kind_count <= s->lane_count && s->wheel_count >= 0 && s->wheel_count <= LACONIC_MAX_WHEELS &&
           laconic_batch_width(s->width_bytes) != 0;
}

size_t laconic_batch_size(const laconic_batch_shape *shape) {
    if (!is_within_bounds(shape)) return 0;
    return layout_of(shape, width_of(laconic_batch_width(shape->width_bytes))).end;
}

/* ------------------------------------------------------------------------- order of lanes -- */

/* Lanes of equal keys can share a block. */
static int32_t way_of(const laconic_batch_kind *of) {
    const lanes_kind kind = lanes_kind_of(of);
    const int32_t together = (int32_t)kind.method + 3 * (2 * kind.stretches - kind.has_rest);
    const int32_t step = kind.method == LANES_NO_METHOD ? LANES_WAYS - 1 : together;
    return step + LANES_WAYS * (kind.sloped + 2 * kind.stiff + 4 * kind.wheel_count);
}

static int32_t key_of(const laconic_batch *batch, int32_t lane) {
    const int32_t index = batch->kind_of[lane];
    return is_by_kind(&batch->shape) ? index : way_of(&batch->kinds[index]);
}

static bool comes_before(const laconic_batch *batch, int32_t a, int32_t b) {
    const int32_t key_a = key_of(batch, a), key_b = key_of(batch, b);
    return key_a < key_b || (key_a == key_b && a < b);
}

static void exchange(int32_t *a, int32_t *b) {
    const int32_t moved = *a;
    *a = *b;
    *b = moved;
}

/* Heap sort: it needs no memory. */
static void sift(const laconic_batch *batch, int32_t *lanes, int32_t top, int32_t count) {
    for (int32_t child = 2 * top + 1; child < count; child = 2 * top + 1) {
        if (child + 1 < count && comes_before(batch, lanes[child], lanes[child + 1])) child++;
        if (!comes_before(batch, lanes[top], lanes[child])) return;
        exchange(&lanes[top], &lanes[child]);
        top = child;
    }
}

static void sort_lanes(const laconic_batch *batch, int32_t *lanes) {
    const int32_t count = batch->shape.lane_count;
    bool is_sorted = true;
    for (int32_t i = 0; i < count; i++) lanes[i] = i;
    for (int32_t i = 1; i < count && is_sorted; i++) is_sorted = comes_before(batch, i - 1, i);
    if (is_sorted) return;
    for (int32_t top = count / 2 - 1; top >= 0; top--) sift(batch, lanes, top, count);
    for (int32_t end = count - 1; end > 0; end--) {
        exchange(&lanes[0], &lanes[end]);
        sift(batch, lanes, 0, end);
    }
}

/* ------------------------------------------------------------------------------- blocks -- */

static bool is_in_a_row(const laconic_batch *batch, const int32_t *lane, int32_t count, int32_t lanes) {
    const size_t end = (size_t)(lane[0] + lanes) * sizeof(laconic_real);
    for (int32_t i = 1; i < count; i++)
        if (lane[i] != lane[0] + i) return false;
    return count == lanes || (lane[count - 1] == batch->shape.lane_count - 1 && end <= batch->row_bytes);
}

/* Lanes that a block lacks have the constants of its first. */
static void place_constants(const laconic_batch *batch, const laconic_batch_block *block, int32_t lanes) {
    laconic_number constants[LANES_CONSTANTS];
    for (int32_t k = 0; k < lanes; k++) {
        const laconic_batch_kind *kind = &batch->kinds[batch->kind_of[block->lanes[k]]];
        constants_of(constants, kind);
        batch->width->place(block, k, lanes_kind_of(kind), constants);
    }
}

static void share_constants(const laconic_batch *batch, laconic_batch_block *block, unsigned char **constants) {
    const laconic_batch_block *before = block - 1;
    const int32_t *kind = batch->kind_of;
    if (is_by_kind(&batch->shape) && block > batch->blocks && kind[before->lanes[0]] == kind[block->lanes[0]]) {
        block->model = before->model;
        block->integrator = before->integrator;
        return;
    }
    block->model = *constants;
    block->integrator = *constants + aligned(batch->width->model_bytes);
    *constants += aligned(batch->width->model_bytes) + aligned(batch->width->integrator_bytes);
    place_constants(batch, block, lanes_of_width(batch->width));
}

static void place_block(laconic_batch *batch, const int32_t *lane, int32_t count, unsigned char *states,
                        unsigned char **constants) {
    const laconic_batch_kind *kind = &batch->kinds[batch->kind_of[lane[0]]];
    const int32_t lanes = lanes_of_width(batch->width), index = batch->block_count++;
    int32_t *own = &batch->order[index * lanes];
    laconic_batch_block block = ALL_ZERO;
    for (int32_t k = 0; k < lanes; k++) own[k] = lane[k < count ? k : 0];
    block.lanes = own;
    block.method = lanes_kind_of(kind).method;
    block.way = way_of(kind);
    block.count = count;
    block.wheel_count = LACONIC_WHEELS(&kind->model);
    block.in_a_row = is_in_a_row(batch, lane, count, lanes);
    block.rows = batch->rows;
    block.row_bytes = batch->row_bytes;
    block.state = states + (size_t)index * STATE_NUMBERS * state_stride(batch->width);
    batch->blocks[index] = block;
    if (batch->width != NULL) share_constants(batch, &batch->blocks[index], constants);
}

/* Lanes of equal keys, which follow each other when they are sorted, fill blocks. */
static void place_blocks(laconic_batch *batch, unsigned char *states, unsigned char *constants) {
    const int32_t lanes = lanes_of_width(batch->width), *sorted = batch->slot_of;
    int32_t first = 0;
    for (int32_t i = 1; i <= batch->shape.lane_count; i++) {
        const bool ends = i == batch->shape.lane_count || i - first == lanes ||
                          key_of(batch, sorted[i]) != key_of(batch, sorted[first]);
        if (!ends) continue;
        place_block(batch, &sorted[first], i - first, states, &constants);
        first = i;
    }
}

static void set_slots(laconic_batch *batch) {
    const int32_t lanes = lanes_of_width(batch->width);
    for (int32_t i = 0; i < batch->block_count; i++)
        for (int32_t k = 0; k < batch->blocks[i].count; k++) batch->slot_of[batch->blocks[i].lanes[k]] = i * lanes + k;
}

/* -------------------------------------------------------------------------------- place -- */

static bool kinds_fit(const laconic_batch_shape *shape, const laconic_batch_kind *kinds, const int32_t *kind_of) {
    for (int32_t i = 0; i < shape->kind_count; i++)
        if (LACONIC_WHEELS(&kinds[i].model) > shape->wheel_count) return false;
    for (int32_t i = 0; kind_of != NULL && i < shape->lane_count; i++)
        if (kind_of[i] < 0 || kind_of[i] >= shape->kind_count) return false;
    return true;
}

static void clear_bytes(unsigned char *memory, size_t bytes) {
    for (size_t i = 0; i < bytes; i++) memory[i] = 0;
}

bool laconic_batch_place(laconic_batch *batch, void *memory, const laconic_batch_shape *shape,
                         const laconic_batch_kind *kinds, const int32_t *kind_of) {
    unsigned char *const start = (unsigned char *)memory;
    laconic_batch b = ALL_ZERO;
    if (!is_within_bounds(shape) || (uintptr_t)memory % ALIGNMENT != 0 || !kinds_fit(shape, kinds, kind_of))
        return false;
    b.shape = *shape;
    b.shape.width_bytes = laconic_batch_width(shape->width_bytes);
    b.width = width_of(b.shape.width_bytes);
    const layout l = layout_of(shape, b.width);
    clear_bytes(start, l.constants);
    b.row_bytes = row_bytes_of(shape);
    b.rows = start;
    b.order = (int32_t *)(void *)(start + l.order);
    b.slot_of = (int32_t *)(void *)(start + l.slot_of);
    b.kind_of = (int32_t *)(void *)(start + l.kind_of);
    b.status = (int32_t *)(void *)(start + l.status);
    b.missed = (uint64_t *)(void *)(start + l.missed);
    b.blocks = (laconic_batch_block *)(void *)(start + l.blocks);
    b.kinds = kinds;
    for (int32_t i = 0; kind_of != NULL && i < shape->lane_count; i++) b.kind_of[i] = kind_of[i];
    sort_lanes(&b, b.slot_of); /* there is room there */
    place_blocks(&b, start + l.states, start + l.constants);
    set_slots(&b);
    *batch = b;
    return true;
}

/* -------------------------------------------------------------------------------- renew -- */

bool laconic_batch_renew(laconic_batch *batch, int32_t lane) {
    const laconic_batch_block *block = &batch->blocks[batch->slot_of[lane] / lanes_of_width(batch->width)];
    if (way_of(&batch->kinds[batch->kind_of[lane]]) != block->way) return false;
    if (batch->width != NULL) place_constants(batch, block, lanes_of_width(batch->width));
    return true;
}
