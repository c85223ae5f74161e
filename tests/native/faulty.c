/* A small but whole FMU for co-simulation, FMI 2 or 3 (-DFMI=), with one fault (-DWHAT= in call -DWHERE=).

   y = 2 u + t, one parameter: the time at which a fault during stepping occurs. Its calls and the begin and end of its
   life are written to the file that FAULTY_TRACE names, if any. */

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if FMI == 2
#include "fmi2FunctionTypes.h"
typedef fmi2Status Status;
#define F(name) fmi2##name
#else
#include "fmi3FunctionTypes.h"
typedef fmi3Status Status;
#define F(name) fmi3##name
#endif

enum {
    ok,
    warning,
    discard,
    error,
    fatal,
    silent_warning,
    nan_output,
    ends_early,
    prints,
    prints_once,
    sleeps,
    segfault,
    aborts,
    exits,
    interrupts,
    nothing,
    unresolved,
    missing
};
enum { load, instantiate, enter, leave, set, step, get, terminate, reset, release };

enum { TIME, U, Y, STRIKES_AT, VARIABLES };

typedef struct {
    char name[64];
    double values[VARIABLES];
    void *environment;
#if FMI == 2
    fmi2CallbackLogger log;
#else
    fmi3LogMessageCallback log;
#endif
} Faulty;

static void trace(const Faulty *instance, const char *call)
{
    const char *path = getenv("FAULTY_TRACE");
    FILE *file = path ? fopen(path, "a") : NULL;
    if (file) {
        fprintf(file, "%s %s\n", instance ? instance->name : "library", call);
        fclose(file);
    }
}

static void log_message(const Faulty *instance, Status status, const char *message)
{
#if FMI == 2
    instance->log(instance->environment, instance->name, status, "fault", message);
#else
    instance->log(instance->environment, status, "fault", message);
#endif
}

#if WHAT == 16
extern void nowhere(void);
#endif

/* Do what is wrong here, if anything. */
static Status strike(const Faulty *instance, int where)
{
    static volatile int done = 0;
    if (where != WHERE || ((where == set || where == step || where == get) &&
                           instance->values[TIME] < instance->values[STRIKES_AT] - 1e-9))
        return F(OK);
    switch (WHAT) {
    case warning:
    case discard:
    case error:
    case fatal:
        if (instance)
            log_message(instance, (Status)WHAT, "out of order");
        return (Status)WHAT;
    case silent_warning:
        return F(Warning);
    case ends_early:
        return FMI == 2 ? F(Discard) : F(OK);
    case prints:
        puts("hello from C");
        break;
    case prints_once:
        if (!done)
            puts("hello from C\nand more");
        break;
    case sleeps:
        trace(instance, "sleeps");
        sleep(3600);
        break;
    case segfault:
        raise(SIGSEGV);
        break;
    case aborts:
        abort();
    case exits:
        exit(3);
    case interrupts:
        if (!done)
            kill(getpid(), SIGINT);
        break;
#if WHAT == 16
    case unresolved:
        nowhere();
        break;
#endif
    default:
        break;
    }
    done = 1;
    return F(OK);
}

__attribute__((constructor)) static void loaded(void)
{
    strike(NULL, load);
}

static void start_values(Faulty *instance)
{
    memset(instance->values, 0, sizeof instance->values);
    instance->values[STRIKES_AT] = 0.1;
}

static Faulty *make(const char *name, void *environment)
{
    Faulty *instance = calloc(1, sizeof *instance);
    strncpy(instance->name, name, sizeof instance->name - 1);
    instance->environment = environment;
    start_values(instance);
    return instance;
}

static Faulty *made(Faulty *instance)
{
    trace(instance, "instantiate");
    strike(instance, instantiate);
    if (WHERE == instantiate && WHAT == nothing) {
        log_message(instance, F(Error), "no licence");
        free(instance);
        return NULL;
    }
    return instance;
}

static Status get_values(Faulty *instance, const unsigned *references, size_t n, double *values)
{
    for (size_t i = 0; i < n; i++)
        values[i] = instance->values[references[i]];
    return strike(instance, get);
}

static Status set_values(Faulty *instance, const unsigned *references, size_t n, const double *values)
{
    for (size_t i = 0; i < n; i++)
        instance->values[references[i]] = values[i];
    return strike(instance, set);
}

