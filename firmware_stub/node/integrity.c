/* Memory that changed between two calls of the node: sums, ranges, and what becomes of a node where one is wrong. */
#include "laconic_node/integrity.h"

#include "node_internal.h"

#include <string.h>

typedef struct memory_part {
    uint32_t offset, size;
} memory_part;

#define PART(member) {(uint32_t)offsetof(laconic_node, member), (uint32_t)sizeof(((laconic_node *)NULL)->member)}

/* What only COMMIT writes, and a master of XCP. */
static const memory_part model_parts[] = {
    PART(start),
    PART(plant.vehicle),
    PART(plant.model),
    PART(plant.integrator),
#if LACONIC_WITH_FRICTION
    PART(plant.friction),
#endif
#if LACONIC_NODE_WITH_DRIVES
    PART(drive_plan),
#endif
#if LACONIC_NODE_WITH_SENSORS
    PART(sensors.settings),
#endif
#if LACONIC_NODE_WITH_HINGES
    PART(hinges.model),
#if LACONIC_NODE_WITH_SLIP
    PART(hinges.slips),
    PART(hinges.tree_model),
#endif
    PART(hinges.integrator),
    PART(hinges.start),
    PART(hinges.first),
#endif
#if LACONIC_NODE_WITH_XCP
    PART(xcp.page),
#endif
};

/* From one member to the end of another behind it. */
#define SPAN(first, last) \
    {(uint32_t)offsetof(laconic_node, first), \
     (uint32_t)(offsetof(laconic_node, last) + sizeof(((laconic_node *)NULL)->last) - offsetof(laconic_node, first))}

/* Of the model, what a wrong pointer or count would break at once. */
static const memory_part shape_parts[] = {
    SPAN(plant.integrator.method, plant.integrator.step_s),
    SPAN(plant.model.wheel_count, plant.model.dof),
#if LACONIC_NODE_WITH_HINGES
    SPAN(hinges.model.body_count, hinges.model.coordinated),
#if LACONIC_NODE_WITH_SLIP
    PART(hinges.slips),
    SPAN(hinges.tree_model.body_count, hinges.tree_model.point_count),
#endif
#endif
};

/* What every call may write, but nobody between two calls; with the pointer and the count of drives. */
static const memory_part motion_parts[] = {
    SPAN(free_run, lockstep),
    PART(session),
    PART(raw_input),
    PART(plant.state),
    PART(input[0]),
    PART(plant.steps),
#if LACONIC_NODE_WITH_DRIVES
    SPAN(drives.protocol, drives.count),
    PART(drives.wheel),
#endif
#if LACONIC_NODE_WITH_HINGES
    SPAN(hinges.here, hinges.send),
    SPAN(hinges.state, hinges.twist),
    PART(hinges.input),
#endif
};

/* What fetching a frame may write, too. */
static const memory_part queue_parts[] = {SPAN(state, pending), SPAN(raw_output.send, raw_output.segment)};

#define PARTS(of) (sizeof(of) / sizeof(of)[0])

static void add_word(laconic_memory_sum *sum, uint32_t word) {
    sum->words += word;
    sum->sums += sum->words;
}

/* Four words at a time, which takes fewer instructions. The last bytes count as a word that zeros fill up. */
static void add_bytes(laconic_memory_sum *sum, const uint8_t *bytes, uint32_t count) {
    laconic_memory_sum of = *sum;
    uint32_t word[4] = {0, 0, 0, 0};
    for (; count >= sizeof word; count -= (uint32_t)sizeof word, bytes += sizeof word) {
        memcpy(word, bytes, sizeof word);
        add_word(&of, word[0]);
        add_word(&of, word[1]);
        add_word(&of, word[2]);
        add_word(&of, word[3]);
    }
    for (; count >= sizeof word[0]; count -= (uint32_t)sizeof word[0], bytes += sizeof word[0]) {
        memcpy(word, bytes, sizeof word[0]);
        add_word(&of, word[0]);
    }
    word[0] = 0;
    for (uint32_t k = 0; k < count; k++) word[0] |= (uint32_t)bytes[k] << (8U * k);
    if (count > 0) add_word(&of, word[0]);
    *sum = of;
}

