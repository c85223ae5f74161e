/* The frame of a small FMU of the tests, FMI 2 or 3 (-DFMI=): tests/helpers/wild.py writes `model.h`, which holds the
 * variables and what the model does, and compiles both. */
#define _GNU_SOURCE
#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if FMI == 2
#include "fmi2Functions.h"
#define F(name) fmi2##name
typedef fmi2Status Status;
#else
#include "fmi3Functions.h"
#define F(name) fmi3##name
typedef fmi3Status Status;
#endif

enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING };
typedef enum { Real, Float32, Integer, Int8, UInt8, Int16, UInt16, Int32, UInt32, Int64, UInt64, Boolean, String } Type;
typedef const char *Text;

typedef struct Model Model;

typedef struct {
    uint32_t reference;
    Type type;
    size_t offset;
    size_t (*count)(const Model *m);
} Variable;

/* What the host says of a run, and how far it is. */
typedef struct {
    double start, stop, tolerance, time;
    bool stop_defined, tolerance_defined, initialized, configuring;
    long steps;
    char name[100];
#if FMI == 2
    const fmi2CallbackFunctions *host;
#else
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
#endif
} Run;

static Status report(const Run *run, int status, const char *format, ...);

#include "model.h"

static Status report(const Run *run, int status, const char *format, ...)
{
    char text[1000];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
#if FMI == 2
    run->host->logger(run->host->componentEnvironment, run->name, (fmi2Status)status, "log", "%s", text);
#else
    run->log(run->environment, (fmi3Status)status, "log", text);
#endif
    return (Status)status;
}

static void *place(Model *m, uint32_t reference, Type type, size_t *count)
{
    for (size_t i = 0; i < sizeof variables / sizeof *variables; ++i) {
        if (variables[i].reference == reference && variables[i].type == type) {
            *count = variables[i].count(m);
            return (char *)m + variables[i].offset;
        }
    }
    return NULL;
}

static Status get(Model *m, const uint32_t references[], size_t n, void *values, size_t size, Type type,
                  size_t value_count)
{
    const Status status = calculate(m);
    size_t done = 0;
    for (size_t i = 0; i < n; ++i) {
        size_t count;
        const void *from = place(m, references[i], type, &count);
        if (from == NULL || done + count > value_count) {
            return report(&m->run, ERROR, "get: wrong reference %u or number of values %zu", references[i],
                          value_count);
        }
        memcpy((char *)values + done * size, from, count * size);
        done += count;
    }
    return done == value_count ? status : report(&m->run, ERROR, "get: %zu values of %zu", value_count, done);
}

static Status set(Model *m, const uint32_t references[], size_t n, const void *values, size_t size, Type type,
                  size_t value_count)
{
    size_t done = 0;
    for (size_t i = 0; i < n; ++i) {
        size_t count;
        void *to = place(m, references[i], type, &count);
        if (to == NULL || done + count > value_count) {
            return report(&m->run, ERROR, "set: wrong reference %u or number of values %zu", references[i],
                          value_count);
        }
        memcpy(to, (const char *)values + done * size, count * size);
        for (size_t k = 0; type == String && k < count; ++k) { /* the host's text is gone after the call */
            ((Text *)to)[k] = strdup(((Text *)to)[k]);
        }
        done += count;
    }
    return done == value_count ? assigned(m) : report(&m->run, ERROR, "set: %zu values of %zu", value_count, done);
}

static Model *instantiate(const char *name)
{
    Model *m = calloc(1, sizeof *m);
    snprintf(m->run.name, sizeof m->run.name, "%s", name);
    start(m);
    return m;
}

static Status reset(Model *m)
{
    Run run = m->run;
    memset(m, 0, sizeof *m);
    run.steps = 0;
    run.initialized = false;
    m->run = run;
    start(m);
    return F(OK);
}

static Status set_up(Model *m, bool tolerance_defined, double tolerance, double begin, bool stop_defined, double stop)
{
    m->run.tolerance_defined = tolerance_defined;
    m->run.tolerance = tolerance;
    m->run.start = m->run.time = begin;
    m->run.stop_defined = stop_defined;
    m->run.stop = stop;
    return F(OK);
}

static Status step(Model *m, double time, double h)
{
    const Status status = advance(m, time, h);
    m->run.time = time + h;
    m->run.steps += 1;
    return status;
}

