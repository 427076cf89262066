/* Which call is allowed in which mode: one table for both FMI versions (FMI 2.0.4 §3.2.3 and §4.2.4,
 * FMI 3.0.1 §2.3, §3.2 and §4.2). */
#ifndef LACONIC_FMU_LIFECYCLE_H
#define LACONIC_FMU_LIFECYCLE_H

#include <stdint.h>

typedef enum fmu_mode {
    FMU_INSTANTIATED,
    FMU_CONFIGURATION, /* FMI 3 */
    FMU_INITIALIZATION,
    FMU_EVENT,
    FMU_CONTINUOUS,   /* Model Exchange: continuous-time mode */
    FMU_STEP,         /* Co-Simulation: FMI 3 step mode, FMI 2 stepComplete */
    FMU_INTERMEDIATE, /* FMI 3: inside the callback of a step */
    FMU_TERMINATED,
    FMU_MODE_COUNT
} fmu_mode;

typedef enum fmu_call {
    FMU_CALL_SET_DEBUG_LOGGING,
    FMU_CALL_SETUP_EXPERIMENT,
    FMU_CALL_ENTER_CONFIGURATION,
    FMU_CALL_EXIT_CONFIGURATION,
    FMU_CALL_ENTER_INITIALIZATION,
    FMU_CALL_EXIT_INITIALIZATION,
    FMU_CALL_ENTER_EVENT,
    FMU_CALL_UPDATE_DISCRETE_STATES,
    FMU_CALL_ENTER_CONTINUOUS_TIME,
    FMU_CALL_ENTER_STEP,
    FMU_CALL_TERMINATE,
    FMU_CALL_RESET,
    FMU_CALL_GET,
    FMU_CALL_SET_CONTINUOUS,
    FMU_CALL_SET_DISCRETE,
    FMU_CALL_STATE_OF_FMU,
    FMU_CALL_PARTIAL_DERIVATIVE,
    FMU_CALL_DEPENDENCIES,
    FMU_CALL_SET_TIME,
    FMU_CALL_SET_STATES,
    FMU_CALL_GET_STATES,
    FMU_CALL_GET_RATES,
    FMU_CALL_GET_NOMINALS,
    FMU_CALL_COUNT_STATES,
    FMU_CALL_COMPLETED_STEP,
    FMU_CALL_DO_STEP,
    FMU_CALL_CANCEL_STEP,
    FMU_CALL_STEP_STATUS,
    FMU_CALL_INPUT_DERIVATIVES,
    FMU_CALL_OUTPUT_DERIVATIVES,
    FMU_CALL_COUNT
} fmu_call;

typedef struct fmu_rule {
    const char *what;                                            /* for messages                        */
    uint16_t exchange_2, simulation_2, exchange_3, simulation_3; /* bit per mode in which it is allowed */
} fmu_rule;

extern const fmu_rule fmu_rules[FMU_CALL_COUNT];
extern const char *const fmu_mode_names[FMU_MODE_COUNT];

#endif
