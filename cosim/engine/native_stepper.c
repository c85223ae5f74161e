/* The master's loop in C: steps components over a range of ticks by the FMUs' own functions, FMI 2.0 and 3.0 mixed.
 *
 * It does what cosim/engine/python_stepper.py does, over the same table and buffers, to the same bits. The structures
 * are those of cosim/engine/native_stepper.py, which fills them. Nothing is allocated here and nothing outlives a call.
 */
#include "source.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#define INLINE inline __attribute__((always_inline)) /* a tick is short: calls would take a good part of it */

enum { WORST_ACCEPTED = 1 }; /* a warning: FMI 2.0 and 3.0 number their status alike */

typedef void (*Function)(void); /* of an FMU; called by its own type */
typedef void Notice(void);      /* of the world outside */

typedef int Access2(void *instance, const uint32_t *references, size_t count, void *values);
typedef int Access3(void *instance, const uint32_t *references, size_t count, void *values, size_t value_count);
typedef int DoStep2(void *instance, double time, double step, int no_return);
typedef int DoStep3(void *instance, double time, double step, bool no_return, bool *event, bool *terminate, bool *early,
                    double *reached);

/* Types of values, in the order of cosim/engine/native_stepper.py. */
#define EACH_TYPE(DO)                                                                                                  \
    DO(0, double)                                                                                                      \
    DO(1, float) DO(2, bool) DO(3, int8_t) DO(4, int16_t) DO(5, int32_t) DO(6, int64_t) DO(7, uint8_t) DO(8, uint16_t) \
        DO(9, uint32_t) DO(10, uint64_t)

enum { TYPE_DOUBLE = 0 };

/* Some variables of one type that one call moves between an FMU and the table. */
typedef struct {
    Function function;
    const uint32_t *references;
    void *buffer;
    const int64_t *places;           /* NULL of an output that is read right into the table */
    const double *factors, *offsets; /* NULL where values stay as they are */
    int64_t count, type, discrete;
    int64_t warned; /* whether the world outside knows that this call warns in this run */
} Port;

typedef struct {
    void *instance;
    Function step;
    Port *inputs, *outputs;
    int64_t input_count, output_count, standard;
    int64_t every, parts; /* it steps at every n-th tick, in so many parts */
    double step_size;     /* of one part, in s */
    int64_t warned;       /* as of a port: whether its step does */
} Component;

/* A value that is recorded: table[place] into a row's column. */
typedef struct {
    int64_t column, place;
} Cell;

typedef enum { NOTHING, SETTING, STEPPING, GETTING, ASKED_TO_END, RETURNED_EARLY, NOT_FINITE } Cause;

/* What is called now, so that who hears an FMU's message can tell where it comes from; in the end, what went wrong. */
typedef struct {
    const Component *component;
    int64_t cause, which, status; /* which: input or output port, or part of a step */
    double reached;
} Now;

typedef struct {
    Component *components;  /* in their order */
    double *table, *before; /* all outputs' values; room for as many */
    double *rows;           /* where the row of tick `first_recorded` goes; the others follow */
    const Cell *continuous, *discrete;
    int64_t component_count, group, table_size, width, continuous_count, discrete_count, record_every, first_recorded;
    int64_t done; /* number of ticks that are complete */
    double step_size;
    Notice *warned; /* called when a call warns for the first time in a run; `now` says which */
    Now now;
} Plan;

EXPORT const char *stepper_source(void)
{
    return STEPPER_SOURCE;
}

/* ---- what is called and what comes of it ------------------------------------------------------------------------- */

static INLINE void call_begins(Plan *plan, Cause cause, const Component *it, int64_t which)
{
    plan->now.cause = cause;
    plan->now.component = it;
    plan->now.which = which;
}

static bool judge(Plan *plan, int status, int64_t *warned)
{
    plan->now.status = status;
    if (status <= WORST_ACCEPTED && !*warned) {
        *warned = 1;
        plan->warned();
    }
    return status <= WORST_ACCEPTED;
}

/* Whether a run can go on after a call. */
static INLINE bool accepted(Plan *plan, int status, int64_t *warned)
{
    return status == 0 || judge(plan, status, warned);
}

/* ---- exchange of values ------------------------------------------------------------------------------------------ */

static int call_access(const Component *component, const Port *port)
{
    const size_t count = (size_t)port->count;
    return component->standard == 2
               ? ((Access2 *)port->function)(component->instance, port->references, count, port->buffer)
               : ((Access3 *)port->function)(component->instance, port->references, count, port->buffer, count);
}

