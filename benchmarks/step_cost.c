/* What a step costs, in ns: the kernel's alone, and by way of the FMI 2.0 functions a host calls, setting inputs and getting
 * outputs included. Prints the medians over many rounds. */
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

static double median(double times[ROUNDS])
{
    qsort(times, ROUNDS, sizeof *times, ascending);
    return times[ROUNDS / 2];
}

/* An input that never stands still. */
static void move(double inputs[INPUT_COUNT + 1], int k)
{
    for (int i = 0; i < INPUT_COUNT; ++i) {
        inputs[i] = 0.02 * ((double)((k * (37 + i)) % 101) / 50.0 - 1.0);
    }
}

static double kernel(double *sum)
{
    static double inputs[STEPS][INPUT_COUNT + 1];
    const ModelParameters parameters = {MODEL_DEFAULTS};
    double times[ROUNDS], values[VARIABLE_COUNT] = {0.0};
    ModelCoefficients coefficients;
    ModelState state;
    ModelOutputs outputs;
    for (int k = 0; k < STEPS; ++k) {
        move(inputs[k], k);
    }
    if (model_prepare(&parameters, &coefficients) != NULL) {
        exit(1);
    }
    ModelInputs taken = model_inputs(values);
    model_initial(&state, &taken, &coefficients, 0.0, &outputs);
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
    return median(times);
}

static double through_fmi(double *sum)
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
    return median(times);
}

int main(void)
{
    double sum = 0.0;
    const double alone = kernel(&sum), fmi = through_fmi(&sum);
    printf("%.1f %.1f\n", alone, fmi);
    return isfinite(sum) ? 0 : 1;
}
