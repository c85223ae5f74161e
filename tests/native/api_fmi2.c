#include "api.h"

#include "fmi2Functions.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static void log_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                        fmi2String message, ...)
{
    MessageLog *messages = environment;
    va_list arguments;
    (void)name, (void)category;
    messages->warnings += status == fmi2Warning;
    messages->errors += status == fmi2Error;
    va_start(arguments, message);
    vsnprintf(messages->last, sizeof messages->last, message, arguments);
    va_end(arguments);
}

static Fmu make_type(const char *name, const char *token, bool logging, MessageLog *messages, fmi2Type type)
{
    const fmi2CallbackFunctions callbacks = {log_message, NULL, NULL, NULL, messages};
    return fmi2Instantiate(name, type, token, NULL, &callbacks, fmi2False, logging);
}

Fmu make(const char *name, const char *token, bool logging, MessageLog *messages)
{
    return make_type(name, token, logging, messages, fmi2CoSimulation);
}

Fmu make_of_another_kind(MessageLog *messages)
{
    return make_type("instance", MODEL_TOKEN, true, messages, fmi2ModelExchange);
}

Fmu make_without_logger(void)
{
    return fmi2Instantiate("instance", fmi2CoSimulation, MODEL_TOKEN, NULL, NULL, fmi2False, fmi2True);
}

void discard(Fmu fmu)
{
    fmi2FreeInstance(fmu);
}

Code set_logging(Fmu fmu, bool on, size_t count, const char *const names[])
{
    return (Code)fmi2SetDebugLogging(fmu, on, count, names);
}

Code begin(Fmu fmu, double start_time)
{
    const fmi2Status status = fmi2SetupExperiment(fmu, fmi2False, 0.0, start_time, fmi2False, 0.0);
    return (Code)(status == fmi2OK ? fmi2EnterInitializationMode(fmu) : status);
}

Code end(Fmu fmu)
{
    return (Code)fmi2ExitInitializationMode(fmu);
}

Code step(Fmu fmu, double time, double step_size)
{
    return (Code)fmi2DoStep(fmu, time, step_size, fmi2True);
}

Code terminate_run(Fmu fmu)
{
    return (Code)fmi2Terminate(fmu);
}

Code reset(Fmu fmu)
{
    return (Code)fmi2Reset(fmu);
}

Code get(Fmu fmu, Type type, const uint32_t *references, size_t count, double *values)
{
    if (type == TYPE_REAL) {
        return (Code)fmi2GetReal(fmu, references, count, values);
    }
    int found[VARIABLE_COUNT] = {0};
    const fmi2Status status = type == TYPE_BOOLEAN ? fmi2GetBoolean(fmu, references, count, found)
                                                   : fmi2GetInteger(fmu, references, count, found);
    for (size_t i = 0; i < count; ++i) {
        values[i] = found[i];
    }
    return (Code)status;
}

Code set(Fmu fmu, Type type, const uint32_t *references, size_t count, const double *values)
{
    if (type == TYPE_REAL) {
        return (Code)fmi2SetReal(fmu, references, count, values);
    }
    int given[VARIABLE_COUNT] = {0};
    for (size_t i = 0; i < count; ++i) {
        given[i] = (int)values[i];
    }
    return (Code)(type == TYPE_BOOLEAN ? fmi2SetBoolean(fmu, references, count, given)
                                       : fmi2SetInteger(fmu, references, count, given));
}

Code get_text(Fmu fmu, uint32_t reference, const char **text)
{
    return (Code)fmi2GetString(fmu, &reference, 1, text);
}

Code set_text(Fmu fmu, uint32_t reference, const char *text)
{
    return (Code)fmi2SetString(fmu, &reference, 1, &text);
}

Code get_into_nothing(Fmu fmu)
{
    return (Code)fmi2GetReal(fmu, NULL, 3, NULL);
}

Code set_from_nothing(Fmu fmu)
{
    return (Code)fmi2SetReal(fmu, NULL, 3, NULL);
}

