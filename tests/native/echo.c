/* An FMU for the tests of the master's loops: every output is its input plus one, of every type there is; it counts its
 * steps, outputs the time it has reached, and fails on demand in each way of the standard. Functions that are not
 * here are stubs, see tests/helpers/echo.py. */
#define _POSIX_C_SOURCE 199309L
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FAULT, COUNT, REACHED, INPUTS = 100, OUTPUTS = 200, TYPES = 16, LAST_GOOD_STEP = 50 };
enum { SETTING = 1, GETTING, STEPPING, ENDING, EARLY, WARNING, NOT_A_NUMBER, SLOW };

typedef struct {
    double inputs[TYPES], outputs[TYPES], reached;
    int fault, count;
} Echo;

static int status(const Echo *instance, int fault)
{
    return instance->fault == fault && instance->count >= LAST_GOOD_STEP ? 3 : instance->fault == WARNING ? 1 : 0;
}

static double get(const Echo *instance, uint32_t reference)
{
    return reference == FAULT     ? instance->fault
           : reference == COUNT   ? instance->count
           : reference == REACHED ? instance->reached
           : reference < OUTPUTS  ? instance->inputs[reference - INPUTS]
                                  : instance->outputs[reference - OUTPUTS];
}

static void set(Echo *instance, uint32_t reference, double value)
{
    if (reference == FAULT) {
        instance->fault = (int)value;
    } else {
        instance->inputs[reference - INPUTS] = value;
    }
}

static int step(Echo *instance, double time, double step_size)
{
    const int found = status(instance, STEPPING);
    if (instance->fault == SLOW) {
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    }
    for (int i = 0; i < TYPES; ++i) {
        instance->outputs[i] =
            instance->inputs[i] < 100.0 ? instance->inputs[i] + 1.0 : 0.0; /* which fits into eight bits */
    }
    if (instance->fault == NOT_A_NUMBER && instance->count >= LAST_GOOD_STEP) {
        instance->outputs[0] = NAN;
    }
    instance->count += 1;
    instance->reached = time + step_size;
    return found;
}

static int reset(Echo *instance)
{
    memset(instance, 0, sizeof *instance);
    return 0;
}

#ifdef FMI2
#define ACCESS(name, type)                                                                          \
    int fmi2Get##name(Echo *instance, const uint32_t *references, size_t count, type *values)       \
    {                                                                                               \
        for (size_t i = 0; i < count; ++i) {                                                        \
            values[i] = (type)get(instance, references[i]);                                         \
        }                                                                                           \
        return status(instance, GETTING);                                                           \
    }                                                                                               \
    int fmi2Set##name(Echo *instance, const uint32_t *references, size_t count, const type *values) \
    {                                                                                               \
        for (size_t i = 0; i < count; ++i) {                                                        \
            set(instance, references[i], (double)values[i]);                                        \
        }                                                                                           \
        return status(instance, SETTING);                                                           \
    }
ACCESS(Real, double)
ACCESS(Integer, int)
ACCESS(Boolean, int)

Echo *fmi2Instantiate(void)
{
    return calloc(1, sizeof(Echo));
}
void fmi2FreeInstance(Echo *instance)
{
    free(instance);
}
int fmi2Reset(Echo *instance)
{
    return reset(instance);
}
int fmi2DoStep(Echo *instance, double time, double step_size, int last)
{
    return (void)last, step(instance, time, step_size);
}
#else
#define ACCESS(name, type)                                                                                       \
    int fmi3Get##name(Echo *instance, const uint32_t *references, size_t count, type *values, size_t size)       \
    {                                                                                                            \
        for (size_t i = 0; i < count && i < size; ++i) {                                                         \
            values[i] = (type)get(instance, references[i]);                                                      \
        }                                                                                                        \
        return status(instance, GETTING);                                                                        \
    }                                                                                                            \
    int fmi3Set##name(Echo *instance, const uint32_t *references, size_t count, const type *values, size_t size) \
    {                                                                                                            \
        for (size_t i = 0; i < count && i < size; ++i) {                                                         \
            set(instance, references[i], (double)values[i]);                                                     \
        }                                                                                                        \
        return status(instance, SETTING);                                                                        \
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

Echo *fmi3InstantiateCoSimulation(void)
{
    return calloc(1, sizeof(Echo));
}
void fmi3FreeInstance(Echo *instance)
{
    free(instance);
}
int fmi3Reset(Echo *instance)
{
    return reset(instance);
}
int fmi3DoStep(Echo *instance, double time, double step_size, bool last, bool *event, bool *end, bool *early,
               double *reached)
{
    const int found = step(instance, time, step_size);
    (void)last;
    *event = false;
    *end = instance->fault == ENDING && instance->count > LAST_GOOD_STEP;
    *early = instance->fault == EARLY && instance->count > LAST_GOOD_STEP;
    *reached = *early ? time : instance->reached;
    return found;
}
#endif
