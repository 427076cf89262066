/* Notices memory that changed without a call: by radiation, a failing cell, a stray write. A port that wants it calls
 * these three in place of those of node.h; one that does not pays nothing.
 *
 *     laconic_node_init(&node, &config, now());
 *     laconic_integrity_begin(&integrity, &node, &config, &limits, LACONIC_INTEGRITY_ALL);
 *     for (;;) {
 *         while (receive(&frame)) laconic_integrity_on_frame(&integrity, &node, &frame, now());
 *         laconic_integrity_on_tick(&integrity, &node, now());
 *         while (laconic_integrity_next_frame(&integrity, &node, &frame)) send(&frame);
 *     }
 *
 * SUM checks model and parameters twice a second against their sum at COMMIT, in slices, so that no call takes long:
 * a change is found within a second. RANGE checks after each tick that the motion is a possible one. MOTION checks
 * before each call that state, inputs, session and what waits to be sent are as the call before left them, and the
 * counts and pointers of the model, too; before PARAMETER and COMMIT, that what was loaded is. The configuration is
 * always compared with the original, and repaired.
 *
 * What is found ends the run: inputs 0, state FAULT, and a RESULT to SYNC with MEMORY_CHANGED, whose item is one of the
 * numbers below. Only COMMIT heals a changed model: until then RESET is refused; RESET heals a changed motion.
 * A node without a vehicle has nothing to keep and begins as after power-up.
 *
 * The sums are two of 32 bits (of words, and of the sums so far): every change within one word is found, and of others
 * all but one in 2³². The state of drives is not watched. */
#ifndef LACONIC_NODE_INTEGRITY_H
#define LACONIC_NODE_INTEGRITY_H

#include "laconic_node/node.h"

#define LACONIC_INTEGRITY_SLICE 256U          /* bytes                                        */
#define LACONIC_INTEGRITY_SLICES_PER_TICK 16U /* at most, where ticks are rare                */
#define LACONIC_INTEGRITY_ROUND_US 500000U    /* in which all of model and parameters is seen */

/* What is checked besides the configuration; a sum of these. */
#define LACONIC_INTEGRITY_SUM 1U
#define LACONIC_INTEGRITY_RANGE 2U
#define LACONIC_INTEGRITY_MOTION 4U
#define LACONIC_INTEGRITY_ALL 7U

/* RESULT.item of MEMORY_CHANGED. */
enum {
    LACONIC_INTEGRITY_SOUND = 0,
    LACONIC_INTEGRITY_OF_MODEL = 1,         /* model or parameters                                        */
    LACONIC_INTEGRITY_OF_RANGE = 2,         /* a number that no motion of the vehicle has                 */
    LACONIC_INTEGRITY_OF_MOTION = 3,        /* state, inputs or session between two calls                 */
    LACONIC_INTEGRITY_OF_LOADED = 4,        /* numbers of PARAMETER before COMMIT, which is then refused  */
    LACONIC_INTEGRITY_OF_CONFIGURATION = 5, /* repaired                                                   */
};

/* The most that the vehicle can do; 0: any number that is finite. */
typedef struct laconic_integrity_limits {
    laconic_real speed_m_per_s, yaw_rate_rad_per_s, voltage_V, distance_m;
} laconic_integrity_limits;

typedef struct laconic_memory_sum {
    uint32_t words, sums;
} laconic_memory_sum;

typedef struct laconic_integrity {
    const laconic_node_config *config; /* the original, where nobody writes: in flash                    */
    laconic_integrity_limits limits;
    uint8_t checks;
    uint8_t broken;            /* LACONIC_INTEGRITY_OF_…: the last that was found and is not healed     */
    bool has_vehicle;          /* a COMMIT has been accepted                                            */
    uint8_t part;              /* of model and parameters, where the next slice is                      */
    uint32_t at;               /* byte of that part                                                     */
    uint32_t slices, round_us; /* of this round, and when it began                                      */
    uint32_t now_us;           /* of this call                                                          */
    uint32_t rounds;           /* that have found all as it was                                         */
    laconic_memory_sum model, running, shape, motion, queue, loaded;
} laconic_integrity;

/* After laconic_node_init with the same configuration, which must stay where it is. */
void laconic_integrity_begin(laconic_integrity *integrity, const laconic_node *node, const laconic_node_config *config,
                             const laconic_integrity_limits *limits, uint8_t checks);

/* As laconic_node_on_frame, laconic_node_on_tick and laconic_node_next_frame. */
void laconic_integrity_on_frame(laconic_integrity *integrity, laconic_node *node, const laconic_frame *frame,
                                uint32_t now_us);
void laconic_integrity_on_tick(laconic_integrity *integrity, laconic_node *node, uint32_t now_us);
bool laconic_integrity_next_frame(laconic_integrity *integrity, laconic_node *node, laconic_frame *frame);

#endif