static void add_parts(laconic_memory_sum *sum, const laconic_node *node, const memory_part *parts, size_t count) {
    for (size_t k = 0; k < count; k++) add_bytes(sum, (const uint8_t *)node + parts[k].offset, parts[k].size);
}

static bool same(laconic_memory_sum a, laconic_memory_sum b) { return a.words == b.words && a.sums == b.sums; }

static laconic_memory_sum sum_of_model(const laconic_node *node) {
    laconic_memory_sum sum = {0, 0};
    add_parts(&sum, node, model_parts, PARTS(model_parts));
    return sum;
}

static laconic_memory_sum sum_of_shape(const laconic_node *node) {
    laconic_memory_sum sum = {0, 0};
    add_parts(&sum, node, shape_parts, PARTS(shape_parts));
    return sum;
}

/* Inputs of the middle and the end of a step only where they are used, the slip only where there is friction. */
static laconic_memory_sum sum_of_motion(const laconic_node *node) {
    laconic_memory_sum sum = {0, 0};
    add_parts(&sum, node, motion_parts, PARTS(motion_parts));
    if (!LACONIC_NODE_DRIVES_ONLY && (node->raw_input.take & LACONIC_RAW_SAMPLED) != 0)
        add_bytes(&sum, (const uint8_t *)node->input, (uint32_t)sizeof node->input);
#if LACONIC_WITH_FRICTION
    if (node->plant.friction.acts) add_bytes(&sum, (const uint8_t *)&node->plant.slip, sizeof node->plant.slip);
#endif
    return sum;
}

static laconic_memory_sum sum_of_queue(const laconic_node *node) {
    laconic_memory_sum sum = {0, 0};
    add_parts(&sum, node, queue_parts, PARTS(queue_parts));
    return sum;
}

static laconic_memory_sum sum_of_loaded(const laconic_node *node) {
    laconic_memory_sum sum = {0, 0};
    add_bytes(&sum, (const uint8_t *)&node->loader, (uint32_t)sizeof node->loader);
    return sum;
}

/* -------------------------------------------------------------------------------- what is found -- */

static void begin_round(laconic_integrity *it) {
    static const laconic_memory_sum none = {0, 0};
    it->part = 0;
    it->at = 0;
    it->slices = 0;
    it->round_us = it->now_us;
    it->running = none;
}

static void seal_motion(laconic_integrity *it, const laconic_node *node) {
    if ((it->checks & LACONIC_INTEGRITY_MOTION) == 0) return;
    it->shape = sum_of_shape(node);
    it->motion = sum_of_motion(node);
    it->queue = sum_of_queue(node);
}

/* A node that has no vehicle has nothing to lose, and FAULT means that there is one. */
static void fail(laconic_integrity *it, laconic_node *node, uint8_t checks) {
    const laconic_refusal why = {.status = (laconic_status)LACONIC_WIRE_STATUS_MEMORY_CHANGED, .item = checks};
    it->broken = checks;
    node->pending = 0; /* what waits may be what is wrong */
    node->answers_due = 0;
#if LACONIC_NODE_WITH_ESTIMATE
    if (checks == LACONIC_INTEGRITY_OF_MODEL) node->estimates = false;
#endif
    if (it->has_vehicle) {
        laconic_node_fail(node, &why, 0);
    } else {
        (void)laconic_node_init(node, it->config, it->now_us);
        it->loaded = sum_of_loaded(node);
    }
}

static bool is_finite(laconic_real x) { return x - x == 0; }

static bool is_within(laconic_real x, laconic_real limit) {
    return is_finite(x) && (limit == 0 || (x <= limit && x >= -limit));
}

/* A sum's rest is what its value could not take up. */
static bool is_sum(const laconic_sum *sum) {
    const laconic_real unit = (laconic_real)(4 * LACONIC_EPSILON) * (1 + (sum->value < 0 ? -sum->value : sum->value));
    return is_finite(sum->value) && sum->rest <= unit && sum->rest >= -unit;
}

