/* The master's loop in C: steps components over a range of ticks by the FMUs' own functions, FMI 2.0 and 3.0 mixed.
 *
 * It does what cosim/engine/python_stepper.py does, over the same table and buffers, to the same bits. Nothing is
 * allocated here and nothing outlives a call. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "native_stepper.h"
#include "source.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

#define INLINE inline __attribute__((always_inline)) /* a tick is short: calls would take a good part of it */

enum { WORST_ACCEPTED = 1 }; /* a warning: FMI 2.0 and 3.0 number their status alike */

typedef int Access2(void *instance, const uint32_t *references, size_t count, void *values);
typedef int Access3(void *instance, const uint32_t *references, size_t count, void *values, size_t value_count);
typedef int DoStep2(void *instance, double time, double step, int no_return);
typedef int DoStep3(void *instance, double time, double step, bool no_return, bool *event, bool *terminate, bool *early,
                    double *reached);

#define EACH_TYPE(DO)    \
    DO(float64, double)  \
    DO(float32, float)   \
    DO(bool8, bool)      \
    DO(int8, int8_t)     \
    DO(int16, int16_t)   \
    DO(int32, int32_t)   \
    DO(int64, int64_t)   \
    DO(uint8, uint8_t)   \
    DO(uint16, uint16_t) \
    DO(uint32, uint32_t) \
    DO(uint64, uint64_t)

EXPORT const char *stepper_source(void)
{
    return STEPPER_SOURCE;
}

/* ---- calls and their status -------------------------------------------------------------------------------------- */

static INLINE void begin_call(Schedule *schedule, Cause cause, const Component *component, int64_t number)
{
    schedule->call.cause = cause;
    schedule->call.component = component;
    schedule->call.number = number;
}

static bool check_status(Schedule *schedule, int status, int64_t *warned)
{
    schedule->call.status = status;
    if (status <= WORST_ACCEPTED && !*warned) {
        *warned = 1;
        schedule->warned();
    }
    return status <= WORST_ACCEPTED;
}

/* Whether a run can go on after a call. */
static INLINE bool accepted(Schedule *schedule, int status, int64_t *warned)
{
    return status == 0 || check_status(schedule, status, warned);
}

/* ---- exchange of values ------------------------------------------------------------------------------------------ */

static int call_access(const Component *component, const VariableAccess *access)
{
    const size_t references = (size_t)access->reference_count, count = (size_t)access->count;
    return component->fmi_version == 2
               ? ((Access2 *)access->function)(component->instance, access->references, references, access->buffer)
               : ((Access3 *)access->function)(component->instance, access->references, references, access->buffer,
                                               count);
}

/* The value of an input's element. */
static INLINE double input_value(const VariableAccess *access, const double values[], int64_t i)
{
    const double value = values[access->index[i]];
    return access->factors == NULL ? value : access->factors[i] * value + access->offsets[i];
}

/* Whether the values of all elements of an input are in range. */
static bool check_range(Schedule *schedule, const Component *component, int64_t number)
{
    const VariableAccess *access = &component->inputs[number];
    if (access->low == NULL) {
        return true;
    }
    for (int64_t i = 0; i < access->count; ++i) {
        const double value = input_value(access, schedule->values, i);
        if (!(access->low[i] <= value && value <= access->high[i])) {
            begin_call(schedule, out_of_range, component, number);
            schedule->call.element = i;
            return false;
        }
    }
    return true;
}

/* Fill the buffer of a setter from the table. */
static void fill_buffer(const VariableAccess *access, const double values[])
{
    if (access->factors != NULL) {
        for (int64_t i = 0; i < access->count; ++i) {
            const double value = input_value(access, values, i);
            if (access->type == float64) { /* only floating-point numbers are transformed */
                ((double *)access->buffer)[i] = value;
            } else {
                ((float *)access->buffer)[i] = (float)value;
            }
        }
        return;
    }
    switch (access->type) {
#define FILL(code, type_)                                                   \
    case code:                                                              \
        for (int64_t i = 0; i < access->count; ++i) {                       \
            ((type_ *)access->buffer)[i] = (type_)values[access->index[i]]; \
        }                                                                   \
        break;
        EACH_TYPE(FILL)
#undef FILL
    }
}