static Status do_step(Faulty *instance, double time, double size)
{
    instance->values[TIME] = time;
    Status status = strike(instance, step);
    if (status > F(Warning))
        return status;
    instance->values[TIME] = time + size;
    instance->values[Y] = 2.0 * instance->values[U] + instance->values[TIME];
    if (WHAT == nan_output && time >= instance->values[STRIKES_AT] - 1e-9)
        instance->values[Y] = NAN;
    return status;
}

static Status life(Faulty *instance, const char *name, int where)
{
    trace(instance, name);
    if (where == reset)
        start_values(instance);
    return strike(instance, where);
}

/* ---- the functions of the standards; what nobody calls here has no signature either -------------------------------
 */

#define UNUSED(name) \
    int name(void);  \
    int name(void)   \
    {                \
        return 3;    \
    }

Status F(EnterInitializationMode)(void *instance)
{
    return life(instance, "enter", enter);
}
Status F(ExitInitializationMode)(void *instance)
{
    return life(instance, "exit", leave);
}
Status F(Terminate)(void *instance)
{
    return life(instance, "terminate", terminate);
}
#if WHAT != 17
Status F(Reset)(void *instance)
{
    return life(instance, "reset", reset);
}
#endif
void F(FreeInstance)(void *instance)
{
    life(instance, "free", release);
    free(instance);
}

#if FMI == 2

const char *fmi2GetTypesPlatform(void)
{
    return "default";
}
const char *fmi2GetVersion(void)
{
    return "2.0";
}

void *fmi2Instantiate(const char *name, fmi2Type type, const char *guid, const char *resources,
                      const fmi2CallbackFunctions *functions, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)type, (void)guid, (void)resources, (void)visible, (void)logging;
    Faulty *instance = make(name, functions->componentEnvironment);
    instance->log = functions->logger;
    return made(instance);
}

Status fmi2SetupExperiment(void *instance, int defined, double tolerance, double start, int stop_defined, double stop)
{
    (void)instance, (void)defined, (void)tolerance, (void)start, (void)stop_defined, (void)stop;
    return fmi2OK;
}

Status fmi2GetReal(void *instance, const unsigned *references, size_t n, double *values)
{
    return get_values(instance, references, n, values);
}

Status fmi2SetReal(void *instance, const unsigned *references, size_t n, const double *values)
{
    return set_values(instance, references, n, values);
}

Status fmi2DoStep(void *instance, double time, double size, int no_set_state)
{
    (void)no_set_state;
    return do_step(instance, time, size);
}

Status fmi2GetBooleanStatus(void *instance, fmi2StatusKind kind, fmi2Boolean *value)
{
    (void)instance;
    *value = kind == fmi2Terminated && WHAT == ends_early;
    return fmi2OK;
}

UNUSED(fmi2SetDebugLogging)
UNUSED(fmi2GetInteger) UNUSED(fmi2GetBoolean) UNUSED(fmi2GetString) UNUSED(fmi2SetInteger) UNUSED(fmi2SetBoolean)
    UNUSED(fmi2SetString) UNUSED(fmi2GetFMUstate) UNUSED(fmi2SetFMUstate) UNUSED(fmi2FreeFMUstate)
        UNUSED(fmi2SerializedFMUstateSize) UNUSED(fmi2SerializeFMUstate) UNUSED(fmi2DeSerializeFMUstate)
            UNUSED(fmi2GetDirectionalDerivative) UNUSED(fmi2EnterEventMode) UNUSED(fmi2NewDiscreteStates)
                UNUSED(fmi2EnterContinuousTimeMode) UNUSED(fmi2CompletedIntegratorStep) UNUSED(fmi2SetTime)
                    UNUSED(fmi2SetContinuousStates) UNUSED(fmi2GetDerivatives) UNUSED(fmi2GetEventIndicators)
                        UNUSED(fmi2GetContinuousStates) UNUSED(fmi2GetNominalsOfContinuousStates)
                            UNUSED(fmi2SetRealInputDerivatives) UNUSED(fmi2GetRealOutputDerivatives)
                                UNUSED(fmi2CancelStep) UNUSED(fmi2GetStatus) UNUSED(fmi2GetRealStatus)
                                    UNUSED(fmi2GetIntegerStatus) UNUSED(fmi2GetStringStatus)

#else

const char *fmi3GetVersion(void)
{
    return "3.0";
}

