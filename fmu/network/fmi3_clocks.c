/* The functions of FMI 3.0 for clocks and binary variables, of FMUs with bus terminals.
 *
 * Tx_Clock is a triggered output or a countdown input, as the description says; the calls of either kind work. A
 * triggered one activates in event iterations after a step (network_port.h), never within one, as FMI-LS-BUS demands. A
 * countdown's interval is given anew in each event iteration. Its resolution is a microsecond. */
#include "fmi3Functions.h"

#include "model_interface.h"

#define SELF(instance) ((fmu_instance *)(instance))
#define TICKS_PER_S 1000000U

static fmi3Status to_fmi(fmu_status status) { return (fmi3Status)status; }

static bool is_allowed(const fmu_instance *instance, const char *what) {
    if (instance->mode == FMU_EVENT || instance->mode == FMU_INITIALIZATION) return true;
    fmu_refuse(instance, "%s is not allowed in %s", what, fmu_mode_names[instance->mode]);
    return false;
}

static bool find(const fmu_instance *instance, fmu_type type, uint32_t reference, const fmu_variable **variable) {
    *variable = reference < fmu_variable_count ? &fmu_variables[reference] : NULL;
    if (*variable != NULL && (*variable)->type == type) return true;
    fmu_refuse(instance, "there is no %s with the value reference %u", type == FMU_CLOCK ? "Clock" : "Binary",
               (unsigned)reference);
    return false;
}

/* Clocks and binary variables are located by members of network_port. */
static network_port *port_of(fmu_instance *instance, const fmu_variable *variable) {
    return &instance->model.port[(variable->offset - offsetof(fmu_model, port)) / sizeof(network_port)];
}

static bool is_rx_clock(fmu_instance *instance, const fmu_variable *variable) {
    const network_port *port = port_of(instance, variable);
    return (const char *)&instance->model + variable->offset == (const char *)&port->rx_clock;
}

static bool has_lists(const fmu_instance *instance, size_t count, const void *references, const void *values) {
    if (count == 0 || (references != NULL && values != NULL)) return true;
    fmu_refuse(instance, "a list of value references or values is missing (NULL)");
    return false;
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        fmi3Clock values[]) {
    fmu_instance *self = SELF(instance);
    const fmu_variable *variable;
    if (self == NULL || !is_allowed(self, "GetClock")) return fmi3Error;
    if (!has_lists(self, nValueReferences, valueReferences, values)) return fmi3Error;
    for (size_t k = 0; k < nValueReferences; k++) {
        if (!find(self, FMU_CLOCK, valueReferences[k], &variable)) return fmi3Error;
        network_port *port = port_of(self, variable);
        values[k] = is_rx_clock(self, variable) ? port->rx_clock : port->is_ready; /* true once for each activation */
        if (!is_rx_clock(self, variable) && port->is_ready) network_port_activate(port);
    }
    return fmi3OK;
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        const fmi3Clock values[]) {
    fmu_instance *self = SELF(instance);
    const fmu_variable *variable;
    if (self == NULL || !is_allowed(self, "SetClock")) return fmi3Error;
    if (!has_lists(self, nValueReferences, valueReferences, values)) return fmi3Error;
    for (size_t k = 0; k < nValueReferences; k++)
        if (!find(self, FMU_CLOCK, valueReferences[k], &variable)) return fmi3Error;
    for (size_t k = 0; k < nValueReferences; k++) {
        variable = &fmu_variables[valueReferences[k]];
        if (is_rx_clock(self, variable))
            port_of(self, variable)->rx_clock = values[k];
        else if (values[k])
            network_port_activate(port_of(self, variable));
    }
    return fmi3OK;
}

/* Without an active clock there is nothing to send. */
fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         size_t valueSizes[], fmi3Binary values[], size_t nValues) {
    fmu_instance *self = SELF(instance);
    const fmu_variable *variable;
    if (self == NULL) return fmi3Error;
    if (!FMU_MAY_CALL(self, FMU_CALL_GET)) return fmi3Error;
    if (nValues != nValueReferences || (nValues > 0 && valueSizes == NULL) ||
        !has_lists(self, nValues, valueReferences, values))
        return to_fmi(fmu_refuse(self, "GetBinary: give one value and one size for each reference"));
    for (size_t k = 0; k < nValues; k++) {
        if (!find(self, FMU_BINARY, valueReferences[k], &variable)) return fmi3Error;
        network_port *port = port_of(self, variable);
        const bool is_tx = variable->access == FMU_OUTPUT;
        values[k] = is_tx ? port->tx.bytes : port->rx.bytes;
        valueSizes[k] = is_tx ? port->offered : port->rx.size;
    }
    return fmi3OK;
}

