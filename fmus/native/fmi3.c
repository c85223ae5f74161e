/* The functions of FMI 3.0 for co-simulation, implemented by the rules in instance.c. Independent of the model. */
#include "fmi3Functions.h"

#include "instance.h"

#include <math.h>

#ifdef __GNUC__
#pragma GCC diagnostic ignored "-Wunused-parameter" /* functions do not use all arguments of the standard */
#endif

static const char *const co_simulation_only = "co-simulation only";
static const char *const no_events = "no event mode";
static const char *const no_clocks = "no clocks";
static const char *const no_derivatives = "no derivatives";
static const char *const no_structure = "no structural parameters";

/* ---- instances --------------------------------------------------------------------------------------------------- */

/* Pass a message to the host. */
static void log_message(const Instance *instance, Status status, const char *category, const char *message)
{
    ((fmi3LogMessageCallback)instance->host.callback)(instance->host.environment, (fmi3Status)status, category,
                                                      message);
}

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

static Host host_of(fmi3LogMessageCallback callback, fmi3InstanceEnvironment environment)
{
    const Host host = {log_message, (HostCallback)callback, environment};
    return host;
}

/* Refuse an instantiation for a reason. */
static fmi3Instance refuse(Instance *instance, const char *function, const char *reason)
{
    if (instance != NULL) {
        instance_unsupported(instance, function, reason);
        instance_free(instance);
    }
    return NULL;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String instanceName, fmi3String instantiationToken,
                                         fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                         fmi3Boolean eventModeUsed, fmi3Boolean earlyReturnAllowed,
                                         const fmi3ValueReference requiredIntermediateVariables[],
                                         size_t nRequiredIntermediateVariables,
                                         fmi3InstanceEnvironment instanceEnvironment, fmi3LogMessageCallback logMessage,
                                         fmi3IntermediateUpdateCallback intermediateUpdate)
{
    const Host host = host_of(logMessage, instanceEnvironment);
    Instance *instance = instance_new(instanceName, instantiationToken, resourcePath, loggingOn, host, __func__);
    if (eventModeUsed) {
        return refuse(instance, __func__, no_events);
    }
    if (nRequiredIntermediateVariables > 0) {
        return refuse(instance, __func__, "no intermediate update");
    }
    return instance;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String instanceName, fmi3String instantiationToken,
                                          fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                          fmi3InstanceEnvironment instanceEnvironment,
                                          fmi3LogMessageCallback logMessage)
{
    const Host host = host_of(logMessage, instanceEnvironment);
    return refuse(instance_new(instanceName, instantiationToken, resourcePath, loggingOn, host, __func__), __func__,
                  co_simulation_only);
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String instanceName, fmi3String instantiationToken,
                                               fmi3String resourcePath, fmi3Boolean visible, fmi3Boolean loggingOn,
                                               fmi3InstanceEnvironment instanceEnvironment,
                                               fmi3LogMessageCallback logMessage, fmi3ClockUpdateCallback clockUpdate,
                                               fmi3LockPreemptionCallback lockPreemption,
                                               fmi3UnlockPreemptionCallback unlockPreemption)
{
    const Host host = host_of(logMessage, instanceEnvironment);
    return refuse(instance_new(instanceName, instantiationToken, resourcePath, loggingOn, host, __func__), __func__,
                  co_simulation_only);
}

void fmi3FreeInstance(fmi3Instance instance)
{
    instance_free(instance);
}

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean loggingOn, size_t nCategories,
                               const fmi3String categories[])
{
    return (fmi3Status)instance_set_logging(instance, __func__, loggingOn, nCategories, categories);
}

