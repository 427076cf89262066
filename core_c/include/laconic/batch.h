/* Many vehicles side by side: each has the bits that laconic_step() gives it alone.
 *
 *     kinds  --place-->  batch  <--load, set_input--  one lane for each vehicle
 *                          |
 *                          +--run-->  rows of numbers, one number for each lane; status of each lane
 *
 * Row x_m holds x of lane 0, of lane 1 …, and so on. The methods' own text steps a register of lanes at once: 2, 4 or 8
 * doubles, twice that number of floats. The width is chosen when the program runs. A lane that leaves the usual path of
 * a step takes that step alone, as slowly as laconic_step(). Examples are a refused step and a yaw of more than a
 * quarter of a radian.
 *
 * Memory   the caller owns it: a laconic_batch, the kinds, and one piece of laconic_batch_size() bytes. No heap.
 * Threads  laconic_batch_run(), _run_sampled() and _observe() of different blocks may run at the same time; all else
 *          alone.
 * Cost     docs/batch.md has a table: with AVX2 about a third of laconic_step(), with AVX-512 half of that, in
 *          single precision again half. Memory: some 300 bytes for a lane, and where kinds are many some 4 KB for
 *          each, laconic_batch_kind included.
 * Limits   ideal ground and motors without limits; held inputs. With compilers other than gcc and clang lanes step one
 *          by one. */
#ifndef LACONIC_BATCH_H
#define LACONIC_BATCH_H

#include "laconic/articulated.h"
#include "laconic/articulated_friction.h"
#include "laconic/laconic.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The common part of many lanes: a vehicle with its method and step. */
typedef struct laconic_batch_kind {
    laconic_model model;
    laconic_integrator integrator;
} laconic_batch_kind;

/* Refuses as laconic_prepare and laconic_integrator_prepare do, and METHOD_WITHOUT_FRICTION where the vehicle has
 * friction or a drive. */
laconic_status laconic_batch_kind_of(laconic_batch_kind *kind, const laconic_vehicle *vehicle,
                                     const laconic_method *method, laconic_real step_s, laconic_refusal *why);

/* How large a batch is. */
typedef struct laconic_batch_shape {
    int32_t lane_count;  /* 1 … 2²⁸                                                       */
    int32_t kind_count;  /* 1 … lane_count                                                */
    int32_t wheel_count; /* of the kind with most wheels, 0 … LACONIC_MAX_WHEELS          */
    int32_t width_bytes; /* of a register: 64, 32, 16; 1: lanes one by one; 0: the widest */
} laconic_batch_shape;

/* The width as given, 0 where this processor or this build lacks it; of 0 the widest that they have. */
int32_t laconic_batch_width(int32_t width_bytes);

/* Read what is documented here; laconic_batch_place() sets all of it. */
typedef struct laconic_batch {
    laconic_batch_shape shape; /* width_bytes is the one that was chosen              */
    int32_t block_count;       /* what laconic_batch_run() counts by                  */
    size_t row_bytes;          /* from a row to the next                              */
    unsigned char *rows;
    int32_t *status;                 /* of each lane after a run: OK, or why its next step was refused */
    uint64_t *missed;                /* steps of each lane since it was loaded that it did not take     */
    const laconic_batch_kind *kinds; /* the caller's, who keeps them while the batch is used */
    int32_t *kind_of;                /* of each lane, the batch's own copy                  */
    int32_t *order;                  /* lanes in the order of the blocks                    */
    int32_t *slot_of;                /* of each lane, its place in that order               */
    struct laconic_batch_block *blocks;
    const struct lanes_width *width; /* NULL: one by one                                    */
} laconic_batch;

/* Bytes of memory that laconic_batch_place() needs on this processor; 0 where the shape is out of bounds. */
size_t laconic_batch_size(const laconic_batch_shape *shape);

/* Places a batch in memory of laconic_batch_size() bytes that begins at a multiple of 64. All lanes are at rest at the
 * origin without input. kind_of: the index of each lane's kind; NULL: all are of kind 0. Returns false, and changes
 * nothing, where the shape is out of bounds, the memory not aligned, a lane of no kind, or a kind has more wheels than
 * the shape. O(n log n) for n lanes. */
