#include "api.h"

#include "fmi3Functions.h"

#include <stdio.h>
#include <string.h>

static void log_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message)
{
    MessageLog *messages = environment;
    (void)category;
    messages->warnings += status == fmi3Warning;
    messages->errors += status == fmi3Error;
    snprintf(messages->last, sizeof messages->last, "%s", message);
}

static Fmu make_with(const char *name, const char *token, bool logging, MessageLog *messages, bool events,
                     size_t updates)
{
    const fmi3ValueReference required[1] = {0};
    return fmi3InstantiateCoSimulation(name, token, NULL, false, logging, events, false, required, updates, messages,
                                       messages == NULL ? NULL : log_message, NULL);
}

Fmu make(const char *name, const char *token, bool logging, MessageLog *messages)
{
    return make_with(name, token, logging, messages, false, 0);
}

Fmu make_of_another_kind(MessageLog *messages)
{
    Fmu me = fmi3InstantiateModelExchange("instance", MODEL_TOKEN, NULL, false, true, messages, log_message);
    Fmu se = fmi3InstantiateScheduledExecution("instance", MODEL_TOKEN, NULL, false, true, messages, log_message, NULL,
                                               NULL, NULL);
    Fmu update = make_with("instance", MODEL_TOKEN, true, messages, false, 1);
    return me != NULL ? me : se != NULL ? se : update;
}

Fmu make_without_logger(void)
{
    return make_with("instance", MODEL_TOKEN, true, NULL, false, 0);
}

void discard(Fmu fmu)
{
    fmi3FreeInstance(fmu);
}

Code set_logging(Fmu fmu, bool on, size_t count, const char *const names[])
{
    return (Code)fmi3SetDebugLogging(fmu, on, count, names);
}

Code begin(Fmu fmu, double start_time)
{
    return (Code)fmi3EnterInitializationMode(fmu, false, 0.0, start_time, false, 0.0);
}

Code end(Fmu fmu)
{
    return (Code)fmi3ExitInitializationMode(fmu);
}

Code step(Fmu fmu, double time, double step_size)
{
    bool event, terminate, early;
    double reached = -1.0;
    const fmi3Status status = fmi3DoStep(fmu, time, step_size, true, &event, &terminate, &early, &reached);
    if (status == fmi3OK && (event || terminate || early || reached != time + step_size)) {
        return -1;
    }
    return (Code)status;
}

Code terminate_run(Fmu fmu)
{
    return (Code)fmi3Terminate(fmu);
}

Code reset(Fmu fmu)
{
    return (Code)fmi3Reset(fmu);
}

Code get(Fmu fmu, Type type, const uint32_t *references, size_t count, double *values)
{
    fmi3Status status;
    if (type == TYPE_REAL) {
        return (Code)fmi3GetFloat64(fmu, references, count, values, count);
    }
    if (type == TYPE_BOOLEAN) {
        bool found[VARIABLE_COUNT] = {false};
        status = fmi3GetBoolean(fmu, references, count, found, count);
        for (size_t i = 0; i < count; ++i) {
            values[i] = found[i];
        }
    } else {
        int64_t found[VARIABLE_COUNT] = {0};
        status = fmi3GetInt64(fmu, references, count, found, count);
        for (size_t i = 0; i < count; ++i) {
            values[i] = (double)found[i];
        }
    }
    return (Code)status;
}

Code set(Fmu fmu, Type type, const uint32_t *references, size_t count, const double *values)
{
    bool truths[VARIABLE_COUNT] = {false};
    int64_t numbers[VARIABLE_COUNT] = {0};
    if (type == TYPE_REAL) {
        return (Code)fmi3SetFloat64(fmu, references, count, values, count);
    }
    for (size_t i = 0; i < count; ++i) {
        truths[i] = values[i] != 0.0;
        numbers[i] = (int64_t)values[i];
    }
    return (Code)(type == TYPE_BOOLEAN ? fmi3SetBoolean(fmu, references, count, truths, count)
                                       : fmi3SetInt64(fmu, references, count, numbers, count));
}

Code get_text(Fmu fmu, uint32_t reference, const char **text)
{
    return (Code)fmi3GetString(fmu, &reference, 1, text, 1);
}

Code set_text(Fmu fmu, uint32_t reference, const char *text)
{
    return (Code)fmi3SetString(fmu, &reference, 1, &text, 1);
}

Code get_into_nothing(Fmu fmu)
{
    return (Code)fmi3GetFloat64(fmu, NULL, 3, NULL, 3);
}

Code set_from_nothing(Fmu fmu)
{
    return (Code)fmi3SetFloat64(fmu, NULL, 3, NULL, 3);
}

Code get_state(Fmu fmu, void **state)
{
    return (Code)fmi3GetFMUState(fmu, state);
}

Code set_state(Fmu fmu, void *state)
{
    return (Code)fmi3SetFMUState(fmu, state);
}

Code free_state(Fmu fmu, void **state)
{
    return (Code)fmi3FreeFMUState(fmu, state);
}

Code state_size(Fmu fmu, void *state, size_t *size)
{
    return (Code)fmi3SerializedFMUStateSize(fmu, state, size);
}

Code to_bytes(Fmu fmu, void *state, char *bytes, size_t size)
{
    return (Code)fmi3SerializeFMUState(fmu, state, (fmi3Byte *)bytes, size);
}

Code from_bytes(Fmu fmu, const char *bytes, size_t size, void **state)
{
    return (Code)fmi3DeserializeFMUState(fmu, (const fmi3Byte *)bytes, size, state);
}