/* ---- life cycle -------------------------------------------------------------------------------------------------- */

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean toleranceDefined, fmi3Float64 tolerance,
                                       fmi3Float64 startTime, fmi3Boolean stopTimeDefined, fmi3Float64 stopTime)
{
    const Status status = instance_set_up(instance, __func__, startTime, stopTimeDefined ? stopTime : INFINITY);
    return (fmi3Status)(status == STATUS_OK ? instance_enter_initialization(instance, __func__) : status);
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    return (fmi3Status)instance_exit_initialization(instance, __func__);
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 currentCommunicationPoint, fmi3Float64 communicationStepSize,
                      fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *eventHandlingNeeded,
                      fmi3Boolean *terminateSimulation, fmi3Boolean *earlyReturn, fmi3Float64 *lastSuccessfulTime)
{
    const Instance *const self = instance;
    if (self == NULL || eventHandlingNeeded == NULL || terminateSimulation == NULL || earlyReturn == NULL ||
        lastSuccessfulTime == NULL) {
        return (fmi3Status)instance_fail(self, __func__, "expected pointers for the results, got a null pointer");
    }
    const Status status = instance_step(instance, __func__, currentCommunicationPoint, communicationStepSize);
    *eventHandlingNeeded = *terminateSimulation = *earlyReturn = fmi3False;
    *lastSuccessfulTime = self->values[0];
    return (fmi3Status)status;
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    return (fmi3Status)instance_terminate(instance, __func__);
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    return (fmi3Status)instance_reset(instance, __func__);
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

#define GETTER(function, type, kind, conversion)                                                                    \
    fmi3Status function(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, \
                        kind values[], size_t nValues)                                                              \
    {                                                                                                               \
        const Instance *const self = instance;                                                                      \
        const size_t count = nValueReferences;                                                                      \
        Status status = check_counts(self, __func__, count, nValues);                                               \
        if (status == STATUS_OK) {                                                                                  \
            status = instance_prepare_read(instance, __func__, type, valueReferences, count, values);               \
        }                                                                                                           \
        for (size_t i = 0; status != STATUS_ERROR && i < count; ++i) {                                              \
            const double value = self->values[valueReferences[i]];                                                  \
            values[i] = (kind)(conversion);                                                                         \
        }                                                                                                           \
        return (fmi3Status)status;                                                                                  \
    }

#define SETTER(function, type, kind)                                                                                \
    fmi3Status function(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences, \
                        const kind values[], size_t nValues)                                                        \
    {                                                                                                               \
        const size_t count = nValueReferences;                                                                      \
        Status status = check_counts(instance, __func__, count, nValues);                                           \
        if (status == STATUS_OK) {                                                                                  \
            status = instance_check_write(instance, __func__, type, valueReferences, count, values);                \
        }                                                                                                           \
        for (size_t i = 0, legal = status == STATUS_OK; legal && i < count; ++i) {                                  \
            const Status written = instance_write(instance, __func__, valueReferences[i], (double)values[i]);       \
            status = written > status ? written : status;                                                           \
        }                                                                                                           \
        return (fmi3Status)status;                                                                                  \
    }

#define REFUSED_TYPE(type, kind)                                                                \
    fmi3Status fmi3Get##type(fmi3Instance instance, const fmi3ValueReference valueReferences[], \
                             size_t nValueReferences, kind values[], size_t nValues)            \
    {                                                                                           \
        return (fmi3Status)instance_refuse_type(instance, __func__, #type, nValueReferences);   \
    }                                                                                           \
    fmi3Status fmi3Set##type(fmi3Instance instance, const fmi3ValueReference valueReferences[], \
                             size_t nValueReferences, const kind values[], size_t nValues)      \
    {                                                                                           \
        return (fmi3Status)instance_refuse_type(instance, __func__, #type, nValueReferences);   \
    }

/* Check that there are as many values as references: no variable is an array. */
static Status check_counts(const Instance *instance, const char *function, size_t references, size_t values)
{
    return references == values
               ? STATUS_OK
               : instance_fail(instance, function, "expected %zu values, one for each reference, got %zu", references,
                               values);
}

GETTER(fmi3GetFloat64, TYPE_REAL, fmi3Float64, value)
GETTER(fmi3GetInt64, TYPE_INTEGER, fmi3Int64, value)
GETTER(fmi3GetBoolean, TYPE_BOOLEAN, fmi3Boolean, value != 0.0)
SETTER(fmi3SetFloat64, TYPE_REAL, fmi3Float64)
SETTER(fmi3SetInt64, TYPE_INTEGER, fmi3Int64)
SETTER(fmi3SetBoolean, TYPE_BOOLEAN, fmi3Boolean)

REFUSED_TYPE(Float32, fmi3Float32)
REFUSED_TYPE(Int8, fmi3Int8)
REFUSED_TYPE(UInt8, fmi3UInt8)
REFUSED_TYPE(Int16, fmi3Int16)
REFUSED_TYPE(UInt16, fmi3UInt16)
REFUSED_TYPE(Int32, fmi3Int32)
REFUSED_TYPE(UInt32, fmi3UInt32)
REFUSED_TYPE(UInt64, fmi3UInt64)

fmi3Status fmi3GetString(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         fmi3String values[], size_t nValues)
{
    const size_t count = nValueReferences;
    Status status = check_counts(instance, __func__, count, nValues);
    if (status == STATUS_OK) {
        status = instance_prepare_read(instance, __func__, TYPE_TEXT, valueReferences, count, values);
    }
    for (size_t i = 0; status != STATUS_ERROR && i < count; ++i) {
        values[i] = instance_text(instance, valueReferences[i]);
    }
    return (fmi3Status)status;
}

fmi3Status fmi3SetString(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         const fmi3String values[], size_t nValues)
{
    const size_t count = nValueReferences;
    Status status = check_counts(instance, __func__, count, nValues);
    if (status == STATUS_OK) {
        status = instance_check_write(instance, __func__, TYPE_TEXT, valueReferences, count, values);
    }
    for (size_t i = 0, legal = status == STATUS_OK; legal && i < count; ++i) {
        const Status written = instance_write_text(instance, __func__, valueReferences[i], values[i]);
        status = written > status ? written : status;
    }
    return (fmi3Status)status;
}

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         size_t valueSizes[], fmi3Binary values[], size_t nValues)
{
    return (fmi3Status)instance_refuse_type(instance, __func__, "Binary", nValueReferences);
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                         const size_t valueSizes[], const fmi3Binary values[], size_t nValues)
{
    return (fmi3Status)instance_refuse_type(instance, __func__, "Binary", nValueReferences);
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        fmi3Clock values[])
{
    return (fmi3Status)instance_refuse_type(instance, __func__, "Clock", nValueReferences);
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference valueReferences[], size_t nValueReferences,
                        const fmi3Clock values[])
{
    return (fmi3Status)instance_refuse_type(instance, __func__, "Clock", nValueReferences);
}