bool laconic_batch_place(laconic_batch *batch, void *memory, const laconic_batch_shape *shape,
                         const laconic_batch_kind *kinds, const int32_t *kind_of);

/* Makes the constants of a lane anew from its kind, which the program has changed. Load the lane, and every other
 * one of that kind, with a state of the new model afterwards. Returns false, and changes nothing, where the new kind
 * steps in another way than the old one. Examples are another method (`chosen` of its integrator), fast instead of slow
 * damping (`stiff`), another number of wheels, or a slope. Precondition: 0 <= lane < lane_count. O(1). */
bool laconic_batch_renew(laconic_batch *batch, int32_t lane);

/* A lane's state and input, to and from the structs of laconic.h, bit by bit; what is for wheels that the lane's
 * vehicle lacks stays as it was. Loading makes the lane's status OK and `missed` 0. Precondition: 0 <= lane <
 * lane_count. */
void laconic_batch_load(laconic_batch *batch, int32_t lane, const laconic_state *state);
void laconic_batch_store(const laconic_batch *batch, int32_t lane, laconic_state *state);
void laconic_batch_set_input(laconic_batch *batch, int32_t lane, const laconic_input *input);
void laconic_batch_input(const laconic_batch *batch, int32_t lane, laconic_input *input);

/* Rows of inputs, which programs may write themselves, and of outputs, which they read: lane_count numbers, in units of
 * laconic_input. `wheel`, from 0, counts for the first two alone. NULL for a row that there is not. */
typedef enum laconic_batch_row {
    LACONIC_BATCH_VOLTAGE,
    LACONIC_BATCH_AXLE_TORQUE,
    LACONIC_BATCH_BODY_FORCE_X,
    LACONIC_BATCH_BODY_FORCE_Y,
    LACONIC_BATCH_BODY_MOMENT,
    LACONIC_BATCH_WORLD_FORCE_X,
    LACONIC_BATCH_WORLD_FORCE_Y,
    LACONIC_BATCH_WORLD_FORCE_POINT_X,
    LACONIC_BATCH_WORLD_FORCE_POINT_Y,
    LACONIC_BATCH_X, /* x and y of S [m], always those of the state                       */
    LACONIC_BATCH_Y,
    LACONIC_BATCH_HEADING, /* unwrapped [rad]; this and the next by laconic_batch_observe()         */
    LACONIC_BATCH_NU_1,    /* ν [rad/s]                                                   */
    LACONIC_BATCH_NU_2,
    LACONIC_BATCH_NU_3,
    LACONIC_BATCH_ROW_COUNT
} laconic_batch_row;
laconic_real *laconic_batch_row_of(const laconic_batch *batch, laconic_batch_row row, int32_t wheel);

/* Takes `steps` steps of all lanes of some blocks with the inputs held, as laconic_run() does of one. A lane stops
 * before the first step that is refused, and the others continue. `status` and `missed` report on each lane. Returns
 * how many lanes were refused. Precondition: 0 <= first_block, first_block + blocks <= block_count. */
int32_t laconic_batch_run(laconic_batch *batch, int32_t first_block, int32_t blocks, uint64_t steps);

/* The same with new voltages after every `steps_each` steps, `samples` times. voltage_V has for each sample a row
 * for each of the shape's wheels, of lane_count numbers [V]; they are written into the rows of voltages before their
 * steps. Afterwards the rows hold the voltages of a lane's last step, or of the one that was refused, after which it
 * takes none. As bits it is laconic_batch_run() for each sample; it costs less where kinds are many, since a few
 * blocks take all their steps before the next. */
int32_t laconic_batch_run_sampled(laconic_batch *batch, int32_t first_block, int32_t blocks, uint64_t samples,
                                  uint64_t steps_each, const laconic_real *voltage_V);

/* Sets heading and ν of all lanes of some blocks, as laconic_position() and laconic_nu() do. */
void laconic_batch_observe(laconic_batch *batch, int32_t first_block, int32_t blocks);

/* For populations whose vehicles differ in their numbers: arrays with one item for each vehicle. Each of the first
 * three returns how many vehicles were refused, whose `status` is not OK; the single function reports the reason. */

