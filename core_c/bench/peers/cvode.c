/* SUNDIALS CVODE as its manual sets it up: dense Newton for BDF, fixed-point iteration for Adams, one vector,
 * restarted where the voltages jump. */
#include "peer.h"

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

static int right_hand_side(realtype t, N_Vector state, N_Vector rates, void *voltage_V) {
    (void)t;
    peer_derivative(N_VGetArrayPointer(state), voltage_V, N_VGetArrayPointer(rates));
    return 0;
}

typedef struct solver {
    SUNContext context;
    N_Vector state;
    SUNMatrix matrix;
    SUNLinearSolver linear;
    SUNNonlinearSolver nonlinear;
    void *memory;
} solver;

static int solver_open(solver *s, int bdf, double rtol, double atol) {
    memset(s, 0, sizeof *s);
    if (SUNContext_Create(NULL, &s->context) != 0) return 1;
    s->state = N_VNew_Serial(PEER_STATES, s->context);
    memset(N_VGetArrayPointer(s->state), 0, PEER_STATES * sizeof(double));
    memcpy(N_VGetArrayPointer(s->state), peer_start, sizeof peer_start);
    s->memory = CVodeCreate(bdf ? CV_BDF : CV_ADAMS, s->context);
    if (CVodeInit(s->memory, right_hand_side, 0.0, s->state) != CV_SUCCESS) return 1;
    if (CVodeSStolerances(s->memory, rtol, atol) != CV_SUCCESS) return 1;
    CVodeSetMaxNumSteps(s->memory, 1000000);
    if (bdf) {
        s->matrix = SUNDenseMatrix(PEER_STATES, PEER_STATES, s->context);
        s->linear = SUNLinSol_Dense(s->state, s->matrix, s->context);
        return CVodeSetLinearSolver(s->memory, s->linear, s->matrix) != CV_SUCCESS;
    }
    s->nonlinear = SUNNonlinSol_FixedPoint(s->state, 0, s->context);
    return CVodeSetNonlinearSolver(s->memory, s->nonlinear) != CV_SUCCESS;
}

static void solver_close(solver *s) {
    CVodeFree(&s->memory);
    if (s->linear) SUNLinSolFree(s->linear);
    if (s->matrix) SUNMatDestroy(s->matrix);
    if (s->nonlinear) SUNNonlinSolFree(s->nonlinear);
    N_VDestroy(s->state);
    SUNContext_Free(&s->context);
}

static int one_segment(solver *s, int segment, double *t) {
    const double end = *t + peer_segment_s[segment];
    double reached = *t;
    CVodeSetUserData(s->memory, (void *)peer_voltage_V[segment]);
    if (segment > 0 && CVodeReInit(s->memory, *t, s->state) != CV_SUCCESS) return 1;
    CVodeSetStopTime(s->memory, end);
    *t = end;
    return CVode(s->memory, end, s->state, &reached, CV_NORMAL) < 0;
}

/* The whole schedule once; `states` gets the state at each segment's end. Returns 0 iff it is done. */
int peer_cvode(int bdf, double rtol, double atol, double *states) {
    solver s;
    double t = 0;
    int failed = solver_open(&s, bdf, rtol, atol);
    for (int segment = 0; segment < PEER_SEGMENTS && !failed; segment++) {
        failed = one_segment(&s, segment, &t);
        memcpy(states + segment * PEER_STATES, N_VGetArrayPointer(s.state), PEER_STATES * sizeof(double));
    }
    solver_close(&s);
    return failed;
}
