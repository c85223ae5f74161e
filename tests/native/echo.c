/* An FMU for the tests of the master's loops: every output is its input plus one, of every type there is; it counts its
 * steps and says how far it came; and on demand it fails in each way a standard knows. Functions that are not written
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

static int status(const Echo *it, int fault)
{
    return it->fault == fault && it->count >= LAST_GOOD_STEP ? 3 : it->fault == WARNING ? 1 : 0;
}

static double get(const Echo *it, uint32_t reference)
{
    return reference == FAULT     ? it->fault
           : reference == COUNT   ? it->count
           : reference == REACHED ? it->reached
           : reference < OUTPUTS  ? it->inputs[reference - INPUTS]
                                  : it->outputs[reference - OUTPUTS];
}

static void set(Echo *it, uint32_t reference, double value)
{
    if (reference == FAULT) {
        it->fault = (int)value;
    } else {
        it->inputs[reference - INPUTS] = value;
    }
}

static int step(Echo *it, double time, double step_size)
{
    const int found = status(it, STEPPING);
    if (it->fault == SLOW) {
        nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    }
    for (int i = 0; i < TYPES; ++i) {
        it->outputs[i] = it->inputs[i] < 100.0 ? it->inputs[i] + 1.0 : 0.0; /* which fits into eight bits */
    }
    if (it->fault == NOT_A_NUMBER && it->count >= LAST_GOOD_STEP) {
        it->outputs[0] = NAN;
    }
    it->count += 1;
    it->reached = time + step_size;
    return found;
}

static int reset(Echo *it)
{
    memset(it, 0, sizeof *it);
    return 0;
}

#ifdef FMI2
#define ACCESS(name, type)                                                                                             \
    int fmi2Get##name(Echo *it, const uint32_t *references, size_t count, type *values)                               \
    {                                                                                                                  \
        for (size_t i = 0; i < count; ++i) {                                                                           \
            values[i] = (type)get(it, references[i]);                                                                  \
        }                                                                                                              \
        return status(it, GETTING);                                                                                    \
    }                                                                                                                  \
    int fmi2Set##name(Echo *it, const uint32_t *references, size_t count, const type *values)                         \
    {                                                                                                                  \
        for (size_t i = 0; i < count; ++i) {                                                                           \
            set(it, references[i], (double)values[i]);                                                                 \
        }                                                                                                              \
        return status(it, SETTING);                                                                                    \
    }
ACCESS(Real, double)
ACCESS(Integer, int)
ACCESS(Boolean, int)

Echo *fmi2Instantiate(void) { return calloc(1, sizeof(Echo)); }
void fmi2FreeInstance(Echo *it) { free(it); }
int fmi2Reset(Echo *it) { return reset(it); }
int fmi2DoStep(Echo *it, double time, double step_size, int last) { return (void)last, step(it, time, step_size); }
#else
#define ACCESS(name, type)                                                                                             \
    int fmi3Get##name(Echo *it, const uint32_t *references, size_t count, type *values, size_t size)                  \
    {                                                                                                                  \
        for (size_t i = 0; i < count && i < size; ++i) {                                                               \
            values[i] = (type)get(it, references[i]);                                                                  \
        }                                                                                                              \
        return status(it, GETTING);                                                                                    \
    }                                                                                                                  \
    int fmi3Set##name(Echo *it, const uint32_t *references, size_t count, const type *values, size_t size)            \
    {                                                                                                                  \
        for (size_t i = 0; i < count && i < size; ++i) {                                                               \
            set(it, references[i], (double)values[i]);                                                                 \
        }                                                                                                              \
        return status(it, SETTING);                                                                                    \
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

Echo *fmi3InstantiateCoSimulation(void) { return calloc(1, sizeof(Echo)); }
void fmi3FreeInstance(Echo *it) { free(it); }
int fmi3Reset(Echo *it) { return reset(it); }
int fmi3DoStep(Echo *it, double time, double step_size, bool last, bool *event, bool *end, bool *early, double *reached)
{
    const int found = step(it, time, step_size);
    (void)last;
    *event = false;
    *end = it->fault == ENDING && it->count > LAST_GOOD_STEP;
    *early = it->fault == EARLY && it->count > LAST_GOOD_STEP;
    *reached = *early ? time : it->reached;
    return found;
}
#endif
