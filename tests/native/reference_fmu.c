/* FMUs in the manner of the public reference models, FMI 2 or 3 (-DFMI=): a linear test equation with a fixed internal
   step, a feedthrough of all types, a stair that asks for the end of the run. All are in one library and told apart by
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

enum { NUMBERS = 40, TEXT = 64 };
enum { TIME = 0, X = 1, DER_X = 2, K = 3, BOUNDED = 5, FIRST_INPUT = 10, LAST_INPUT = 28, COUNTER = 30 };
enum { TEXT_IN = 32, BYTES_IN = 34 }; /* each with its output behind it, as the even ones of 10 to 28 */

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
static int alive; /* instances */
static void *volatile leaked;

static Status fail(const Model *it, const char *message)
{
#if FMI == 2
    it->host->logger(it->environment, it->name, fmi2Error, "logStatusError", "%s", message);
#else
    it->log(it->environment, fmi3Error, "logStatusError", message);
#endif
    return F(Error);
}

static void start_values(Model *it)
{
    State *s = &it->state;
    memset(s, 0, sizeof *s);
    s->numbers[X] = s->numbers[K] = 1.0;
    s->numbers[BOUNDED] = 2.0;
    s->numbers[COUNTER] = s->numbers[20] = s->numbers[21] = 1.0;
    strcpy(s->texts[0], "Set me!");
    memcpy(s->bytes[0], "foo", s->lengths[0] = 3);
    it->stop_time = INFINITY;
}

