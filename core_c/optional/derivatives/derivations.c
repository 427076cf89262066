/* Which steps a method may take, and how each is differentiated: a table for each method, so that what names one links
 * that one alone. */
#include "step_change.h"

#define NO_STEP {NULL, NULL}
#define ONE_STEP(method, responds) {{&method, responds}, NO_STEP, NO_STEP}

static const laconic_derived_method derived_rk4 = {&laconic_rk4, ONE_STEP(laconic_rk4, laconic_rk4_responses)};
static const laconic_derived_method derived_taylor_8 = {&laconic_taylor_8,
                                                        ONE_STEP(laconic_taylor_8, laconic_taylor_8_responses)};
static const laconic_derived_method derived_kahan = {&laconic_exponential_kahan,
                                                     ONE_STEP(laconic_exponential_kahan, laconic_kahan_responses)};
static const laconic_derived_method derived_kahan_4 = {
    &laconic_exponential_kahan_4, ONE_STEP(laconic_exponential_kahan_4, laconic_kahan_4_responses)};
static const laconic_derived_method derived_flow = {&laconic_exact_flow,
                                                    ONE_STEP(laconic_exact_flow, laconic_flow_responses)};
static const laconic_derived_method derived_flow_4 = {&laconic_exact_flow_4,
                                                      ONE_STEP(laconic_exact_flow_4, laconic_flow_4_responses)};

#if LACONIC_WITH_EXPONENTIAL_GAUSS
static const laconic_derived_method derived_gauss = {&laconic_exponential_gauss_8,
                                                     ONE_STEP(laconic_exponential_gauss_8, laconic_gauss_responses)};
const laconic_derivation laconic_derivation_of_exponential_gauss_8 = {{&derived_gauss}};

/* By the rule of auto.c. */
static const laconic_derived_method derived_slow = {&laconic_auto_slow,
                                                    {{&laconic_exponential_gauss_8, laconic_gauss_responses},
                                                     {&laconic_exact_flow_4, laconic_flow_4_responses},
                                                     {&laconic_exact_flow, laconic_flow_responses}}};
static const laconic_derived_method derived_fast = {&laconic_auto_fast,
                                                    {{&laconic_exponential_gauss_8, laconic_gauss_responses},
                                                     {&laconic_exponential_kahan_4, laconic_kahan_4_responses},
                                                     {&laconic_exact_flow, laconic_flow_responses}}};
const laconic_derivation laconic_derivation_of_auto = {{&derived_slow, &derived_fast}};
const laconic_derivation laconic_derivation_of_auto_slow = {{&derived_slow}};
const laconic_derivation laconic_derivation_of_auto_fast = {{&derived_fast}};
#define DERIVED_GAUSS , &derived_gauss, &derived_slow, &derived_fast
#else
#define DERIVED_GAUSS
#endif

const laconic_derivation laconic_derivation_of_rk4 = {{&derived_rk4}};
const laconic_derivation laconic_derivation_of_taylor_8 = {{&derived_taylor_8}};
const laconic_derivation laconic_derivation_of_exponential_kahan = {{&derived_kahan}};
const laconic_derivation laconic_derivation_of_exponential_kahan_4 = {{&derived_kahan_4}};
const laconic_derivation laconic_derivation_of_exact_flow = {{&derived_flow}};
const laconic_derivation laconic_derivation_of_exact_flow_4 = {{&derived_flow_4}};
const laconic_derivation laconic_derivation_of_all = {
    {&derived_rk4, &derived_taylor_8, &derived_kahan, &derived_kahan_4, &derived_flow, &derived_flow_4 DERIVED_GAUSS}};