/* One value of each type there could be. */
#define ACCESS(type, kind) fmi3Get##type(fmu, r, 1, &(kind){0}, 1), fmi3Set##type(fmu, r, 1, &(kind){0}, 1)

int call_unsupported(Fmu fmu, int *not_refused)
{
    const fmi3ValueReference r[1] = {0};
    const fmi3Int32 order[1] = {1};
    fmi3ValueReference reference[1];
    fmi3DependencyKind kinds[1];
    fmi3IntervalQualifier qualifiers[1];
    size_t sizes[1] = {0}, more[1] = {0};
    uint64_t whole[1] = {0}, parts[1] = {0};
    bool yes[5];
    double x[1] = {0.0};
    const fmi3Status found[] = {
        ACCESS(Float32, float),
        ACCESS(Int8, int8_t),
        ACCESS(UInt8, uint8_t),
        ACCESS(Int16, int16_t),
        ACCESS(UInt16, uint16_t),
        ACCESS(Int32, int32_t),
        ACCESS(UInt32, uint32_t),
        ACCESS(UInt64, uint64_t),
        ACCESS(String, fmi3String),
        fmi3GetBinary(fmu, r, 1, sizes, &(fmi3Binary){NULL}, 1),
        fmi3SetBinary(fmu, r, 1, sizes, &(fmi3Binary){NULL}, 1),
        fmi3GetClock(fmu, r, 1, yes),
        fmi3SetClock(fmu, r, 1, yes),
        fmi3EnterEventMode(fmu),
        fmi3EnterStepMode(fmu),
        fmi3EvaluateDiscreteStates(fmu),
        fmi3UpdateDiscreteStates(fmu, yes, yes + 1, yes + 2, yes + 3, yes + 4, x),
        fmi3EnterConfigurationMode(fmu),
        fmi3ExitConfigurationMode(fmu),
        fmi3GetNumberOfVariableDependencies(fmu, 0, sizes),
        fmi3GetVariableDependencies(fmu, 0, sizes, reference, more, kinds, 1),
        fmi3GetDirectionalDerivative(fmu, r, 1, r, 1, x, 1, x, 1),
        fmi3GetAdjointDerivative(fmu, r, 1, r, 1, x, 1, x, 1),
        fmi3GetOutputDerivatives(fmu, r, 1, order, x, 1),
        fmi3GetIntervalDecimal(fmu, r, 1, x, qualifiers),
        fmi3GetIntervalFraction(fmu, r, 1, whole, parts, qualifiers),
        fmi3GetShiftDecimal(fmu, r, 1, x),
        fmi3GetShiftFraction(fmu, r, 1, whole, parts),
        fmi3SetIntervalDecimal(fmu, r, 1, x),
        fmi3SetIntervalFraction(fmu, r, 1, whole, parts),
        fmi3SetShiftDecimal(fmu, r, 1, x),
        fmi3SetShiftFraction(fmu, r, 1, whole, parts),
        fmi3ActivateModelPartition(fmu, 0, 0.0),
        fmi3EnterContinuousTimeMode(fmu),
        fmi3CompletedIntegratorStep(fmu, true, yes, yes + 1),
        fmi3SetTime(fmu, 0.0),
        fmi3SetContinuousStates(fmu, x, 1),
        fmi3GetContinuousStateDerivatives(fmu, x, 1),
        fmi3GetEventIndicators(fmu, x, 1),
        fmi3GetContinuousStates(fmu, x, 1),
        fmi3GetNominalsOfContinuousStates(fmu, x, 1),
        fmi3GetNumberOfEventIndicators(fmu, sizes),
        fmi3GetNumberOfContinuousStates(fmu, sizes),
    };
    const int count = sizeof found / sizeof *found;
    for (int i = 0; i < count; ++i) {
        *not_refused += found[i] != fmi3Error;
    }
    return count;
}

int check_particulars(void)
{
    MessageLog messages = {0};
    const uint32_t r[2] = {0, 0};
    double x[2], reached = 0.0;
    bool event, terminate, early;
    int failures = strcmp(fmi3GetVersion(), "3.0") != 0;
    failures += make_with("instance", MODEL_TOKEN, true, &messages, true, 0) != NULL;
    failures += messages.errors != 1 || strstr(messages.last, "event mode") == NULL;
    Fmu fmu = make("instance", MODEL_TOKEN, true, &messages);
    failures += fmi3GetFloat64(fmu, r, 2, x, 1) != fmi3Error;
    failures += fmi3SetFloat64(fmu, r, 1, x, 2) != fmi3Error;
    failures += fmi3GetFloat32(fmu, NULL, 0, NULL, 0) != fmi3OK;
    failures += begin(fmu, 2.0) != fmi3OK || end(fmu) != fmi3OK;
    failures += fmi3DoStep(fmu, 2.0, 0.25, true, NULL, NULL, NULL, NULL) != fmi3Error;
    failures += fmi3DoStep(fmu, 1.0, 0.25, true, &event, &terminate, &early, &reached) != fmi3Error || reached != 2.0;
    failures += fmi3DoStep(fmu, 2.0, 0.25, true, &event, &terminate, &early, &reached) != fmi3OK || reached != 2.25;
    failures += fmi3EnterInitializationMode(fmu, false, 0.0, 0.0, false, 0.0) != fmi3Error;
    discard(fmu);
    return failures;
}