#if LACONIC_NODE_WITH_HINGES
static bool is_possible_with_hinges(const laconic_node *node, const laconic_integrity_limits *limits) {
    const laconic_node_hinges *hinges = &node->hinges;
    const laconic_sum *x_m = &hinges->state.x_m, *y_m = &hinges->state.y_m;
    const laconic_heading *heading = &hinges->state.heading, *hinge = hinges->state.hinge;
    laconic_articulated_motion motion;
#if LACONIC_NODE_WITH_SLIP
    if (hinges->slips) {
        x_m = &hinges->tree.x_m;
        y_m = &hinges->tree.y_m;
        heading = &hinges->tree.heading;
        hinge = hinges->tree.hinge;
    }
#endif
    laconic_node_motion_of(&motion, node);
    bool good = is_within(motion.yaw_rate_rad_per_s, limits->yaw_rate_rad_per_s) && is_sum(x_m) && is_sum(y_m) &&
                is_within(motion.x_m, limits->distance_m) && is_within(motion.y_m, limits->distance_m) &&
                is_within(heading->rest, 1);
    for (int k = 0; k < 2; k++) good = good && is_within(motion.velocity_m_per_s[k], limits->speed_m_per_s);
    for (int32_t i = 0; i < hinges->model.dof && i < LACONIC_MAX_VELOCITIES; i++)
        good = good && is_sum(&hinges->state.eta[i]);
    for (int32_t b = 0; b < hinges->model.body_count && b < LACONIC_MAX_BODIES; b++)
        good = good && is_within(hinge[b].rest, 1) && is_finite(motion.hinge_rate_rad_per_s[b]);
    for (int32_t i = 0; i < node->plant.model.wheel_count && i < LACONIC_MAX_WHEELS; i++)
        good = good && is_within(node->input[0].voltage_V[i], limits->voltage_V);
    return good && node->state <= LACONIC_WIRE_STATE_DRIVES;
}
#endif

static bool is_possible(const laconic_node *node, const laconic_integrity_limits *limits) {
    const laconic_state *state = &node->plant.state;
    laconic_real velocity_m_per_s[2];
#if LACONIC_NODE_WITH_HINGES
    if (has_hinges(node)) return is_possible_with_hinges(node, limits);
#endif
    const laconic_real yaw_rate = laconic_body_velocity(&node->plant.model, state, velocity_m_per_s);
    bool good = is_within(yaw_rate, limits->yaw_rate_rad_per_s) && is_sum(&state->x_m) && is_sum(&state->y_m) &&
                is_within(state->x_m.value, limits->distance_m) && is_within(state->y_m.value, limits->distance_m) &&
                is_within(state->heading.rest, 1);
    for (int k = 0; k < 2; k++) good = good && is_within(velocity_m_per_s[k], limits->speed_m_per_s);
    for (int k = 0; k < 3; k++) good = good && is_sum(&state->zeta[k]) && is_sum(&state->travel[k]);
    for (int32_t i = 0; i < node->plant.model.wheel_count && i < LACONIC_MAX_WHEELS; i++)
        good = good && is_within(node->input[0].voltage_V[i], limits->voltage_V);
    return good && node->state <= LACONIC_WIRE_STATE_DRIVES;
}

/* One slice further; at the end of a round, whether all is as it was. */
static void see_slice(laconic_integrity *it, laconic_node *node) {
    const memory_part *memory = &model_parts[it->part];
    const uint32_t rest_bytes = memory->size - it->at;
    const uint32_t count = rest_bytes < LACONIC_INTEGRITY_SLICE ? rest_bytes : LACONIC_INTEGRITY_SLICE;
    add_bytes(&it->running, (const uint8_t *)node + memory->offset + it->at, count);
    it->slices++;
    it->at += count;
    if (it->at < memory->size) return;
    it->at = 0;
    it->part++;
    if (it->part < PARTS(model_parts)) return;
    if (same(it->running, it->model))
        it->rounds++;
    else
        fail(it, node, LACONIC_INTEGRITY_OF_MODEL);
    begin_round(it);
}

