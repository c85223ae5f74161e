/* A component's functions over many samples at once, for comparison with its Python twin. */
#include "component.h"

#include <stddef.h>

static const char *const texts[] = {MODEL_TEXTS};

/* Step sample after sample, each with its own row of values (parameters and inputs), state, time and step size; the
 * outputs go into the values. Returns how many were refused; these are marked and left alone. */
int parity_advance(size_t count, double *values, double *states, const double *times, const double *steps,
                   unsigned char *refused)
{
    int refusals = 0;
    for (size_t i = 0; i < count; ++i) {
        double *row = values + i * VARIABLE_COUNT;
        double *packed = states + i * STATE_COUNT;
        const ModelParameters parameters = model_parameters(row, texts);
        const ModelInputs inputs = model_inputs(row);
        ModelCoefficients coefficients;
        ModelOutputs outputs;
        ModelState state;
        refused[i] = model_prepare(&parameters, &coefficients) != NULL;
        refusals += refused[i];
        if (!refused[i]) {
            model_unpack(&state, packed);
            model_advance(&state, &inputs, &coefficients, times[i], steps[i], &outputs);
            model_pack(&state, packed);
            model_store_outputs(&outputs, row);
            model_release(&coefficients);
        }
    }
    return refusals;
}

/* The same for the start of a run. */
int parity_initialize(size_t count, double *values, double *states, const double *times, const double *steps,
                      unsigned char *refused)
{
    int refusals = 0;
    (void)steps;
    for (size_t i = 0; i < count; ++i) {
        double *row = values + i * VARIABLE_COUNT;
        const ModelParameters parameters = model_parameters(row, texts);
        const ModelInputs inputs = model_inputs(row);
        ModelCoefficients coefficients;
        ModelOutputs outputs;
        ModelState state;
        refused[i] = model_prepare(&parameters, &coefficients) != NULL;
        refusals += refused[i];
        if (!refused[i]) {
            model_initialize(&state, &inputs, &coefficients, times[i], &outputs);
            model_pack(&state, states + i * STATE_COUNT);
            model_store_outputs(&outputs, row);
            model_release(&coefficients);
        }
    }
    return refusals;
}