/* Fill the buffer of a setter from the table. */
static void fill_buffer(const Port *port, const double table[])
{
    if (port->factors != NULL) {
        for (int64_t i = 0; i < port->count; ++i) {
            const double value = port->factors[i] * table[port->places[i]] + port->offsets[i];
            if (port->type == TYPE_DOUBLE) { /* only floating-point numbers are transformed */
                ((double *)port->buffer)[i] = value;
            } else {
                ((float *)port->buffer)[i] = (float)value;
            }
        }
        return;
    }
    switch (port->type) {
#define FILL(code, type_)                                               \
    case code:                                                          \
        for (int64_t i = 0; i < port->count; ++i) {                     \
            ((type_ *)port->buffer)[i] = (type_)table[port->places[i]]; \
        }                                                               \
        break;
        EACH_TYPE(FILL)
#undef FILL
    }
}

/* Empty the buffer of a getter into the table. */
static void empty_buffer(const Port *port, double table[])
{
    switch (port->type) {
#define EMPTY(code, type_)                                                     \
    case code:                                                                 \
        for (int64_t i = 0; i < port->count; ++i) {                            \
            table[port->places[i]] = (double)((const type_ *)port->buffer)[i]; \
        }                                                                      \
        break;
        EACH_TYPE(EMPTY)
#undef EMPTY
    }
}

static INLINE bool take_inputs(Plan *plan, const Component *it)
{
    for (int64_t p = 0; p < it->input_count; ++p) {
        Port *port = &it->inputs[p];
        if (port->type == TYPE_DOUBLE && port->factors == NULL) { /* nearly always */
            double *buffer = port->buffer;
            for (int64_t i = 0; i < port->count; ++i) {
                buffer[i] = plan->table[port->places[i]];
            }
        } else {
            fill_buffer(port, plan->table);
        }
        call_begins(plan, SETTING, it, p);
        if (!accepted(plan, call_access(it, port), &port->warned)) {
            return false;
        }
    }
    return true;
}

typedef enum { CONTINUOUS = 1, DISCRETE = 2, ALL = 3 } Which;

static INLINE bool give_outputs(Plan *plan, const Component *it, Which which)
{
    for (int64_t p = 0; p < it->output_count; ++p) {
        Port *port = &it->outputs[p];
        if ((which & (port->discrete ? DISCRETE : CONTINUOUS)) == 0) {
            continue;
        }
        call_begins(plan, GETTING, it, p);
        if (!accepted(plan, call_access(it, port), &port->warned)) {
            return false;
        }
        if (port->places != NULL) {
            empty_buffer(port, plan->table);
        }
    }
    return true;
}

/* ---- initialisation ---------------------------------------------------------------------------------------------- */

static bool differs(const Plan *plan)
{
    for (int64_t i = 0; i < plan->table_size; ++i) {
        const double a = plan->before[i], b = plan->table[i];
        if (a != b && (a == a || b == b)) {
            return true;
        }
    }
    return false;
}

/* A run begins: nobody has warned. */
static void forget_warnings(const Plan *plan)
{
    for (int64_t i = 0; i < plan->component_count; ++i) {
        Component *it = &plan->components[i];
        it->warned = 0;
        for (int64_t p = 0; p < it->input_count; ++p) {
            it->inputs[p].warned = 0;
        }
        for (int64_t p = 0; p < it->output_count; ++p) {
            it->outputs[p].warned = 0;
        }
    }
}

/* Pass initial outputs along the connections until they settle, at most as often as the longest chain asks for. */
EXPORT bool stepper_settle(Plan *plan)
{
    const Component *const end = plan->components + plan->component_count;
    forget_warnings(plan);
    bool moving = true;
    for (int64_t round = 0; round < plan->component_count && moving; ++round) {
        memcpy(plan->before, plan->table, (size_t)plan->table_size * sizeof *plan->table);
        for (const Component *it = plan->components; it < end; ++it) {
            if (!take_inputs(plan, it) || !give_outputs(plan, it, ALL)) {
                return false;
            }
        }
        moving = differs(plan);
    }
    return true;
}

/* Read all outputs. */
EXPORT bool stepper_read(Plan *plan)
{
    const Component *const end = plan->components + plan->component_count;
    for (const Component *it = plan->components; it < end; ++it) {
        if (!give_outputs(plan, it, ALL)) {
            return false;
        }
    }
    return true;
}