/* Empty the buffer of a getter into the table. */
static void empty_buffer(const VariableAccess *access, double values[])
{
    switch (access->type) {
#define EMPTY(code, type_)                                                         \
    case code:                                                                     \
        for (int64_t i = 0; i < access->count; ++i) {                              \
            values[access->index[i]] = (double)((const type_ *)access->buffer)[i]; \
        }                                                                          \
        break;
        EACH_TYPE(EMPTY)
#undef EMPTY
    }
}

static bool magnitude_fits(int64_t value, int64_t largest)
{
    return -largest <= value && value <= largest;
}

/* Whether all integers of an output are exact as double, or the caller goes on with those that are not. */
static bool check_exact(Schedule *schedule, const VariableAccess *access)
{
    const int64_t exact = INT64_C(1) << 53;
    for (int64_t i = 0; i < access->count; ++i) {
        const bool fits = access->type == uint64 ? ((const uint64_t *)access->buffer)[i] <= (uint64_t)exact
                                                 : magnitude_fits(((const int64_t *)access->buffer)[i], exact);
        if (!fits) {
            schedule->call.element = i;
            if (!schedule->inexact()) {
                schedule->call.cause = inexact;
                return false;
            }
        }
    }
    return true;
}

static INLINE bool set_inputs(Schedule *schedule, const Component *component)
{
    for (int64_t a = 0; a < component->input_count; ++a) {
        VariableAccess *access = &component->inputs[a];
        if (access->type == float64 && access->factors == NULL) { /* nearly always */
            double *buffer = access->buffer;
            for (int64_t i = 0; i < access->count; ++i) {
                buffer[i] = schedule->values[access->index[i]];
            }
        } else {
            if (!check_range(schedule, component, a)) {
                return false;
            }
            fill_buffer(access, schedule->values);
        }
        begin_call(schedule, setting, component, a);
        if (!accepted(schedule, call_access(component, access), &access->warned)) {
            return false;
        }
    }
    return true;
}

typedef enum { AT_END = 1, SAMPLED = 2, ALL = 3 } Which;

static INLINE bool get_outputs(Schedule *schedule, const Component *component, Which which)
{
    for (int64_t a = 0; a < component->output_count; ++a) {
        VariableAccess *access = &component->outputs[a];
        if ((which & (access->sampled ? SAMPLED : AT_END)) == 0) {
            continue;
        }
        begin_call(schedule, getting, component, a);
        if (!accepted(schedule, call_access(component, access), &access->warned)) {
            return false;
        }
        if (access->index != NULL) {
            if (access->may_be_inexact && !check_exact(schedule, access)) {
                return false;
            }
            empty_buffer(access, schedule->values);
        }
    }
    return true;
}

/* ---- begin of a run ---------------------------------------------------------------------------------------------- */

EXPORT void stepper_begin(Schedule *schedule)
{
    schedule->done = 0;
    for (int64_t i = 0; i < schedule->component_count; ++i) {
        Component *component = &schedule->components[i];
        component->warned = 0;
        for (int64_t a = 0; a < component->input_count; ++a) {
            component->inputs[a].warned = 0;
        }
        for (int64_t a = 0; a < component->output_count; ++a) {
            component->outputs[a].warned = 0;
        }
    }
}

/* ---- steps ------------------------------------------------------------------------------------------------------- */

/* Step by a substep; `number` is that of the step's first substep. */
static INLINE bool do_substep(Schedule *schedule, Component *component, int64_t number, int64_t substep)
{
    const double time = schedule->start_time + (double)(number + substep) * component->step_size;
    begin_call(schedule, stepping, component, substep);
    if (component->fmi_version == 2) {
        const int status = ((DoStep2 *)component->do_step)(component->instance, time, component->step_size, 1);
        return accepted(schedule, status, &component->warned);
    }
    bool event = false, terminate = false, early = false;
    const int status = ((DoStep3 *)component->do_step)(component->instance, time, component->step_size, true, &event,
                                                       &terminate, &early, &schedule->call.reached);
    if (!accepted(schedule, status, &component->warned)) {
        return false;
    }
    if (terminate || early) {
        schedule->call.cause = terminate ? terminated : returned_early;
        return false;
    }
    return true;
}

