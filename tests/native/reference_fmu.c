/* FMUs in the manner of the public reference models, FMI 2 or 3 (-DFMI=): a linear test equation with a fixed internal
   step, a feedthrough of all types, a stair that asks for the end of the run. All are in one library and distinguished by
   their token; all variables are there in all of them, and the descriptions show those of the model.

   One fault at most is built in, named in the text after FAULT= below, which the tests overwrite in the library. */

#define _GNU_SOURCE
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
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

static const volatile char marker[] = "FAULT=none                            ";

static bool faulty(const char *name)
{
    for (size_t i = 0; i <= strlen(name); i++)
        if (marker[6 + i] != (name[i] ? name[i] : ' '))
            return false;
    return true;
}

/* ---- the model --------------------------------------------------------------------------------------------------- */

enum { NUMBERS = 48, TEXT = 64 };
enum { TIME = 0, X = 1, DER_X = 2, K = 3, BOUNDED = 5, FIRST_INPUT = 10, LAST_INPUT = 28, COUNTER = 30 };
enum { TEXT_IN = 32, BYTES_IN = 34 }; /* each with its output behind it, as the even ones of 10 to 28 */
enum { PAIR = 36, GAINS = 37, SIZE = 38, FIRST_GAIN = 40, LAST_GAIN = 42 }; /* GAINS is an array of SIZE numbers */

typedef enum { INSTANTIATED, INITIALISING, STEPPING, TERMINATED } Phase;

typedef struct {
    double numbers[NUMBERS];
    char texts[2][TEXT];
    uint8_t bytes[2][TEXT];
    size_t lengths[2];
    Phase phase;
} State;

typedef struct {
    State state;
    double stop_time;
    bool stair, ended;
    char name[TEXT], resources[256];
    void *environment;
#if FMI == 2
    const fmi2CallbackFunctions *host;
#else
    fmi3LogMessageCallback log;
#endif
} Model;

static const double internal_step = 0.1;
static int alive, made; /* instances */
static void *volatile leaked;
static Model *first; /* of the instances that live */

static Status fail(const Model *instance, const char *message)
{
#if FMI == 2
    instance->host->logger(instance->environment, instance->name, fmi2Error, "logStatusError", "%s", message);
#else
    instance->log(instance->environment, fmi3Error, "logStatusError", message);
#endif
    return F(Error);
}

static void start_values(Model *instance)
{
    State *s = &instance->state;
    memset(s, 0, sizeof *s);
    s->numbers[X] = s->numbers[K] = 1.0;
    s->numbers[BOUNDED] = 2.0;
    s->numbers[COUNTER] = s->numbers[20] = s->numbers[21] = 1.0;
    s->numbers[SIZE] = 3.0;
    for (int i = FIRST_GAIN; i <= LAST_GAIN; i++)
        s->numbers[i] = i - FIRST_GAIN + 1.0;
    strcpy(s->texts[0], "Set me!");
    memcpy(s->bytes[0], "foo", s->lengths[0] = 3);
    instance->stop_time = INFINITY;
}

static void update(Model *instance)
{
    State *s = &instance->state;
    double *v = s->numbers;
    v[DER_X] = -v[K] * v[X];
    for (int i = FIRST_INPUT; i <= LAST_INPUT; i += 2)
        v[i + 1] = v[i];
    memcpy(s->texts[1], s->texts[0], TEXT);
    memcpy(s->bytes[1], s->bytes[0], TEXT);
    s->lengths[1] = s->lengths[0];
    if (faulty("nan"))
        v[11] = NAN;
    if (faulty("bounds") && v[TIME] > 0.45)
        v[11] = 1e6;
}

static void internal_steps(Model *instance, double until)
{
    double *v = instance->state.numbers;
    while (v[TIME] + internal_step / 2 < until) {
        update(instance);
        v[X] += internal_step * (v[DER_X] + v[10]);
        v[TIME] = internal_step * round(v[TIME] / internal_step + 1.0);
        if (instance->stair && v[TIME] + 1e-9 >= v[COUNTER])
            v[COUNTER] += 1.0;
    }
}

/* ---- what the standards share ------------------------------------------------------------------------------------ */

