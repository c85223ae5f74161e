/* A recording's memory through the life of instances: prepared anew, refused, saved, restored, reset, freed in any
 * state. Takes the paths of a good and of a wrong file, and the names of the parameters for profile and path; a
 * sanitizer looks for leaks. Returns the number of the line that failed. */
#include "api.h"

#include <string.h>

static const Variable variables[VARIABLE_COUNT] = {MODEL_VARIABLES};

enum { FILE_PROFILE = 5 };

#define DEMAND(condition)    \
    do {                     \
        if (!(condition)) {  \
            return __LINE__; \
        }                    \
    } while (0)

static uint32_t reference(const char *name)
{
    uint32_t i = 0;
    while (strcmp(variables[i].name, name) != 0) {
        ++i;
    }
    return i;
}

static const char *profile_name, *path_name;

static int choose(Fmu fmu, const char *path)
{
    const uint32_t profile = reference(profile_name);
    const double file = FILE_PROFILE;
    return set(fmu, TYPE_INTEGER, &profile, 1, &file) == 0 && set_text(fmu, reference(path_name), path) == 0;
}

static int displaced(Fmu fmu)
{
    const uint32_t displacement = reference("floor_displacement");
    double value = 0.0;
    return get(fmu, TYPE_REAL, &displacement, 1, &value) == 0 && value != 0.0;
}

int main(int count, char *words[])
{
    if (count < 5) {
        return __LINE__;
    }
    const char *good = words[1], *wrong = words[2];
    profile_name = words[3];
    path_name = words[4];
    MessageLog messages = {0};
    void *state = NULL;
    Fmu fmu = make("instance", MODEL_TOKEN, true, &messages), other = make("other", MODEL_TOKEN, true, &messages);
    const uint32_t output = FIRST_OUTPUT;
    double value;
    DEMAND(choose(fmu, good) && get(fmu, TYPE_REAL, &output, 1, &value) == 0);
    DEMAND(choose(fmu, wrong) && get(fmu, TYPE_REAL, &output, 1, &value) == 1);
    DEMAND(begin(fmu, 0.0) == 0 && end(fmu) == 3 && strstr(messages.last, wrong) != NULL);
    DEMAND(choose(fmu, good) && end(fmu) == 0 && step(fmu, 0.0, 1.0) == 0 && displaced(fmu));
    DEMAND(get_state(fmu, &state) == 0 && set_state(fmu, state) == 0 && step(fmu, 1.0, 1.0) == 0);
    DEMAND(set_state(other, state) == 0 && step(other, 1.0, 1.0) == 0 && displaced(other));
    DEMAND(reset(other) == 0 && begin(other, 0.0) == 0 && end(other) == 0 && step(other, 0.0, 1.0) == 0);
    DEMAND(set_state(other, state) == 0 && reset(other) == 0 && choose(other, good) && begin(other, 0.0) == 0);
    DEMAND(free_state(fmu, &state) == 0);
    discard(other);
    discard(fmu);
    return 0;
}