static bool check_binary(const fmu_instance *instance, uint32_t reference, size_t size, fmi3Binary value) {
    const fmu_variable *variable;
    if (!find(instance, FMU_BINARY, reference, &variable)) return false;
    if (variable->access != FMU_INPUT) {
        fmu_refuse(instance, "%s cannot be set: it is computed by the model", fmu_name_of(variable));
        return false;
    }
    if (size <= LS_BUS_BUFFER_BYTES && (size == 0 || value != NULL)) return true;
    fmu_refuse(instance, "%s: %zu bytes given, at most %u are possible; take shorter communication steps",
               fmu_name_of(variable), size, LS_BUS_BUFFER_BYTES);
    return false;
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         const size_t valueSizes[], const fmi3Binary values[], size_t nValues) {
    fmu_instance *self = SELF(instance);
    if (self == NULL) return fmi3Error;
    if (!FMU_MAY_CALL(self, FMU_CALL_SET_DISCRETE)) return fmi3Error;
    if (nValues != nValueReferences || (nValues > 0 && valueSizes == NULL) ||
        !has_lists(self, nValues, valueReferences, values))
        return to_fmi(fmu_refuse(self, "SetBinary: give one value and one size for each reference"));
    for (size_t k = 0; k < nValues; k++)
        if (!check_binary(self, valueReferences[k], valueSizes[k], values[k])) return fmi3Error;
    for (size_t k = 0; k < nValues; k++) {
        ls_bus_buffer *rx = &port_of(self, &fmu_variables[valueReferences[k]])->rx;
        rx->size = valueSizes[k];
        for (size_t i = 0; i < rx->size; i++) rx->bytes[i] = values[k][i];
    }
    return fmi3OK;
}

/* ------------------------------------------------------------------------------------- intervals -- */

/* Seconds to the next tick of a Tx_Clock; false: refused. */
static bool countdown(fmu_instance *self, uint32_t reference, double *seconds) {
    const fmu_variable *variable;
    if (!find(self, FMU_CLOCK, reference, &variable)) return false;
    if (is_rx_clock(self, variable)) {
        fmu_refuse(self, "%s is triggered: it has no interval", fmu_name_of(variable));
        return false;
    }
    if (fmu_apply_parameters(self) != FMU_OK) return false;
    *seconds = fmu_model_countdown(self);
    return true;
}

#define FOR_EACH_INTERVAL(name, missing, ...) \
    fmu_instance *self = SELF(instance); \
    double seconds; \
    if (self == NULL || !is_allowed(self, name)) return fmi3Error; \
    if (nValueReferences > 0 && (valueReferences == NULL || qualifiers == NULL || (missing))) \
        return to_fmi(fmu_refuse(self, name ": a list is missing (NULL)")); \
    for (size_t k = 0; k < nValueReferences; k++) { \
        if (!countdown(self, valueReferences[k], &seconds)) return fmi3Error; \
        qualifiers[k] = seconds > 0.0 ? fmi3IntervalChanged : fmi3IntervalNotYetKnown; \
        __VA_ARGS__; \
    } \
    return fmi3OK

fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                                  size_t nValueReferences, fmi3Float64 intervals[],
                                  fmi3IntervalQualifier qualifiers[]) {
    FOR_EACH_INTERVAL("GetIntervalDecimal", intervals == NULL, intervals[k] = seconds);
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference valueReferences[],
                                   size_t nValueReferences, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                   fmi3IntervalQualifier qualifiers[]) {
    FOR_EACH_INTERVAL("GetIntervalFraction", counters == NULL || resolutions == NULL,
                      counters[k] = (fmi3UInt64)(seconds * TICKS_PER_S + 0.5), resolutions[k] = TICKS_PER_S);
}

#define NO_INTERVAL(Name, unread, ...) \
    fmi3Status fmi3##Name(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, \
                          __VA_ARGS__) { \
        (void)valueReferences; \
        unread; \
        if (instance == NULL) return fmi3Error; \
        return to_fmi(fmu_refuse_kind(SELF(instance), "periodic Clock", nValueReferences)); \
    }

NO_INTERVAL(GetShiftDecimal, (void)shifts, fmi3Float64 shifts[])
NO_INTERVAL(SetShiftDecimal, (void)shifts, const fmi3Float64 shifts[])
NO_INTERVAL(SetIntervalDecimal, (void)intervals, const fmi3Float64 intervals[])
NO_INTERVAL(GetShiftFraction, ((void)counters, (void)resolutions), fmi3UInt64 counters[], fmi3UInt64 resolutions[])
NO_INTERVAL(SetShiftFraction, ((void)counters, (void)resolutions), const fmi3UInt64 counters[],
            const fmi3UInt64 resolutions[])
NO_INTERVAL(SetIntervalFraction, ((void)counters, (void)resolutions), const fmi3UInt64 counters[],
            const fmi3UInt64 resolutions[])