static void leave_behind(Model *instance)
{
    char path[300];
    if (faulty("stdout"))
        puts("hello");
    if (faulty("stderr"))
        fputs("hello\n", stderr);
    if (faulty("file"))
        fclose(fopen("left.txt", "w"));
    if (faulty("resource")) {
        snprintf(path, sizeof path, "%s/left.txt", instance->resources);
        fclose(fopen(path, "w"));
    }
    if (faulty("chdir") && chdir("/") != 0)
        abort();
#ifdef __x86_64__
    if (faulty("denormals"))
        __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040);
#endif
    if (faulty("memory"))
        memset(leaked = malloc(8192), 1, 8192);
    if (faulty("descriptor"))
        (void)!fopen("/dev/null", "r");
}

/* Whether the host gets no further instance: of 50, or of one at a time. */
static bool refused(void)
{
    if (alive && faulty("once_crash"))
        abort();
    if (alive && faulty("once_reset"))
        first->state.numbers[X] = 0.0;
    made++;
    return (faulty("licence") && made > 50) || (alive && (faulty("once") || faulty("once_reset")));
}

static Model *make(const char *name, const char *token, const char *resources)
{
    static const char *const tokens[] = {"{dahlquist}", "{feedthrough}", "{stair}"};
    int model = 0;
    while (model < 3 && strcmp(token, tokens[model]) != 0)
        model++;
    if (model == 3 && !faulty("token"))
        return NULL;
    Model *instance = calloc(1, sizeof *instance);
    snprintf(instance->name, TEXT, "%s", name);
    snprintf(instance->resources, sizeof instance->resources, "%s",
             strncmp(resources, "file://", 7) ? resources : resources + 7);
    instance->stair = model == 2;
    start_values(instance);
    leave_behind(instance);
    if (!alive++)
        first = instance;
    return instance;
}

static Status enter(Model *instance, double start, double stop)
{
    if (instance->state.phase != INSTANTIATED && !faulty("order"))
        return fail(instance, "initialisation: out of order");
    instance->state.phase = INITIALISING;
    instance->state.numbers[TIME] = start;
    instance->stop_time = stop;
    return F(OK);
}

static Status leave(Model *instance)
{
    if (faulty("order_crash") && instance->state.phase != INITIALISING)
        abort();
    if (instance->state.phase != INITIALISING && !faulty("order"))
        return fail(instance, "end of initialisation: out of order");
    instance->state.phase = STEPPING;
    update(instance);
    return F(OK);
}

static Status step(Model *instance, double time, double size)
{
    double *v = instance->state.numbers;
    if (instance->state.phase != STEPPING && !faulty("order"))
        return fail(instance, "step: out of order");
    if (size <= 0.0 && !faulty("backward"))
        return fail(instance, "step: size is not above 0");
    if (time + size > instance->stop_time * (1.0 + 1e-9) && !faulty("stop"))
        return fail(instance, "step: past the stop time");
    if (faulty("fixed_step") && fabs(size - internal_step) > 1e-9)
        return fail(instance, "step: another size");
    if (time > 1.25 && time < 1.35) { /* late in a run, so that the plain sequence reaches it */
        if (faulty("crash"))
            abort();
        if (faulty("exit"))
            exit(3);
        if (faulty("error"))
            return fail(instance, "step: something is wrong");
        if (faulty("hang"))
            for (;;)
                pause();
    }
    if (faulty("shared"))
        v[X] += alive - 1;
    if (faulty("random")) {
        struct timespec now;
        clock_gettime(CLOCK_MONOTONIC, &now);
        v[X] += 1e-9 * (double)now.tv_nsec;
    }
    if (faulty("constant"))
        v[K] += 0.5;
    internal_steps(instance, time + size);
    update(instance);
    if (faulty("time"))
        v[TIME] -= 0.05;
    instance->ended = instance->stair && v[TIME] > 1.55;
    return F(OK);
}

static Status terminate(Model *instance)
{
    if (instance->state.phase != STEPPING)
        return fail(instance, "terminate: out of order");
    instance->state.phase = TERMINATED;
    if (faulty("terminated"))
        instance->state.numbers[X] = 0.0;
    return F(OK);
}