static uint32_t slices_of_a_round(void) {
    uint32_t count = 0;
    for (size_t k = 0; k < PARTS(model_parts); k++)
        count += (model_parts[k].size + LACONIC_INTEGRITY_SLICE - 1U) / LACONIC_INTEGRITY_SLICE;
    return count;
}

/* The slices that are due by this time, evenly over the round. */
static void see_model(laconic_integrity *it, laconic_node *node) {
    const uint32_t slice_us = LACONIC_INTEGRITY_ROUND_US / slices_of_a_round();
    for (uint32_t k = 0; k < LACONIC_INTEGRITY_SLICES_PER_TICK; k++) {
        if ((int32_t)(it->now_us - it->round_us) < (int32_t)(it->slices * slice_us)) return;
        see_slice(it, node);
    }
}

/* ------------------------------------------------------------------------------------- the calls -- */

void laconic_integrity_begin(laconic_integrity *integrity, const laconic_node *node, const laconic_node_config *config,
                             const laconic_integrity_limits *limits, uint8_t checks) {
    laconic_check_node_build();
    memset(integrity, 0, sizeof *integrity);
    integrity->config = config;
    integrity->limits = *limits;
    integrity->checks = checks;
    integrity->loaded = sum_of_loaded(node);
    seal_motion(integrity, node);
}

static bool is_original(const laconic_node_config *config, const laconic_node_config *original) {
#if LACONIC_NODE_WITH_DRIVES
    if (config->protocol != original->protocol) return false;
#endif
    return config->id_base == original->id_base && config->can_fd == original->can_fd &&
           config->method == original->method && config->nonce_seed == original->nonce_seed;
}

static void look_at_seals(laconic_integrity *it, laconic_node *node) {
    if (!same(it->shape, sum_of_shape(node)))
        fail(it, node, LACONIC_INTEGRITY_OF_MODEL);
    else if (!same(it->queue, sum_of_queue(node)) || !same(it->motion, sum_of_motion(node)))
        fail(it, node, LACONIC_INTEGRITY_OF_MOTION);
}

/* Before a call: its pointers, and that the memory is as the last call left it. */
static void look(laconic_integrity *it, laconic_node *node, uint32_t now_us) {
    it->now_us = now_us;
    if (!is_original(&node->config, it->config)) {
        node->config = *it->config;
        fail(it, node, LACONIC_INTEGRITY_OF_CONFIGURATION);
    } else if ((it->checks & LACONIC_INTEGRITY_MOTION) != 0) {
        look_at_seals(it, node);
    }
}

static bool is_loading(const laconic_node *node, const laconic_frame *frame) {
    const uint32_t offset = frame->id - node->config.id_base;
    return !frame->extended && (offset == LACONIC_WIRE_PARAMETER || offset == LACONIC_WIRE_COMMIT ||
                                offset == LACONIC_WIRE_CONTROL || offset == LACONIC_WIRE_OPEN);
}

/* Numbers that changed since they came are none of the rig's. */
static void look_at_loaded(const laconic_integrity *it, laconic_node *node) {
    if (same(it->loaded, sum_of_loaded(node))) return;
    node->loader.status = LACONIC_WIRE_STATUS_MEMORY_CHANGED;
    node->loader.field = 0;
    node->loader.item = LACONIC_INTEGRITY_OF_LOADED;
}

/* A wrong model is wrong until the next COMMIT, whatever the rig orders; a wrong motion ends with it. */
static void hold(laconic_integrity *it, laconic_node *node) {
    const bool recovers = node->state != LACONIC_WIRE_STATE_FAULT && node->state != LACONIC_WIRE_STATE_EMPTY;
    if (it->broken == LACONIC_INTEGRITY_SOUND || !recovers) return;
    if (it->broken == LACONIC_INTEGRITY_OF_MODEL)
        fail(it, node, LACONIC_INTEGRITY_OF_MODEL);
    else
        it->broken = LACONIC_INTEGRITY_SOUND;
}