/* ---- states ------------------------------------------------------------------------------------------------------ */

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    return (fmi3Status)instance_get_state(instance, __func__, FMUState);
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState FMUState)
{
    return (fmi3Status)instance_set_state(instance, __func__, FMUState);
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *FMUState)
{
    return (fmi3Status)instance_free_state(instance, __func__, FMUState);
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState FMUState, size_t *size)
{
    return (fmi3Status)instance_state_size(instance, __func__, FMUState, size);
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState FMUState, fmi3Byte serializedState[], size_t size)
{
    return (fmi3Status)instance_state_to_bytes(instance, __func__, FMUState, serializedState, size);
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte serializedState[], size_t size,
                                   fmi3FMUState *FMUState)
{
    return (fmi3Status)instance_state_from_bytes(instance, __func__, serializedState, size, FMUState);
}

/* ---- unsupported functions --------------------------------------------------------------------------------------- */

#define UNSUPPORTED(function, reason, ...)                                   \
    fmi3Status function(__VA_ARGS__)                                         \
    {                                                                        \
        return (fmi3Status)instance_unsupported(instance, __func__, reason); \
    }

UNSUPPORTED(fmi3EnterEventMode, no_events, fmi3Instance instance)
UNSUPPORTED(fmi3EnterStepMode, no_events, fmi3Instance instance)
UNSUPPORTED(fmi3EvaluateDiscreteStates, no_events, fmi3Instance instance)
UNSUPPORTED(fmi3UpdateDiscreteStates, no_events, fmi3Instance instance, fmi3Boolean *discreteStatesNeedUpdate,
            fmi3Boolean *terminateSimulation, fmi3Boolean *nominalsOfContinuousStatesChanged,
            fmi3Boolean *valuesOfContinuousStatesChanged, fmi3Boolean *nextEventTimeDefined, fmi3Float64 *nextEventTime)

UNSUPPORTED(fmi3EnterConfigurationMode, no_structure, fmi3Instance instance)
UNSUPPORTED(fmi3ExitConfigurationMode, no_structure, fmi3Instance instance)
UNSUPPORTED(fmi3GetNumberOfVariableDependencies, "no run-time dependencies", fmi3Instance instance,
            fmi3ValueReference valueReference, size_t *nDependencies)
UNSUPPORTED(fmi3GetVariableDependencies, "no run-time dependencies", fmi3Instance instance,
            fmi3ValueReference dependent, size_t elementIndicesOfDependent[], fmi3ValueReference independents[],
            size_t elementIndicesOfIndependents[], fmi3DependencyKind dependencyKinds[], size_t nDependencies)