static Status reset(Model *instance)
{
    const double x = instance->state.numbers[X];
    start_values(instance);
    if (faulty("reset"))
        instance->state.numbers[X] = x;
    return F(OK);
}

static void release(Model *instance)
{
    if (instance == NULL && faulty("free_null"))
        abort();
    alive -= instance != NULL;
    free(instance);
}

static bool may_set(const Model *instance, unsigned reference)
{
    const bool is_fixed = reference == K || reference == BOUNDED || reference >= GAINS;
    return instance->state.phase < STEPPING || !is_fixed || faulty("fixed");
}

static Status set_number(Model *instance, unsigned reference, double value)
{
    if (!may_set(instance, reference))
        return fail(instance, "set: out of order");
    if (faulty("input") && reference == 10 && value != 0.0)
        return fail(instance, "set: an input does not move");
    if (faulty("clamps") && reference == BOUNDED && value > 4.0)
        value = 4.0;
    if (faulty("array_first") && reference > FIRST_GAIN)
        return F(OK);
    if (faulty("array_past") && reference == LAST_GAIN)
        instance->state.numbers[BOUNDED] = 3.0;
    instance->state.numbers[reference] = value;
    if (instance->state.phase != STEPPING)
        update(instance);
    return F(OK);
}

static Status get_state(const Model *instance, void **state)
{
    if (*state == NULL)
        *state = malloc(sizeof(State));
    memcpy(*state, &instance->state, sizeof(State));
    return F(OK);
}

static Status set_state(Model *instance, const void *state)
{
    const double x = instance->state.numbers[X];
    memcpy(&instance->state, state, sizeof(State));
    if (faulty("state"))
        instance->state.numbers[X] = x;
    return F(OK);
}

static Status free_state(void **state)
{
    free(*state);
    if (!faulty("state_free"))
        *state = NULL;
    return F(OK);
}

static Status to_bytes(const void *state, void *bytes)
{
    memcpy(bytes, state, sizeof(State));
    if (faulty("serialise"))
        ((State *)bytes)->numbers[X] = 0.5;
    return F(OK);
}

static Status from_bytes(const void *bytes, size_t size, void **state)
{
    if (size != sizeof(State))
        return F(Error);
    *state = malloc(sizeof(State));
    memcpy(*state, bytes, size);
    return F(OK);
}

#define UNUSED(name)     \
    Status name(void)    \
    {                    \
        return F(Error); \
    }

/* ---- FMI 2 ------------------------------------------------------------------------------------------------------- */

#if FMI == 2

const char *fmi2GetTypesPlatform(void)
{
    return fmi2TypesPlatform;
}
const char *fmi2GetVersion(void)
{
    return faulty("version") ? "1.0" : "2.0";
}

void *fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                      const fmi2CallbackFunctions *host, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)visible, (void)logging;
    if (refused()) {
        host->logger(host->componentEnvironment, name, fmi2Error, "logStatusError", "no licence");
        host->logger(host->componentEnvironment, name, fmi2OK, "logStatusError", "good bye");
        return NULL;
    }
    Model *instance = type == fmi2CoSimulation ? make(name, token, resources) : NULL;
    if (instance) {
        instance->host = host;
        instance->environment = host->componentEnvironment;
    }
    return instance;
}

void fmi2FreeInstance(void *instance)
{
    release(instance);
}

Status fmi2SetDebugLogging(void *instance, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)on, (void)categories;
    return n && faulty("logging") ? fail(instance, "no such category") : fmi2OK;
}

Status fmi2SetupExperiment(void *c, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start, fmi2Boolean stops,
                           fmi2Real stop)
{
    (void)tolerant, (void)tolerance;
    Model *instance = c;
    if (instance->state.phase != INSTANTIATED && !faulty("order"))
        return fail(instance, "set-up: out of order");
    instance->state.numbers[TIME] = start;
    instance->stop_time = stops ? stop : INFINITY;
    return fmi2OK;
}

Status fmi2EnterInitializationMode(void *c)
{
    Model *instance = c;
    return enter(instance, instance->state.numbers[TIME], instance->stop_time);
}