#if LACONIC_NODE_WITH_XCP
#define XCP_LEAST_THAT_WRITES 0xE4U /* COPY_CAL_PAGE, SET_CAL_PAGE and DOWNLOAD are among the codes from it on … */
#define XCP_MOST_THAT_WRITES 0xF0U  /* … to this one                                                        */

static bool may_calibrate(const laconic_integrity *it, const laconic_node *node, const laconic_frame *frame) {
    return it->has_vehicle && it->broken != LACONIC_INTEGRITY_OF_MODEL && (it->checks & LACONIC_INTEGRITY_SUM) != 0 &&
           !frame->extended && frame->id - node->config.id_base == LACONIC_WIRE_XCP_COMMAND &&
           frame->data[0] >= XCP_LEAST_THAT_WRITES && frame->data[0] <= XCP_MOST_THAT_WRITES;
}

/* A new sum must not cover a change that the present round has not come to. */
static void look_at_model(laconic_integrity *it, laconic_node *node) {
    if (!same(it->model, sum_of_model(node))) fail(it, node, LACONIC_INTEGRITY_OF_MODEL);
}

static void renew_model(laconic_integrity *it, const laconic_node *node) {
    it->model = sum_of_model(node);
    begin_round(it);
}
#endif

void laconic_integrity_on_frame(laconic_integrity *integrity, laconic_node *node, const laconic_frame *frame,
                                uint32_t now_us) {
    look(integrity, node, now_us);
    const bool loading = (integrity->checks & LACONIC_INTEGRITY_MOTION) != 0 && is_loading(node, frame);
    const uint32_t commits = node->session.count[LACONIC_WIRE_COMMIT];
    if (loading) look_at_loaded(integrity, node);
#if LACONIC_NODE_WITH_XCP
    const bool calibrating = may_calibrate(integrity, node, frame);
    if (calibrating) look_at_model(integrity, node);
#endif
    node->model_is_wrong = integrity->broken == LACONIC_INTEGRITY_OF_MODEL;
    laconic_node_on_frame(node, frame, now_us);
    if (loading) integrity->loaded = sum_of_loaded(node);
#if LACONIC_NODE_WITH_XCP
    if (calibrating && integrity->broken != LACONIC_INTEGRITY_OF_MODEL) renew_model(integrity, node);
#endif
    if (node->session.count[LACONIC_WIRE_COMMIT] > commits && node->answer[LACONIC_WIRE_COMMIT].status == 0) {
        integrity->has_vehicle = true;
        integrity->broken = LACONIC_INTEGRITY_SOUND;
        integrity->model = sum_of_model(node);
        begin_round(integrity);
    }
    hold(integrity, node);
    seal_motion(integrity, node);
}

void laconic_integrity_on_tick(laconic_integrity *integrity, laconic_node *node, uint32_t now_us) {
    look(integrity, node, now_us);
    laconic_node_on_tick(node, now_us);
    const bool stands = node->state == LACONIC_WIRE_STATE_FAULT || node->state == LACONIC_WIRE_STATE_EMPTY;
    if (!stands && (integrity->checks & LACONIC_INTEGRITY_RANGE) != 0 && !is_possible(node, &integrity->limits))
        fail(integrity, node, LACONIC_INTEGRITY_OF_RANGE);
    if (integrity->has_vehicle && integrity->broken != LACONIC_INTEGRITY_OF_MODEL &&
        (integrity->checks & LACONIC_INTEGRITY_SUM) != 0)
        see_model(integrity, node);
    seal_motion(integrity, node);
}

bool laconic_integrity_next_frame(laconic_integrity *integrity, laconic_node *node, laconic_frame *frame) {
    const bool checked = (integrity->checks & LACONIC_INTEGRITY_MOTION) != 0;
    if (checked && !same(integrity->queue, sum_of_queue(node))) {
        fail(integrity, node, LACONIC_INTEGRITY_OF_MOTION);
        seal_motion(integrity, node);
    }
    const bool is_there = laconic_node_next_frame(node, frame);
    if (checked) integrity->queue = sum_of_queue(node);
    return is_there;
}
