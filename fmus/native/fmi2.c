/* The functions of FMI 2.0 for co-simulation, implemented by the rules in instance.c. Independent of the model. */
#include "fmi2Functions.h"

#include "instance.h"

#include <math.h>

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter" /* functions do not use all arguments of the standard */
#endif

/* ---- instances --------------------------------------------------------------------------------------------------- */

/* Pass a message to the host, which reads it as a printf format: percent signs are doubled. */
static void log_message(const Instance *instance, Status status, const char *category, const char *message)
{
    char format[2048];
    size_t length = 0;
    for (const char *c = message; *c != '\0' && length + 2 < sizeof format; ++c) {
        if (*c == '%') {
            format[length++] = '%';
        }
        format[length++] = *c;
    }
    format[length] = '\0';
    ((fmi2CallbackLogger)instance->host.callback)(instance->host.environment, instance->name, (fmi2Status)status,
                                                  category, format);
}

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}

const char *fmi2GetVersion(void)
{
    return fmi2Version;
}

fmi2Component fmi2Instantiate(fmi2String instanceName, fmi2Type fmuType, fmi2String fmuGUID,
                              fmi2String fmuResourceLocation, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean loggingOn)
{
    Host host = {log_message, NULL, NULL};
    if (functions != NULL) {
        host.callback = (HostCallback)functions->logger;
        host.environment = functions->componentEnvironment;
    }
    Instance *instance =
        instance_new(instanceName, fmuGUID, fmuResourceLocation, loggingOn != fmi2False, host, __func__);
    if (instance != NULL && fmuType != fmi2CoSimulation) {
        instance_unsupported(instance, __func__, "co-simulation only");
        instance_free(instance);
        instance = NULL;
    }
    return instance;
}

void fmi2FreeInstance(fmi2Component c)
{
    instance_free(c);
}

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean loggingOn, size_t nCategories,
                               const fmi2String categories[])
{
    return (fmi2Status)instance_set_logging(c, __func__, loggingOn != fmi2False, nCategories, categories);
}

/* ---- life cycle -------------------------------------------------------------------------------------------------- */

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean toleranceDefined, fmi2Real tolerance, fmi2Real startTime,
                               fmi2Boolean stopTimeDefined, fmi2Real stopTime)
{
    return (fmi2Status)instance_set_up(c, __func__, startTime, stopTimeDefined ? stopTime : INFINITY);
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return (fmi2Status)instance_enter_initialization(c, __func__);
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return (fmi2Status)instance_exit_initialization(c, __func__);
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real currentCommunicationPoint, fmi2Real communicationStepSize,
                      fmi2Boolean noSetFMUStatePriorToCurrentPoint)
{
    return (fmi2Status)instance_step(c, __func__, currentCommunicationPoint, communicationStepSize);
}

fmi2Status fmi2Terminate(fmi2Component c)
{
    return (fmi2Status)instance_terminate(c, __func__);
}

fmi2Status fmi2Reset(fmi2Component c)
{
    return (fmi2Status)instance_reset(c, __func__);
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

#define GETTER(function, type, kind, conversion)                                                  \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, kind value[]) \
    {                                                                                             \
        const Instance *instance = c;                                                             \
        const Status status = instance_prepare_read(c, __func__, type, vr, nvr, value);           \
        for (size_t i = 0; status != STATUS_ERROR && i < nvr; ++i) {                              \
            value[i] = (kind)(conversion);                                                        \
        }                                                                                         \
        return (fmi2Status)status;                                                                \
    }

#define SETTER(function, type, kind, conversion)                                                        \
    fmi2Status function(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const kind value[]) \
    {                                                                                                   \
        Status status = instance_check_write(c, __func__, type, vr, nvr, value);                        \
        for (size_t i = 0, legal = status == STATUS_OK; legal && i < nvr; ++i) {                        \
            const Status written = instance_write(c, __func__, vr[i], (double)(conversion));            \
            status = written > status ? written : status;                                               \
        }                                                                                               \
        return (fmi2Status)status;                                                                      \
    }

GETTER(fmi2GetReal, TYPE_REAL, fmi2Real, instance->values[vr[i]])
GETTER(fmi2GetInteger, TYPE_INTEGER, fmi2Integer, instance->values[vr[i]])
GETTER(fmi2GetBoolean, TYPE_BOOLEAN, fmi2Boolean, instance->values[vr[i]] != 0.0 ? fmi2True : fmi2False)
SETTER(fmi2SetReal, TYPE_REAL, fmi2Real, value[i])
SETTER(fmi2SetInteger, TYPE_INTEGER, fmi2Integer, value[i])
SETTER(fmi2SetBoolean, TYPE_BOOLEAN, fmi2Boolean, value[i] != fmi2False)

fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, fmi2String value[])
{
    const Status status = instance_prepare_read(c, __func__, TYPE_TEXT, vr, nvr, value);
    for (size_t i = 0; status != STATUS_ERROR && i < nvr; ++i) {
        value[i] = instance_text(c, vr[i]);
    }
    return (fmi2Status)status;
}

fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2String value[])
{
    Status status = instance_check_write(c, __func__, TYPE_TEXT, vr, nvr, value);
    for (size_t i = 0, legal = status == STATUS_OK; legal && i < nvr; ++i) {
        const Status written = instance_write_text(c, __func__, vr[i], value[i]);
        status = written > status ? written : status;
    }
    return (fmi2Status)status;
}

/* ---- states ------------------------------------------------------------------------------------------------------ */

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return (fmi2Status)instance_get_state(c, __func__, FMUstate);
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate FMUstate)
{
    return (fmi2Status)instance_set_state(c, __func__, FMUstate);
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *FMUstate)
{
    return (fmi2Status)instance_free_state(c, __func__, FMUstate);
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate FMUstate, size_t *size)
{
    return (fmi2Status)instance_state_size(c, __func__, FMUstate, size);
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate FMUstate, fmi2Byte serializedState[], size_t size)
{
    return (fmi2Status)instance_state_to_bytes(c, __func__, FMUstate, serializedState, size);
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte serializedState[], size_t size,
                                   fmi2FMUstate *FMUstate)
{
    return (fmi2Status)instance_state_from_bytes(c, __func__, serializedState, size, FMUstate);
}

/* ---- status ------------------------------------------------------------------------------------------------------ */

static const char *const no_asynchronous_steps = "no asynchronous steps";

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind s, fmi2Real *value)
{
    const Instance *instance = c;
    if (instance == NULL || value == NULL || s != fmi2LastSuccessfulTime) {
        return (fmi2Status)instance_fail(instance, __func__, "expected a request for the last successful time");
    }
    *value = instance->values[0];
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind s, fmi2Boolean *value)
{
    if (c == NULL || value == NULL || s != fmi2Terminated) {
        return (fmi2Status)instance_fail(c, __func__, "expected a request for the termination status");
    }
    *value = fmi2False; /* it never ends a run */
    return fmi2OK;
}

/* ---- unsupported functions --------------------------------------------------------------------------------------- */

#define UNSUPPORTED(function, reason, ...)                            \
    fmi2Status function(__VA_ARGS__)                                  \
    {                                                                 \
        return (fmi2Status)instance_unsupported(c, __func__, reason); \
    }

static const char *const no_derivatives = "no derivatives";
static const char *const no_model_exchange = "co-simulation only";

UNSUPPORTED(fmi2GetStatus, no_asynchronous_steps, fmi2Component c, const fmi2StatusKind s, fmi2Status *value)
UNSUPPORTED(fmi2GetIntegerStatus, no_asynchronous_steps, fmi2Component c, const fmi2StatusKind s, fmi2Integer *value)
UNSUPPORTED(fmi2GetStringStatus, no_asynchronous_steps, fmi2Component c, const fmi2StatusKind s, fmi2String *value)
UNSUPPORTED(fmi2CancelStep, no_asynchronous_steps, fmi2Component c)

UNSUPPORTED(fmi2GetDirectionalDerivative, no_derivatives, fmi2Component c, const fmi2ValueReference vUnknown_ref[],
            size_t nUnknown, const fmi2ValueReference vKnown_ref[], size_t nKnown, const fmi2Real dvKnown[],
            fmi2Real dvUnknown[])
UNSUPPORTED(fmi2SetRealInputDerivatives, no_derivatives, fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
            const fmi2Integer order[], const fmi2Real value[])
UNSUPPORTED(fmi2GetRealOutputDerivatives, no_derivatives, fmi2Component c, const fmi2ValueReference vr[], size_t nvr,
            const fmi2Integer order[], fmi2Real value[])

UNSUPPORTED(fmi2EnterEventMode, no_model_exchange, fmi2Component c)
UNSUPPORTED(fmi2NewDiscreteStates, no_model_exchange, fmi2Component c, fmi2EventInfo *fmi2eventInfo)
UNSUPPORTED(fmi2EnterContinuousTimeMode, no_model_exchange, fmi2Component c)
UNSUPPORTED(fmi2CompletedIntegratorStep, no_model_exchange, fmi2Component c,
            fmi2Boolean noSetFMUStatePriorToCurrentPoint, fmi2Boolean *enterEventMode, fmi2Boolean *terminateSimulation)
UNSUPPORTED(fmi2SetTime, no_model_exchange, fmi2Component c, fmi2Real time)
UNSUPPORTED(fmi2SetContinuousStates, no_model_exchange, fmi2Component c, const fmi2Real x[], size_t nx)
UNSUPPORTED(fmi2GetDerivatives, no_model_exchange, fmi2Component c, fmi2Real derivatives[], size_t nx)
UNSUPPORTED(fmi2GetEventIndicators, no_model_exchange, fmi2Component c, fmi2Real eventIndicators[], size_t ni)
UNSUPPORTED(fmi2GetContinuousStates, no_model_exchange, fmi2Component c, fmi2Real x[], size_t nx)
UNSUPPORTED(fmi2GetNominalsOfContinuousStates, no_model_exchange, fmi2Component c, fmi2Real x_nominal[], size_t nx)