Status fmi2ExitInitializationMode(void *instance)
{
    return leave(instance);
}
Status fmi2Terminate(void *instance)
{
    return terminate(instance);
}
Status fmi2Reset(void *instance)
{
    return reset(instance);
}

Status fmi2DoStep(void *c, fmi2Real time, fmi2Real size, fmi2Boolean no_set_state)
{
    (void)no_set_state;
    Model *instance = c;
    const Status status = step(instance, time, size);
    return status == fmi2OK && instance->ended ? fmi2Discard : status;
}

Status fmi2GetBooleanStatus(void *c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    *value = kind == fmi2Terminated && ((Model *)c)->ended;
    return fmi2OK;
}

#define EACH                                                                          \
    for (size_t i = 0; i < n; i++) {                                                  \
        const Status status = set_number(instance, references[i], (double)values[i]); \
        if (status != F(OK))                                                          \
            return status;                                                            \
    }

#define ACCESS(name, type)                                                                            \
    Status fmi2Get##name(void *c, const fmi2ValueReference *references, size_t n, type *values)       \
    {                                                                                                 \
        const Model *instance = c;                                                                    \
        for (size_t i = 0; i < n; i++)                                                                \
            values[i] = (type)instance->state.numbers[references[i]];                                 \
        return fmi2OK;                                                                                \
    }                                                                                                 \
    Status fmi2Set##name(void *c, const fmi2ValueReference *references, size_t n, const type *values) \
    {                                                                                                 \
        Model *instance = c;                                                                          \
        EACH return fmi2OK;                                                                           \
    }

ACCESS(Real, fmi2Real)
ACCESS(Integer, fmi2Integer)
ACCESS(Boolean, fmi2Boolean)

Status fmi2GetString(void *c, const fmi2ValueReference *references, size_t n, fmi2String *values)
{
    for (size_t i = 0; i < n; i++)
        values[i] = ((Model *)c)->state.texts[references[i] - TEXT_IN];
    return fmi2OK;
}

Status fmi2SetString(void *c, const fmi2ValueReference *references, size_t n, const fmi2String *values)
{
    if (((Model *)c)->state.phase >= STEPPING)
        return fail(c, "set: out of order");
    for (size_t i = 0; i < n; i++)
        snprintf(((Model *)c)->state.texts[references[i] - TEXT_IN], TEXT, "%s", values[i]);
    return fmi2OK;
}

Status fmi2GetFMUstate(void *instance, fmi2FMUstate *state)
{
    return get_state(instance, state);
}
Status fmi2SetFMUstate(void *instance, fmi2FMUstate state)
{
    return set_state(instance, state);
}
Status fmi2FreeFMUstate(void *instance, fmi2FMUstate *state)
{
    return (void)instance, free_state(state);
}
Status fmi2SerializedFMUstateSize(void *instance, fmi2FMUstate state, size_t *size)
{
    (void)instance, (void)state;
    *size = sizeof(State);
    return fmi2OK;
}
Status fmi2SerializeFMUstate(void *instance, fmi2FMUstate state, fmi2Byte *bytes, size_t size)
{
    return size < sizeof(State) ? fail(instance, "too small") : to_bytes(state, bytes);
}
Status fmi2DeSerializeFMUstate(void *instance, const fmi2Byte *bytes, size_t size, fmi2FMUstate *state)
{
    (void)instance;
    return from_bytes(bytes, size, state);
}

UNUSED(fmi2GetDirectionalDerivative)
UNUSED(fmi2SetRealInputDerivatives) UNUSED(fmi2GetRealOutputDerivatives) UNUSED(fmi2CancelStep) UNUSED(fmi2GetStatus)
    UNUSED(fmi2GetRealStatus) UNUSED(fmi2GetIntegerStatus) UNUSED(fmi2GetStringStatus)

/* ---- FMI 3 ------------------------------------------------------------------------------------------------------- */

#else

const char *fmi3GetVersion(void)
{
    return faulty("version") ? "2.0" : "3.0";
}