void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                  bool logging, bool event_mode, bool early_return, const unsigned *required, size_t n,
                                  void *environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    (void)token, (void)resources, (void)visible, (void)logging, (void)event_mode, (void)early_return, (void)required;
    (void)n, (void)update;
    Faulty *instance = make(name, environment);
    instance->log = log;
    return made(instance);
}

Status fmi3GetFloat64(void *instance, const unsigned *references, size_t n, double *values, size_t sizes)
{
    (void)sizes;
    return get_values(instance, references, n, values);
}

Status fmi3SetFloat64(void *instance, const unsigned *references, size_t n, const double *values, size_t sizes)
{
    (void)sizes;
    return set_values(instance, references, n, values);
}

Status fmi3DoStep(void *instance, double time, double size, bool no_set_state, bool *event, bool *ends, bool *early,
                  double *reached)
{
    (void)no_set_state;
    const Faulty *self = instance;
    const Status status = do_step(instance, time, size);
    *event = *early = false;
    *ends = WHAT == ends_early && time >= self->values[STRIKES_AT] - 1e-9;
    *reached = self->values[TIME];
    return status;
}

UNUSED(fmi3SetDebugLogging)
UNUSED(fmi3InstantiateModelExchange) UNUSED(fmi3InstantiateScheduledExecution) UNUSED(fmi3EnterEventMode) UNUSED(
    fmi3GetFloat32) UNUSED(fmi3GetInt8) UNUSED(fmi3GetUInt8) UNUSED(fmi3GetInt16) UNUSED(fmi3GetUInt16)
    UNUSED(fmi3GetInt32) UNUSED(fmi3GetUInt32) UNUSED(fmi3GetInt64) UNUSED(fmi3GetUInt64) UNUSED(fmi3GetBoolean) UNUSED(
        fmi3GetString) UNUSED(fmi3GetBinary) UNUSED(fmi3GetClock) UNUSED(fmi3SetFloat32) UNUSED(fmi3SetInt8)
        UNUSED(fmi3SetUInt8) UNUSED(fmi3SetInt16) UNUSED(fmi3SetUInt16) UNUSED(fmi3SetInt32) UNUSED(
            fmi3SetUInt32) UNUSED(fmi3SetInt64) UNUSED(fmi3SetUInt64) UNUSED(fmi3SetBoolean) UNUSED(fmi3SetString)
            UNUSED(fmi3SetBinary) UNUSED(fmi3SetClock) UNUSED(fmi3GetNumberOfVariableDependencies) UNUSED(
                fmi3GetVariableDependencies) UNUSED(fmi3GetFMUState) UNUSED(fmi3SetFMUState) UNUSED(fmi3FreeFMUState)
                UNUSED(fmi3SerializedFMUStateSize) UNUSED(fmi3SerializeFMUState) UNUSED(fmi3DeserializeFMUState) UNUSED(
                    fmi3GetDirectionalDerivative) UNUSED(fmi3GetAdjointDerivative) UNUSED(fmi3EnterConfigurationMode)
                    UNUSED(fmi3ExitConfigurationMode) UNUSED(fmi3GetIntervalDecimal) UNUSED(fmi3GetIntervalFraction)
                        UNUSED(fmi3GetShiftDecimal) UNUSED(fmi3GetShiftFraction) UNUSED(fmi3SetIntervalDecimal)
                            UNUSED(fmi3SetIntervalFraction) UNUSED(fmi3SetShiftDecimal) UNUSED(fmi3SetShiftFraction)
                                UNUSED(fmi3EvaluateDiscreteStates) UNUSED(fmi3UpdateDiscreteStates)
                                    UNUSED(fmi3EnterContinuousTimeMode) UNUSED(fmi3CompletedIntegratorStep)
                                        UNUSED(fmi3SetTime) UNUSED(fmi3SetContinuousStates)
                                            UNUSED(fmi3GetContinuousStateDerivatives) UNUSED(fmi3GetEventIndicators)
                                                UNUSED(fmi3GetContinuousStates)
                                                    UNUSED(fmi3GetNominalsOfContinuousStates)
                                                        UNUSED(fmi3GetNumberOfEventIndicators)
                                                            UNUSED(fmi3GetNumberOfContinuousStates)
                                                                UNUSED(fmi3EnterStepMode)
                                                                    UNUSED(fmi3GetOutputDerivatives)
                                                                        UNUSED(fmi3ActivateModelPartition)

#endif