static void update(Model *it)
{
    State *s = &it->state;
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

static void internal_steps(Model *it, double until)
{
    double *v = it->state.numbers;
    while (v[TIME] + internal_step / 2 < until) {
        update(it);
        v[X] += internal_step * (v[DER_X] + v[10]);
        v[TIME] = internal_step * round(v[TIME] / internal_step + 1.0);
        if (it->stair && v[TIME] + 1e-9 >= v[COUNTER])
            v[COUNTER] += 1.0;
    }
}

/* ---- what the standards share ------------------------------------------------------------------------------------ */

static void leave_behind(Model *it)
{
    char path[300];
    if (faulty("stdout"))
        puts("hello");
    if (faulty("stderr"))
        fputs("hello\n", stderr);
    if (faulty("file"))
        fclose(fopen("left.txt", "w"));
    if (faulty("resource")) {
        snprintf(path, sizeof path, "%s/left.txt", it->resources);
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

static Model *make(const char *name, const char *token, const char *resources)
{
    static const char *const tokens[] = {"{dahlquist}", "{feedthrough}", "{stair}"};
    int model = 0;
    while (model < 3 && strcmp(token, tokens[model]) != 0)
        model++;
    if (model == 3 && !faulty("token"))
        return NULL;
    Model *it = calloc(1, sizeof *it);
    snprintf(it->name, TEXT, "%s", name);
    snprintf(it->resources, sizeof it->resources, "%s", strncmp(resources, "file://", 7) ? resources : resources + 7);
    it->stair = model == 2;
    start_values(it);
    leave_behind(it);
    alive++;
    return it;
}

static Status enter(Model *it, double start, double stop)
{
    if (it->state.phase != INSTANTIATED && !faulty("order"))
        return fail(it, "initialisation: out of order");
    it->state.phase = INITIALISING;
    it->state.numbers[TIME] = start;
    it->stop_time = stop;
    return F(OK);
}

static Status leave(Model *it)
{
    if (faulty("order_crash") && it->state.phase != INITIALISING)
        abort();
    if (it->state.phase != INITIALISING && !faulty("order"))
        return fail(it, "end of initialisation: out of order");
    it->state.phase = STEPPING;
    update(it);
    return F(OK);
}

static Status step(Model *it, double time, double size)
{
    double *v = it->state.numbers;
    if (it->state.phase != STEPPING && !faulty("order"))
        return fail(it, "step: out of order");
    if (size <= 0.0 && !faulty("backward"))
        return fail(it, "step: size is not above 0");
    if (time + size > it->stop_time * (1.0 + 1e-9) && !faulty("stop"))
        return fail(it, "step: past the stop time");
    if (faulty("fixed_step") && fabs(size - internal_step) > 1e-9)
        return fail(it, "step: another size");
    if (time > 1.25 && time < 1.35) { /* late in a run, so that the plain sequence meets it */
        if (faulty("crash"))
            abort();
        if (faulty("exit"))
            exit(3);
        if (faulty("error"))
            return fail(it, "step: something is wrong");
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
    internal_steps(it, time + size);
    update(it);
    if (faulty("time"))
        v[TIME] -= 0.05;
    it->ended = it->stair && v[TIME] > 1.55;
    return F(OK);
}

static Status terminate(Model *it)
{
    if (it->state.phase != STEPPING)
        return fail(it, "terminate: out of order");
    it->state.phase = TERMINATED;
    if (faulty("terminated"))
        it->state.numbers[X] = 0.0;
    return F(OK);
}

static Status reset(Model *it)
{
    const double x = it->state.numbers[X];
    start_values(it);
    if (faulty("reset"))
        it->state.numbers[X] = x;
    return F(OK);
}

static void release(Model *it)
{
    if (it == NULL && faulty("free_null"))
        abort();
    alive -= it != NULL;
    free(it);
}

static bool may_set(const Model *it, unsigned reference)
{
    return it->state.phase < STEPPING || (reference != K && reference != BOUNDED) || faulty("fixed");
}

static Status set_number(Model *it, unsigned reference, double value)
{
    if (!may_set(it, reference))
        return fail(it, "set: out of order");
    if (faulty("input") && reference == 10 && value != 0.0)
        return fail(it, "set: an input does not move");
    if (faulty("clamps") && reference == BOUNDED && value > 4.0)
        value = 4.0;
    it->state.numbers[reference] = value;
    if (it->state.phase != STEPPING)
        update(it);
    return F(OK);
}

static Status get_state(const Model *it, void **state)
{
    if (*state == NULL)
        *state = malloc(sizeof(State));
    memcpy(*state, &it->state, sizeof(State));
    return F(OK);
}

static Status set_state(Model *it, const void *state)
{
    const double x = it->state.numbers[X];
    memcpy(&it->state, state, sizeof(State));
    if (faulty("state"))
        it->state.numbers[X] = x;
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

#define EACH                                                                                                           \
    for (size_t i = 0; i < n; i++) {                                                                                   \
        const Status status = set_number(it, references[i], (double)values[i]);                                        \
        if (status != F(OK))                                                                                           \
            return status;                                                                                             \
    }

#define UNUSED(name)                                                                                                   \
    Status name(void) { return F(Error); }

/* ---- FMI 2 ------------------------------------------------------------------------------------------------------- */

#if FMI == 2

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return faulty("version") ? "1.0" : "2.0"; }

void *fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String resources,
                      const fmi2CallbackFunctions *host, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)visible, (void)logging;
    Model *it = type == fmi2CoSimulation ? make(name, token, resources) : NULL;
    if (it) {
        it->host = host;
        it->environment = host->componentEnvironment;
    }
    return it;
}

void fmi2FreeInstance(void *it) { release(it); }

Status fmi2SetDebugLogging(void *it, fmi2Boolean on, size_t n, const fmi2String categories[])
{
    (void)on, (void)categories;
    return n && faulty("logging") ? fail(it, "no such category") : fmi2OK;
}

Status fmi2SetupExperiment(void *c, fmi2Boolean tolerant, fmi2Real tolerance, fmi2Real start, fmi2Boolean stops,
                           fmi2Real stop)
{
    (void)tolerant, (void)tolerance;
    Model *it = c;
    if (it->state.phase != INSTANTIATED && !faulty("order"))
        return fail(it, "set-up: out of order");
    it->state.numbers[TIME] = start;
    it->stop_time = stops ? stop : INFINITY;
    return fmi2OK;
}

Status fmi2EnterInitializationMode(void *c)
{
    Model *it = c;
    return enter(it, it->state.numbers[TIME], it->stop_time);
}

Status fmi2ExitInitializationMode(void *it) { return leave(it); }
Status fmi2Terminate(void *it) { return terminate(it); }
Status fmi2Reset(void *it) { return reset(it); }

Status fmi2DoStep(void *c, fmi2Real time, fmi2Real size, fmi2Boolean no_set_state)
{
    (void)no_set_state;
    Model *it = c;
    const Status status = step(it, time, size);
    return status == fmi2OK && it->ended ? fmi2Discard : status;
}

Status fmi2GetBooleanStatus(void *c, const fmi2StatusKind kind, fmi2Boolean *value)
{
    *value = kind == fmi2Terminated && ((Model *)c)->ended;
    return fmi2OK;
}

#define ACCESS(name, type)                                                                                             \
    Status fmi2Get##name(void *c, const fmi2ValueReference *references, size_t n, type *values)                        \
    {                                                                                                                  \
        const Model *it = c;                                                                                           \
        for (size_t i = 0; i < n; i++)                                                                                 \
            values[i] = (type)it->state.numbers[references[i]];                                                        \
        return fmi2OK;                                                                                                 \
    }                                                                                                                  \
    Status fmi2Set##name(void *c, const fmi2ValueReference *references, size_t n, const type *values)                  \
    {                                                                                                                  \
        Model *it = c;                                                                                                 \
        EACH                                                                                                           \
        return fmi2OK;                                                                                                 \
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

Status fmi2GetFMUstate(void *it, fmi2FMUstate *state) { return get_state(it, state); }
Status fmi2SetFMUstate(void *it, fmi2FMUstate state) { return set_state(it, state); }
Status fmi2FreeFMUstate(void *it, fmi2FMUstate *state) { return (void)it, free_state(state); }
Status fmi2SerializedFMUstateSize(void *it, fmi2FMUstate state, size_t *size)
{
    (void)it, (void)state;
    *size = sizeof(State);
    return fmi2OK;
}
Status fmi2SerializeFMUstate(void *it, fmi2FMUstate state, fmi2Byte *bytes, size_t size)
{
    return size < sizeof(State) ? fail(it, "too small") : to_bytes(state, bytes);
}
Status fmi2DeSerializeFMUstate(void *it, const fmi2Byte *bytes, size_t size, fmi2FMUstate *state)
{
    (void)it;
    return from_bytes(bytes, size, state);
}

UNUSED(fmi2GetDirectionalDerivative) UNUSED(fmi2SetRealInputDerivatives) UNUSED(fmi2GetRealOutputDerivatives)
UNUSED(fmi2CancelStep) UNUSED(fmi2GetStatus) UNUSED(fmi2GetRealStatus) UNUSED(fmi2GetIntegerStatus)
UNUSED(fmi2GetStringStatus)

/* ---- FMI 3 ------------------------------------------------------------------------------------------------------- */

#else

const char *fmi3GetVersion(void) { return faulty("version") ? "2.0" : "3.0"; }

void *fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, bool visible, bool logging,
                                  bool event_mode, bool early_return, const fmi3ValueReference required[], size_t n,
                                  void *environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback up)
{
    (void)visible, (void)logging, (void)event_mode, (void)early_return, (void)required, (void)n, (void)up;
    Model *it = make(name, token, resources);
    if (it) {
        it->environment = environment;
        it->log = log;
    }
    return it;
}

void fmi3FreeInstance(void *it) { release(it); }

Status fmi3SetDebugLogging(void *it, bool on, size_t n, const fmi3String categories[])
{
    (void)on, (void)categories;
    return n && faulty("logging") ? fail(it, "no such category") : fmi3OK;
}

Status fmi3EnterInitializationMode(void *it, bool tolerant, double tolerance, double start, bool stops, double stop)
{
    (void)tolerant, (void)tolerance;
    return enter(it, start, stops ? stop : INFINITY);
}

Status fmi3ExitInitializationMode(void *it) { return leave(it); }
Status fmi3Terminate(void *it) { return terminate(it); }
Status fmi3Reset(void *it) { return reset(it); }

Status fmi3DoStep(void *c, double time, double size, bool no_set_state, bool *event, bool *ends, bool *early,
                  double *reached)
{
    (void)no_set_state;
    Model *it = c;
    const Status status = step(it, time, size);
    *event = *early = false;
    *ends = it->ended;
    *reached = it->state.numbers[TIME];
    return status;
}

/* Value reference 36 is an array of two numbers: the input 10 and its opposite. */
#define ACCESS(name, type)                                                                                             \
    Status fmi3Get##name(void *c, const fmi3ValueReference *references, size_t n, type *values, size_t count)          \
    {                                                                                                                  \
        const Model *it = c;                                                                                           \
        size_t at = 0;                                                                                                 \
        for (size_t i = 0; i < n; i++) {                                                                               \
            if (at >= count)                                                                                           \
                return fail(it, "get: too few values");                                                                \
            values[at++] = (type)it->state.numbers[references[i] == 36 ? 10 : references[i]];                          \
            if (references[i] == 36)                                                                                   \
                values[at++] = (type)-it->state.numbers[10];                                                           \
        }                                                                                                              \
        return at == count ? fmi3OK : fail(it, "get: too many values");                                                \
    }                                                                                                                  \
    Status fmi3Set##name(void *c, const fmi3ValueReference *references, size_t n, const type *values, size_t count)    \
    {                                                                                                                  \
        Model *it = c;                                                                                                 \
        (void)count;                                                                                                   \
        EACH                                                                                                           \
        return fmi3OK;                                                                                                 \
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

Status fmi3GetFMUState(void *it, fmi3FMUState *state) { return get_state(it, state); }
Status fmi3SetFMUState(void *it, fmi3FMUState state) { return set_state(it, state); }
Status fmi3FreeFMUState(void *it, fmi3FMUState *state) { return (void)it, free_state(state); }
Status fmi3SerializedFMUStateSize(void *it, fmi3FMUState state, size_t *size)
{
    (void)it, (void)state;
    *size = sizeof(State);
    return fmi3OK;
}
Status fmi3SerializeFMUState(void *it, fmi3FMUState state, fmi3Byte *bytes, size_t size)
{
    return size < sizeof(State) ? fail(it, "too small") : to_bytes(state, bytes);
}
Status fmi3DeserializeFMUState(void *it, const fmi3Byte *bytes, size_t size, fmi3FMUState *state)
{
    (void)it;
    return from_bytes(bytes, size, state);
}

UNUSED(fmi3InstantiateModelExchange) UNUSED(fmi3InstantiateScheduledExecution) UNUSED(fmi3EnterEventMode)
UNUSED(fmi3GetClock) UNUSED(fmi3SetBinary) UNUSED(fmi3SetClock) UNUSED(fmi3GetNumberOfVariableDependencies)
UNUSED(fmi3GetVariableDependencies) UNUSED(fmi3GetDirectionalDerivative) UNUSED(fmi3GetAdjointDerivative)
UNUSED(fmi3EnterConfigurationMode) UNUSED(fmi3ExitConfigurationMode) UNUSED(fmi3GetIntervalDecimal)
UNUSED(fmi3GetIntervalFraction) UNUSED(fmi3GetShiftDecimal) UNUSED(fmi3GetShiftFraction)
UNUSED(fmi3SetIntervalDecimal) UNUSED(fmi3SetIntervalFraction) UNUSED(fmi3SetShiftDecimal)
UNUSED(fmi3SetShiftFraction) UNUSED(fmi3EvaluateDiscreteStates) UNUSED(fmi3UpdateDiscreteStates)
UNUSED(fmi3EnterContinuousTimeMode) UNUSED(fmi3CompletedIntegratorStep) UNUSED(fmi3SetTime)
UNUSED(fmi3SetContinuousStates) UNUSED(fmi3GetContinuousStateDerivatives) UNUSED(fmi3GetEventIndicators)
UNUSED(fmi3GetContinuousStates) UNUSED(fmi3GetNominalsOfContinuousStates) UNUSED(fmi3GetNumberOfEventIndicators)
UNUSED(fmi3GetNumberOfContinuousStates) UNUSED(fmi3EnterStepMode) UNUSED(fmi3GetOutputDerivatives)
UNUSED(fmi3ActivateModelPartition)

#endif