static bool do_step(Schedule *schedule, Component *component, int64_t tick)
{
    for (int64_t substep = 0; substep < component->substeps; ++substep) {
        if (!do_substep(schedule, component, tick / component->factor * component->substeps, substep)) {
            return false;
        }
    }
    return true;
}

/* Which outputs a component gives in this tick: samples at the begin of its step, all others at its end. */
static Which due_outputs(const Component *component, int64_t tick)
{
    if (component->factor == 1) {
        return ALL;
    }
    return (tick % component->factor == 0 ? SAMPLED : 0) | ((tick + 1) % component->factor == 0 ? AT_END : 0);
}

static bool is_due(const Component *component, int64_t tick)
{
    return component->factor == 1 || tick % component->factor == 0;
}

/* Step a group of components: one in a sequence, all of them otherwise. */
static INLINE bool step_group(Schedule *schedule, Component *begin, const Component *end, int64_t tick)
{
    if (end - begin == 1 && begin->factor * begin->substeps == 1) { /* the general case does the same, slower */
        return set_inputs(schedule, begin) && do_substep(schedule, begin, tick, 0) && get_outputs(schedule, begin, ALL);
    }
    for (const Component *component = begin; component < end; ++component) {
        if (is_due(component, tick) && !set_inputs(schedule, component)) {
            return false;
        }
    }
    for (Component *component = begin; component < end; ++component) {
        if (is_due(component, tick) && !do_step(schedule, component, tick)) {
            return false;
        }
    }
    for (const Component *component = begin; component < end; ++component) {
        if (!get_outputs(schedule, component, due_outputs(component, tick))) {
            return false;
        }
    }
    return true;
}

/* The exponent of what is no finite number is all ones: adding one to it carries into the sign. */
static bool all_finite(const Schedule *schedule)
{
    const uint64_t exponent = UINT64_C(0x7ff0000000000000), one = UINT64_C(0x0010000000000000);
    uint64_t carried = 0;
    for (int64_t i = 0; i < schedule->value_count; ++i) {
        uint64_t bits;
        memcpy(&bits, &schedule->values[i], sizeof bits);
        carried |= (bits & exponent) + one;
    }
    return carried >> 63 == 0;
}

static void record(const Schedule *schedule, double row[], const RecordedValue recorded[], int64_t count)
{
    for (int64_t i = 0; i < count; ++i) {
        row[recorded[i].column] = schedule->values[recorded[i].index];
    }
}

EXPORT bool stepper_run(Schedule *schedule, int64_t first, int64_t last)
{
    const int64_t every = schedule->record_every;
    int64_t until_row = (every - first % every) % every;
    double *row = schedule->rows + ((first + until_row - schedule->first_recorded) / every) * schedule->width;
    const Component *const end = schedule->components + schedule->component_count;
    for (int64_t tick = first; tick < last; ++tick) {
        const bool recorded = until_row == 0;
        if (!all_finite(schedule)) {
            schedule->call.cause = not_finite;
            return false;
        }
        if (recorded) {
            row[0] = schedule->start_time + (double)tick * schedule->step_size;
            record(schedule, row, schedule->continuous, schedule->continuous_count);
        }
        for (Component *component = schedule->components; component < end; component += schedule->group) {
            if (!step_group(schedule, component, component + schedule->group, tick)) {
                return false;
            }
        }
        if (recorded) {
            record(schedule, row, schedule->sampled, schedule->sampled_count);
            row += schedule->width;
            until_row = every;
        }
        --until_row;
        schedule->done = tick + 1;
    }
    return true;
}