void *fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, bool visible, bool logging,
                                  bool event_mode, bool early_return, const fmi3ValueReference required[], size_t n,
                                  void *environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback up)
{
    (void)visible, (void)logging, (void)event_mode, (void)early_return, (void)required, (void)n, (void)up;
    if (refused()) {
        log(environment, fmi3Error, "logStatusError", "no licence");
        log(environment, fmi3OK, "logStatusError", "good bye");
        return NULL;
    }
    Model *instance = make(name, token, resources);
    if (instance) {
        instance->environment = environment;
        instance->log = log;
    }
    return instance;
}

void fmi3FreeInstance(void *instance)
{
    release(instance);
}

Status fmi3SetDebugLogging(void *instance, bool on, size_t n, const fmi3String categories[])
{
    (void)on, (void)categories;
    return n && faulty("logging") ? fail(instance, "no such category") : fmi3OK;
}

Status fmi3EnterInitializationMode(void *instance, bool tolerant, double tolerance, double start, bool stops,
                                   double stop)
{
    (void)tolerant, (void)tolerance;
    return enter(instance, start, stops ? stop : INFINITY);
}

Status fmi3ExitInitializationMode(void *instance)
{
    return leave(instance);
}
Status fmi3Terminate(void *instance)
{
    return terminate(instance);
}
Status fmi3Reset(void *instance)
{
    return reset(instance);
}

Status fmi3DoStep(void *c, double time, double size, bool no_set_state, bool *event, bool *ends, bool *early,
                  double *reached)
{
    (void)no_set_state;
    Model *instance = c;
    const Status status = step(instance, time, size);
    *event = *early = false;
    *ends = instance->ended;
    *reached = instance->state.numbers[TIME];
    return status;
}

/* The elements of the array PAIR are the input 10 and its opposite. */
static size_t elements(unsigned reference)
{
    return reference == PAIR ? 2 : reference == GAINS ? LAST_GAIN - FIRST_GAIN + 1 : 1;
}

static double element(const Model *instance, unsigned reference, size_t i, size_t references)
{
    const double *v = instance->state.numbers;
    if (faulty("array_order") && reference == GAINS && references > 6 && instance->state.phase == INITIALISING)
        i = elements(reference) - 1 - i;
    return reference == PAIR ? (i ? -v[10] : v[10]) : v[reference == GAINS ? FIRST_GAIN + i : reference];
}

#define ACCESS(name, type)                                                                                          \
    Status fmi3Get##name(void *c, const fmi3ValueReference *references, size_t n, type *values, size_t count)       \
    {                                                                                                               \
        const Model *instance = c;                                                                                  \
        size_t at = 0;                                                                                              \
        for (size_t i = 0; i < n; i++) {                                                                            \
            if (at + elements(references[i]) > count)                                                               \
                return fail(instance, "get: too few values");                                                       \
            for (size_t k = 0; k < elements(references[i]); k++)                                                    \
                values[at++] = (type)element(instance, references[i], k, n);                                        \
        }                                                                                                           \
        return at == count ? fmi3OK : fail(instance, "get: too many values");                                       \
    }                                                                                                               \
    Status fmi3Set##name(void *c, const fmi3ValueReference *references, size_t n, const type *values, size_t count) \
    {                                                                                                               \
        Model *instance = c;                                                                                        \
        size_t at = 0;                                                                                              \
        for (size_t i = 0; i < n; i++) {                                                                            \
            const unsigned base = references[i] == GAINS ? FIRST_GAIN : references[i];                              \
            if (at + elements(references[i]) > count)                                                               \
                return fail(instance, "set: too few values");                                                       \
            for (size_t k = 0; k < elements(references[i]); k++) {                                                  \
                const Status status = set_number(instance, base + k, (double)values[at++]);                         \
                if (status != F(OK))                                                                                \
                    return status;                                                                                  \
            }                                                                                                       \
        }                                                                                                           \
        return at == count ? fmi3OK : fail(instance, "set: too many values");                                       \
    }

ACCESS(Float64, double)
ACCESS(Float32, float)
ACCESS(Int8, int8_t)
ACCESS(UInt8, uint8_t)
ACCESS(Int16, int16_t)
ACCESS(UInt16, uint16_t)
ACCESS(Int32, int32_t)
ACCESS(UInt32, uint32_t)
ACCESS(Int64, int64_t)
ACCESS(UInt64, uint64_t)
ACCESS(Boolean, bool)