Code get_state(Fmu fmu, void **state)
{
    return (Code)fmi2GetFMUstate(fmu, state);
}

Code set_state(Fmu fmu, void *state)
{
    return (Code)fmi2SetFMUstate(fmu, state);
}

Code free_state(Fmu fmu, void **state)
{
    return (Code)fmi2FreeFMUstate(fmu, state);
}

Code state_size(Fmu fmu, void *state, size_t *size)
{
    return (Code)fmi2SerializedFMUstateSize(fmu, state, size);
}

Code to_bytes(Fmu fmu, void *state, char *bytes, size_t size)
{
    return (Code)fmi2SerializeFMUstate(fmu, state, bytes, size);
}

Code from_bytes(Fmu fmu, const char *bytes, size_t size, void **state)
{
    return (Code)fmi2DeSerializeFMUstate(fmu, bytes, size, state);
}

int call_unsupported(Fmu fmu, int *not_refused)
{
    const fmi2ValueReference r[1] = {0};
    const fmi2Integer order[1] = {1};
    const fmi2String text[1] = {""};
    fmi2EventInfo info;
    fmi2Status status;
    fmi2Boolean yes[2];
    fmi2Integer number;
    fmi2String string[1];
    double x[1] = {0.0};
    const fmi2Status found[] = {
        fmi2GetStatus(fmu, fmi2DoStepStatus, &status),
        fmi2GetIntegerStatus(fmu, fmi2DoStepStatus, &number),
        fmi2GetStringStatus(fmu, fmi2PendingStatus, string),
        fmi2GetRealStatus(fmu, fmi2DoStepStatus, x),
        fmi2GetBooleanStatus(fmu, fmi2DoStepStatus, yes),
        fmi2CancelStep(fmu),
        fmi2GetString(fmu, r, 1, string),
        fmi2SetString(fmu, r, 1, text),
        fmi2GetDirectionalDerivative(fmu, r, 1, r, 1, x, x),
        fmi2SetRealInputDerivatives(fmu, r, 1, order, x),
        fmi2GetRealOutputDerivatives(fmu, r, 1, order, x),
        fmi2EnterEventMode(fmu),
        fmi2NewDiscreteStates(fmu, &info),
        fmi2EnterContinuousTimeMode(fmu),
        fmi2CompletedIntegratorStep(fmu, fmi2True, yes, yes + 1),
        fmi2SetTime(fmu, 0.0),
        fmi2SetContinuousStates(fmu, x, 1),
        fmi2GetDerivatives(fmu, x, 1),
        fmi2GetEventIndicators(fmu, x, 1),
        fmi2GetContinuousStates(fmu, x, 1),
        fmi2GetNominalsOfContinuousStates(fmu, x, 1),
    };
    const int count = sizeof found / sizeof *found;
    for (int i = 0; i < count; ++i) {
        *not_refused += found[i] != fmi2Error;
    }
    return count;
}

int check_particulars(void)
{
    MessageLog messages = {0};
    Fmu fmu = make("instance", MODEL_TOKEN, true, &messages);
    double time = -1.0;
    fmi2Boolean ended = fmi2True;
    int failures = strcmp(fmi2GetVersion(), "2.0") != 0;
    failures += strcmp(fmi2GetTypesPlatform(), "default") != 0;
    failures += begin(fmu, 2.0) != fmi2OK || end(fmu) != fmi2OK || step(fmu, 2.0, 0.25) != fmi2OK;
    failures += fmi2GetRealStatus(fmu, fmi2LastSuccessfulTime, &time) != fmi2OK || time != 2.25;
    failures += fmi2GetBooleanStatus(fmu, fmi2Terminated, &ended) != fmi2OK || ended;
    failures += fmi2GetRealStatus(fmu, fmi2LastSuccessfulTime, NULL) != fmi2Error;
    failures += fmi2GetBooleanStatus(fmu, fmi2Terminated, NULL) != fmi2Error;
    failures += fmi2GetString(fmu, NULL, 0, NULL) != fmi2OK;
    discard(fmu);
    return failures;
}
