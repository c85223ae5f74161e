/* What a step costs, in ns: the kernel's alone, and by way of the FMI 2.0 functions a host calls, setting inputs and
 * getting outputs included. Prints the median over many rounds and the quickest of them, for either. */
#define _POSIX_C_SOURCE 199309L

#include "component.h"
#include "fmi2Functions.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { ROUNDS = 101, STEPS = 2000 };

static const double h = 0.002;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void report(double times[ROUNDS])
{
    qsort(times, ROUNDS, sizeof *times, ascending);
    printf("%.1f %.1f\n", times[ROUNDS / 2], times[0]);
}

/* A sine of 3 Hz and 6 mm, each input the derivative of the one before it: the floor's motion, for one. */
static void move(double inputs[INPUT_COUNT + 1], int k)
{
    const double omega = 18.85;
    double scale = 0.006;
#ifdef CHOICE
    static const double amplitudes[] = {AMPLITUDES};
#endif
    for (int i = 0; i < INPUT_COUNT; ++i) {
#ifdef CHOICE
        scale = amplitudes[i];
#endif
        inputs[i] = scale * sin(omega * (double)k * h + 1.5707963 * (double)i);
        scale *= omega;
    }
}

/* An enumeration that differs from its default: its field, value reference and value. AMPLITUDES are those of the
 * inputs then, a list. */
#ifdef CHOICE
static const fmi2ValueReference choice[] = {CHOICE_REFERENCE};
static const fmi2Integer choice_value[] = {CHOICE_VALUE};
#endif

static void kernel(double *sum)
{
    static double inputs[STEPS][INPUT_COUNT + 1];
    ModelParameters parameters = {MODEL_DEFAULTS};
    double times[ROUNDS], values[VARIABLE_COUNT] = {0.0};
    ModelCoefficients coefficients;
    ModelState state;
    ModelOutputs outputs;
    for (int k = 0; k < STEPS; ++k) {
        move(inputs[k], k);
    }
#ifdef CHOICE
    parameters.CHOICE = CHOICE_VALUE;
#endif
    if (model_prepare(&parameters, &coefficients) != NULL) {
        exit(1);
    }
    ModelInputs taken = model_inputs(values);
    model_initialize(&state, &taken, &coefficients, 0.0, &outputs);
    for (int round = 0; round < ROUNDS; ++round) {
        const double begin = now();
        for (int k = 0; k < STEPS; ++k) {
            for (int i = 0; i < INPUT_COUNT; ++i) {
                values[FIRST_INPUT + i] = inputs[k][i];
            }
            taken = model_inputs(values);
            model_advance(&state, &taken, &coefficients, (double)(round * STEPS + k) * h, h, &outputs);
            model_store_outputs(&outputs, values);
            *sum += values[FIRST_OUTPUT];
        }
        times[round] = (now() - begin) / STEPS;
    }
    report(times);
#ifdef CHOICE_NORMAL
    if (!(CHOICE_NORMAL)) { /* not what was to be measured */
        exit(1);
    }
#endif
}

static void through_fmi(double *sum)
{
    static double inputs[STEPS][INPUT_COUNT + 1];
    fmi2ValueReference in[INPUT_COUNT + 1], out[1] = {FIRST_OUTPUT};
    double times[ROUNDS], value;
    const fmi2Component fmu = fmi2Instantiate("it", fmi2CoSimulation, MODEL_TOKEN, "", NULL, fmi2False, fmi2False);
    for (int i = 0; i < INPUT_COUNT; ++i) {
        in[i] = (fmi2ValueReference)(FIRST_INPUT + i);
    }
    for (int k = 0; k < STEPS; ++k) {
        move(inputs[k], k);
    }
#ifdef CHOICE
    if (fmi2SetInteger(fmu, choice, 1, choice_value) != fmi2OK) {
        exit(1);
    }
#endif
    fmi2EnterInitializationMode(fmu);
    fmi2ExitInitializationMode(fmu);
    for (int round = 0; round < ROUNDS; ++round) {
        const double begin = now();
        for (int k = 0; k < STEPS; ++k) {
            if (fmi2SetReal(fmu, in, INPUT_COUNT, inputs[k]) != fmi2OK ||
                fmi2DoStep(fmu, (double)(round * STEPS + k) * h, h, fmi2True) != fmi2OK ||
                fmi2GetReal(fmu, out, 1, &value) != fmi2OK) {
                exit(1);
            }
            *sum += value;
        }
        times[round] = (now() - begin) / STEPS;
    }
    fmi2FreeInstance(fmu);
    report(times);
}

int main(void)
{
    double sum = 0.0;
    kernel(&sum);
    through_fmi(&sum);
    return isfinite(sum) ? 0 : 1;
}