Status fmi3GetString(void *c, const fmi3ValueReference *references, size_t n, fmi3String *values, size_t count)
{
    (void)count;
    for (size_t i = 0; i < n; i++)
        values[i] = ((Model *)c)->state.texts[references[i] - TEXT_IN];
    return fmi3OK;
}

Status fmi3SetString(void *c, const fmi3ValueReference *references, size_t n, const fmi3String *values, size_t count)
{
    (void)count;
    for (size_t i = 0; i < n; i++)
        snprintf(((Model *)c)->state.texts[references[i] - TEXT_IN], TEXT, "%s", values[i]);
    return fmi3OK;
}

Status fmi3GetBinary(void *c, const fmi3ValueReference *references, size_t n, size_t *sizes, fmi3Binary *values,
                     size_t count)
{
    (void)count;
    for (size_t i = 0; i < n; i++) {
        values[i] = ((Model *)c)->state.bytes[references[i] - BYTES_IN];
        sizes[i] = ((Model *)c)->state.lengths[references[i] - BYTES_IN];
    }
    return fmi3OK;
}

Status fmi3GetFMUState(void *instance, fmi3FMUState *state)
{
    return get_state(instance, state);
}
Status fmi3SetFMUState(void *instance, fmi3FMUState state)
{
    return set_state(instance, state);
}
Status fmi3FreeFMUState(void *instance, fmi3FMUState *state)
{
    return (void)instance, free_state(state);
}
Status fmi3SerializedFMUStateSize(void *instance, fmi3FMUState state, size_t *size)
{
    (void)instance, (void)state;
    *size = sizeof(State);
    return fmi3OK;
}
Status fmi3SerializeFMUState(void *instance, fmi3FMUState state, fmi3Byte *bytes, size_t size)
{
    return size < sizeof(State) ? fail(instance, "too small") : to_bytes(state, bytes);
}
Status fmi3DeserializeFMUState(void *instance, const fmi3Byte *bytes, size_t size, fmi3FMUState *state)
{
    (void)instance;
    return from_bytes(bytes, size, state);
}

UNUSED(fmi3InstantiateModelExchange)
UNUSED(fmi3InstantiateScheduledExecution) UNUSED(fmi3EnterEventMode) UNUSED(fmi3GetClock) UNUSED(fmi3SetBinary)
    UNUSED(fmi3SetClock) UNUSED(fmi3GetNumberOfVariableDependencies) UNUSED(fmi3GetVariableDependencies)
        UNUSED(fmi3GetDirectionalDerivative) UNUSED(fmi3GetAdjointDerivative) UNUSED(fmi3EnterConfigurationMode)
            UNUSED(fmi3ExitConfigurationMode) UNUSED(fmi3GetIntervalDecimal) UNUSED(fmi3GetIntervalFraction)
                UNUSED(fmi3GetShiftDecimal) UNUSED(fmi3GetShiftFraction) UNUSED(fmi3SetIntervalDecimal)
                    UNUSED(fmi3SetIntervalFraction) UNUSED(fmi3SetShiftDecimal) UNUSED(fmi3SetShiftFraction)
                        UNUSED(fmi3EvaluateDiscreteStates) UNUSED(fmi3UpdateDiscreteStates)
                            UNUSED(fmi3EnterContinuousTimeMode) UNUSED(fmi3CompletedIntegratorStep) UNUSED(fmi3SetTime)
                                UNUSED(fmi3SetContinuousStates) UNUSED(fmi3GetContinuousStateDerivatives)
                                    UNUSED(fmi3GetEventIndicators) UNUSED(fmi3GetContinuousStates)
                                        UNUSED(fmi3GetNominalsOfContinuousStates) UNUSED(fmi3GetNumberOfEventIndicators)
                                            UNUSED(fmi3GetNumberOfContinuousStates) UNUSED(fmi3EnterStepMode)
                                                UNUSED(fmi3GetOutputDerivatives) UNUSED(fmi3ActivateModelPartition)

#endif