/* ---- steps ------------------------------------------------------------------------------------------------------- */

static INLINE bool do_part(Plan *plan, Component *it, int64_t number, int64_t part)
{
    const double time = (double)(number + part) * it->step_size;
    call_begins(plan, STEPPING, it, part);
    if (it->standard == 2) {
        return accepted(plan, ((DoStep2 *)it->step)(it->instance, time, it->step_size, 1), &it->warned);
    }
    bool event = false, terminate = false, early = false;
    const int status =
        ((DoStep3 *)it->step)(it->instance, time, it->step_size, true, &event, &terminate, &early, &plan->now.reached);
    if (!accepted(plan, status, &it->warned)) {
        return false;
    }
    if (terminate || early) {
        plan->now.cause = terminate ? ASKED_TO_END : RETURNED_EARLY;
        return false;
    }
    return true;
}

static bool advance(Plan *plan, Component *it, int64_t tick)
{
    for (int64_t part = 0; part < it->parts; ++part) {
        if (!do_part(plan, it, tick / it->every * it->parts, part)) {
            return false;
        }
    }
    return true;
}

/* Which outputs a component gives in this tick: a sample's at its begin, what is continuous at the end of the step. */
static Which given(const Component *it, int64_t tick)
{
    if (it->every == 1) {
        return ALL;
    }
    return (tick % it->every == 0 ? DISCRETE : 0) | ((tick + 1) % it->every == 0 ? CONTINUOUS : 0);
}

static bool is_due(const Component *it, int64_t tick)
{
    return it->every == 1 || tick % it->every == 0;
}

/* Step a group of components: one in a sequence, all at once otherwise. */
static INLINE bool step_group(Plan *plan, Component *begin, const Component *end, int64_t tick)
{
    if (end - begin == 1 && begin->every * begin->parts == 1) { /* what follows comes to this, but takes its time */
        return take_inputs(plan, begin) && do_part(plan, begin, tick, 0) && give_outputs(plan, begin, ALL);
    }
    for (const Component *it = begin; it < end; ++it) {
        if (is_due(it, tick) && !take_inputs(plan, it)) {
            return false;
        }
    }
    for (Component *it = begin; it < end; ++it) {
        if (is_due(it, tick) && !advance(plan, it, tick)) {
            return false;
        }
    }
    for (const Component *it = begin; it < end; ++it) {
        if (!give_outputs(plan, it, given(it, tick))) {
            return false;
        }
    }
    return true;
}

/* The exponent of what is no finite number is all ones: adding one to it carries into the sign. */
static bool all_finite(const Plan *plan)
{
    const uint64_t exponent = UINT64_C(0x7ff0000000000000), one = UINT64_C(0x0010000000000000);
    uint64_t carried = 0;
    for (int64_t i = 0; i < plan->table_size; ++i) {
        uint64_t bits;
        memcpy(&bits, &plan->table[i], sizeof bits);
        carried |= (bits & exponent) + one;
    }
    return carried >> 63 == 0;
}

static void record(const Plan *plan, double row[], const Cell cells[], int64_t count)
{
    for (int64_t i = 0; i < count; ++i) {
        row[cells[i].column] = plan->table[cells[i].place];
    }
}

/* Step from tick `first` to tick `last`; returns whether nothing is wrong, else `now` says what. */
EXPORT bool stepper_run(Plan *plan, int64_t first, int64_t last)
{
    int64_t until_row = (plan->record_every - first % plan->record_every) % plan->record_every;
    double *row = plan->rows + ((first + until_row - plan->first_recorded) / plan->record_every) * plan->width;
    const Component *const end = plan->components + plan->component_count;
    for (int64_t tick = first; tick < last; ++tick) {
        const bool recorded = until_row == 0;
        if (!all_finite(plan)) {
            plan->now.cause = NOT_FINITE;
            return false;
        }
        if (recorded) {
            row[0] = (double)tick * plan->step_size;
            record(plan, row, plan->continuous, plan->continuous_count);
        }
        for (Component *it = plan->components; it < end; it += plan->group) {
            if (!step_group(plan, it, it + plan->group, tick)) {
                return false;
            }
        }
        if (recorded) {
            record(plan, row, plan->discrete, plan->discrete_count);
            row += plan->width;
            until_row = plan->record_every;
        }
        --until_row;
        plan->done = tick + 1;
    }
    return true;
}