UNSUPPORTED(fmi3GetDirectionalDerivative, no_derivatives, fmi3Instance instance, const fmi3ValueReference unknowns[],
            size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
            fmi3Float64 sensitivity[], size_t nSensitivity)
UNSUPPORTED(fmi3GetAdjointDerivative, no_derivatives, fmi3Instance instance, const fmi3ValueReference unknowns[],
            size_t nUnknowns, const fmi3ValueReference knowns[], size_t nKnowns, const fmi3Float64 seed[], size_t nSeed,
            fmi3Float64 sensitivity[], size_t nSensitivity)
UNSUPPORTED(fmi3GetOutputDerivatives, no_derivatives, fmi3Instance instance, const fmi3ValueReference valueReferences[],
            size_t nValueReferences, const fmi3Int32 orders[], fmi3Float64 values[], size_t nValues)

UNSUPPORTED(fmi3GetIntervalDecimal, no_clocks, fmi3Instance instance, const fmi3ValueReference valueReferences[],
            size_t nValueReferences, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
UNSUPPORTED(fmi3GetIntervalFraction, no_clocks, fmi3Instance instance, const fmi3ValueReference valueReferences[],
            size_t nValueReferences, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
            fmi3IntervalQualifier qualifiers[])
UNSUPPORTED(fmi3GetShiftDecimal, no_clocks, fmi3Instance instance, const fmi3ValueReference valueReferences[],
            size_t nValueReferences, fmi3Float64 shifts[])
UNSUPPORTED(fmi3GetShiftFraction, no_clocks, fmi3Instance instance, const fmi3ValueReference valueReferences[],
            size_t nValueReferences, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
UNSUPPORTED(fmi3SetIntervalDecimal, no_clocks, fmi3Instance instance, const fmi3ValueReference valueReferences[],
            size_t nValueReferences, const fmi3Float64 intervals[])
UNSUPPORTED(fmi3SetIntervalFraction, no_clocks, fmi3Instance instance, const fmi3ValueReference valueReferences[],
            size_t nValueReferences, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
UNSUPPORTED(fmi3SetShiftDecimal, no_clocks, fmi3Instance instance, const fmi3ValueReference valueReferences[],
            size_t nValueReferences, const fmi3Float64 shifts[])
UNSUPPORTED(fmi3SetShiftFraction, no_clocks, fmi3Instance instance, const fmi3ValueReference valueReferences[],
            size_t nValueReferences, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
UNSUPPORTED(fmi3ActivateModelPartition, no_clocks, fmi3Instance instance, fmi3ValueReference clockReference,
            fmi3Float64 activationTime)

UNSUPPORTED(fmi3EnterContinuousTimeMode, co_simulation_only, fmi3Instance instance)
UNSUPPORTED(fmi3CompletedIntegratorStep, co_simulation_only, fmi3Instance instance,
            fmi3Boolean noSetFMUStatePriorToCurrentPoint, fmi3Boolean *enterEventMode, fmi3Boolean *terminateSimulation)
UNSUPPORTED(fmi3SetTime, co_simulation_only, fmi3Instance instance, fmi3Float64 time)
UNSUPPORTED(fmi3SetContinuousStates, co_simulation_only, fmi3Instance instance, const fmi3Float64 continuousStates[],
            size_t nContinuousStates)
UNSUPPORTED(fmi3GetContinuousStateDerivatives, co_simulation_only, fmi3Instance instance, fmi3Float64 derivatives[],
            size_t nContinuousStates)
UNSUPPORTED(fmi3GetEventIndicators, co_simulation_only, fmi3Instance instance, fmi3Float64 eventIndicators[],
            size_t nEventIndicators)
UNSUPPORTED(fmi3GetContinuousStates, co_simulation_only, fmi3Instance instance, fmi3Float64 continuousStates[],
            size_t nContinuousStates)
UNSUPPORTED(fmi3GetNominalsOfContinuousStates, co_simulation_only, fmi3Instance instance, fmi3Float64 nominals[],
            size_t nContinuousStates)
UNSUPPORTED(fmi3GetNumberOfEventIndicators, co_simulation_only, fmi3Instance instance, size_t *nEventIndicators)
UNSUPPORTED(fmi3GetNumberOfContinuousStates, co_simulation_only, fmi3Instance instance, size_t *nContinuousStates)