/* Kinds as laconic_batch_kind_of() makes them; of a vehicle that is refused the kind is not written. motors: NULL, or
 * those that laconic_motor_fit() fits to a copy of each vehicle before. About 1 us for each. */
int32_t laconic_batch_kinds_of(laconic_batch_kind *kinds, int32_t *status, const laconic_vehicle *vehicles,
                               const laconic_motor *motors, int32_t count, const laconic_method *method,
                               laconic_real step_s);

/* Puts lanes from first_lane on at starts, as laconic_state_set() does; a lane that is refused stays as it was, and
 * batch->status says why. */
int32_t laconic_batch_start(laconic_batch *batch, int32_t first_lane, int32_t lanes, const laconic_start *starts);

/* Contacts as laconic_contact_prepare() makes them, vehicles and motors as for the kinds. */
int32_t laconic_batch_contacts_of(laconic_contact *contacts, int32_t *status, const laconic_vehicle *vehicles,
                                  const laconic_motor *motors, int32_t count);

/* Outputs of lanes from first_lane on with their present input, as laconic_outputs_of() gives them. contacts: NULL,
 * or one for each of these lanes; then also the reactions. */
void laconic_batch_outputs(const laconic_batch *batch, int32_t first_lane, int32_t lanes,
                           const laconic_contact *contacts, laconic_outputs *outputs);

/* ------------------------------------------------------------------------ vehicles with hinges -- */

#if LACONIC_MAX_BODIES > 0

/* A prepared vehicle with hinges; lanes may share it. The model is the caller's. */
typedef struct laconic_articulated_kind {
    const laconic_articulated_model *model; /* on ideal ground                          */
    laconic_articulated_integrator integrator;
#if LACONIC_WITH_FRICTION
    const laconic_tree_model *tree; /* on ground with friction: instead of the two above; NULL: on ideal ground */
    laconic_real tree_step_s;
#endif
} laconic_articulated_kind;

/* The caller fills it with arrays of its own, one item for each lane. States are set by
 * laconic_articulated_state_set(), those of trees by laconic_tree_state_set(). States and inputs of a ground that no
 * kind has may be NULL. */
typedef struct laconic_articulated_batch {
    const laconic_articulated_kind *kinds;
    const int32_t *kind_of; /* of each lane, from 0                       */
    laconic_articulated_state *states;
    const laconic_articulated_input *inputs;
#if LACONIC_WITH_FRICTION
    laconic_tree_state *tree_states;
    const laconic_tree_input *tree_inputs;
#endif
    laconic_refusal *why; /* of a refused lane                          */
    int32_t *status;      /* of the last run; a laconic_status          */
    uint64_t *missed;     /* steps that a lane did not take, counted on */
} laconic_articulated_batch;

/* Takes `steps` steps of some lanes with the inputs held, each by laconic_articulated_step() or laconic_tree_step(), so
 * with its bits and its cost. A lane stops before the first step that is refused, and the others continue. Returns how
 * many lanes were refused. Runs of different lanes may take place at the same time. */
int32_t laconic_articulated_batch_run(laconic_articulated_batch *batch, int32_t first_lane, int32_t lanes,
                                      uint64_t steps);

/* Motions of some lanes, as laconic_articulated_motion_of() or laconic_tree_motion_of() gives them. */
void laconic_articulated_batch_observe(const laconic_articulated_batch *batch, int32_t first_lane, int32_t lanes,
                                       laconic_articulated_motion *motions);

#if LACONIC_WITH_FRICTION
/* All outputs of some lanes, which are on ground with friction. */
void laconic_articulated_batch_outputs(const laconic_articulated_batch *batch, int32_t first_lane, int32_t lanes,
                                       laconic_tree_outputs *outputs);
#endif

#endif

#ifdef __cplusplus
}
#endif

#ifndef LACONIC_IN_CORE /* build.h */
#define laconic_batch_kind_of(...) (laconic_check_build(), laconic_batch_kind_of(__VA_ARGS__))
#define laconic_batch_kinds_of(...) (laconic_check_build(), laconic_batch_kinds_of(__VA_ARGS__))
#define laconic_batch_place(...) (laconic_check_build(), laconic_batch_place(__VA_ARGS__))
#endif

#endif