#if FMI == 2
#define ACCESS(name, type, kind)                                                                      \
    fmi2Status fmi2Get##name(fmi2Component c, const fmi2ValueReference r[], size_t n, type v[])       \
    {                                                                                                 \
        return get(c, r, n, v, sizeof *v, kind, n);                                                   \
    }                                                                                                 \
    fmi2Status fmi2Set##name(fmi2Component c, const fmi2ValueReference r[], size_t n, const type v[]) \
    {                                                                                                 \
        return set(c, r, n, v, sizeof *v, kind, n);                                                   \
    }
ACCESS(Real, fmi2Real, Real)
ACCESS(Integer, fmi2Integer, Integer)
ACCESS(Boolean, fmi2Boolean, Boolean)
ACCESS(String, fmi2String, String)

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type t, fmi2String g, fmi2String l,
                              const fmi2CallbackFunctions *host, fmi2Boolean visible, fmi2Boolean logging)
{
    (void)t, (void)g, (void)l, (void)visible, (void)logging;
    Model *m = instantiate(name);
    m->run.host = host;
    return m;
}
void fmi2FreeInstance(fmi2Component c)
{
    free(c);
}
fmi2Status fmi2Reset(fmi2Component c)
{
    return reset(c);
}
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean td, fmi2Real t, fmi2Real begin, fmi2Boolean sd,
                               fmi2Real stop)
{
    return set_up(c, td, t, begin, sd, stop);
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c)
{
    return enter(c);
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c)
{
    return ((Model *)c)->run.initialized = true, fmi2OK;
}
fmi2Status fmi2Terminate(fmi2Component c)
{
    return (void)c, fmi2OK;
}
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real h, fmi2Boolean n)
{
    return (void)n, step(c, time, h);
}
#else
#define ACCESS(name, type, kind)                                                                                \
    fmi3Status fmi3Get##name(fmi3Instance c, const fmi3ValueReference r[], size_t n, type v[], size_t nv)       \
    {                                                                                                           \
        return get(c, r, n, v, sizeof *v, kind, nv);                                                            \
    }                                                                                                           \
    fmi3Status fmi3Set##name(fmi3Instance c, const fmi3ValueReference r[], size_t n, const type v[], size_t nv) \
    {                                                                                                           \
        return set(c, r, n, v, sizeof *v, kind, nv);                                                            \
    }
ACCESS(Float64, fmi3Float64, Real)
ACCESS(Float32, fmi3Float32, Float32)
ACCESS(Int8, fmi3Int8, Int8)
ACCESS(UInt8, fmi3UInt8, UInt8)
ACCESS(Int16, fmi3Int16, Int16)
ACCESS(UInt16, fmi3UInt16, UInt16)
ACCESS(Int32, fmi3Int32, Int32)
ACCESS(UInt32, fmi3UInt32, UInt32)
ACCESS(Int64, fmi3Int64, Int64)
ACCESS(UInt64, fmi3UInt64, UInt64)
ACCESS(Boolean, fmi3Boolean, Boolean)
ACCESS(String, fmi3String, String)

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                         fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early,
                                         const fmi3ValueReference required[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback intermediate)
{
    (void)token, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)required, (void)n;
    (void)intermediate;
    Model *m = instantiate(name);
    m->run.environment = environment;
    m->run.log = log;
    return m;
}
void fmi3FreeInstance(fmi3Instance c)
{
    free(c);
}
fmi3Status fmi3Reset(fmi3Instance c)
{
    return reset(c);
}
fmi3Status fmi3EnterConfigurationMode(fmi3Instance c)
{
    return ((Model *)c)->run.configuring = true, fmi3OK;
}
fmi3Status fmi3ExitConfigurationMode(fmi3Instance c)
{
    return ((Model *)c)->run.configuring = false, fmi3OK;
}
fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean td, fmi3Float64 t, fmi3Float64 begin, fmi3Boolean sd,
                                       fmi3Float64 stop)
{
    set_up(c, td, t, begin, sd, stop);
    return enter(c);
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c)
{
    return ((Model *)c)->run.initialized = true, fmi3OK;
}
fmi3Status fmi3Terminate(fmi3Instance c)
{
    return (void)c, fmi3OK;
}
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 h, fmi3Boolean n, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *reached)
{
    (void)n;
    *event = *terminate = *early = false;
    *reached = time + h;
    return step(c, time, h);
}
#endif
