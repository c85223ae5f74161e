/* The random floor through the functions of FMI 2: class, seed and number of steps of 2 ms from the command line;
 * writes the acceleration after each step as a double to the standard output. */
#include "component.h"
#include "fmi2Functions.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static fmi2ValueReference reference(const char *name)
{
    static const Variable variables[] = {MODEL_VARIABLES};
    for (fmi2ValueReference i = 0; i < VARIABLE_COUNT; ++i) {
        if (strcmp(variables[i].name, name) == 0) {
            return i;
        }
    }
    exit(2);
}

int main(int count, char *words[])
{
    enum { RANDOM = 4, BLOCK = 4096 };
    static double block[BLOCK];
    const double h = 0.002;
    const fmi2ValueReference in[] = {reference("profile"), reference("random.class"), reference("random.seed")};
    const fmi2ValueReference out[] = {reference("floor_acceleration")};
    const fmi2Integer values[] = {RANDOM, atoi(words[1]), atoi(words[2])};
    const long steps = atol(words[count - 1]);
    const fmi2Component fmu =
        fmi2Instantiate("instance", fmi2CoSimulation, MODEL_TOKEN, "", NULL, fmi2False, fmi2False);
    if (fmi2SetInteger(fmu, in, 3, values) != fmi2OK || fmi2EnterInitializationMode(fmu) != fmi2OK ||
        fmi2ExitInitializationMode(fmu) != fmi2OK) {
        return 1;
    }
    for (long k = 0; k < steps; ++k) {
        if (fmi2DoStep(fmu, (double)k * h, h, fmi2True) != fmi2OK ||
            fmi2GetReal(fmu, out, 1, &block[k % BLOCK]) != fmi2OK) {
            return 1;
        }
        if ((k + 1) % BLOCK == 0 || k + 1 == steps) {
            fwrite(block, sizeof *block, (size_t)(k % BLOCK + 1), stdout);
        }
    }
    fmi2FreeInstance(fmu);
    return 0;
}
