/* A bus terminal of an FMU, and what the glue asks of a model that has some (its member `port`, FMU_MODEL_PORTS of
 * them). The glue knows operations only as bytes. */
#ifndef LACONIC_FMU_NETWORK_PORT_H
#define LACONIC_FMU_NETWORK_PORT_H

#include "ls_bus.h"

typedef struct network_port {
    bool rx_clock;  /* has been activated for this event iteration                                  */
    bool tx_clock;  /* is active in this event iteration: the first `offered` bytes of tx are sent   */
    size_t due;     /* bytes of tx that a triggered Tx_Clock sends at this communication point       */
    bool is_due;    /* ... which has still to activate                                               */
    bool is_ready;  /* ... in this event iteration                                                   */
    bool again;     /* another event iteration is needed                                             */
    size_t offered; /* bytes of tx that this activation of Tx_Clock sends                            */
    ls_bus_buffer rx, tx;
} network_port;

/* A model with ports has no derivatives, and no motion to restore when a step is refused. */
typedef struct fmu_tangent {
    double none;
} fmu_tangent;

typedef struct fmu_model_motion {
    double none;
} fmu_model_motion;

struct fmu_instance;

/* False, with a line in the log, for a start time from which no microsecond can be told. Models ask when they start. */
bool network_may_start(const struct fmu_instance *instance);
/* Takes the operations in `rx` of all ports whose Rx_Clock is active. */
void fmu_model_receive(struct fmu_instance *instance);
/* Time passes from model.time_s to end_s. */
void fmu_model_advance(struct fmu_instance *instance, double end_s);
/* Seconds from now to the next instant at which the model may have something to send, more than 0; 0: not known. */
double fmu_model_countdown(const struct fmu_instance *instance);

/* A step has ended: what is to be sent is due at this communication point. */
void network_ports_make_due(network_port *ports, size_t count);
/* Whether a triggered Tx_Clock is to activate. */
bool network_ports_are_due(const network_port *ports, size_t count);
/* The event iteration ends: what was sent and received goes, and the clocks are inactive again.
 *
 * A triggered Tx_Clock activates in the second iteration of a communication point, and a third one follows. Importers
 * differ in whether they give to the receiver what a clock sends in the same iteration or in the one after it; in the
 * first iteration some (the FMU manipulation toolbox 2.0) have forgotten it when the receiver's turn comes. */
void network_ports_settle(network_port *ports, size_t count);
bool network_ports_need_update(const network_port *ports, size_t count);
/* Tx_Clock activates, by the importer or by the model. */
void network_port_activate(network_port *port);

#endif
