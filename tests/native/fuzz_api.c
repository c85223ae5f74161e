/* Bytes as a sequence of calls of an FMU, for libFuzzer; see tests/system/hostile/guided.py. With STANDALONE the files
 * of the command line are such bytes; with THREADS each input runs in two threads at once, with an instance each.
 *
 * It aborts where a step leaves an output that is not finite, or a refused call changes the saved state. */
#include "api.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#ifdef THREADS
#include <pthread.h>
#endif

static const Variable variables[VARIABLE_COUNT] = {MODEL_VARIABLES};

enum { OK, WARNING, DISCARD, ERROR };
enum { MOST_CALLS = 400, TEXT = 40 };

/* Longest time that one input may simulate, in s: longer ones find nothing and take long. */
static const double most_time = 60.0;

typedef struct {
    const uint8_t *at, *end;
} Input;

typedef struct {
    Fmu fmu;
    MessageLog messages;
    void *state;            /* saved, or NULL */
    double time, simulated; /* in s */
} Run;

#define REQUIRE(condition, what)                                          \
    do {                                                                  \
        if (!(condition)) {                                               \
            fprintf(stderr, "fuzz_api.c: expected %s, got none\n", what); \
            abort();                                                      \
        }                                                                 \
    } while (0)

static uint8_t take_byte(Input *input)
{
    return input->at < input->end ? *input->at++ : 0;
}

static double take_double(Input *input)
{
    static const double special[] = {0.0, -0.0, 1.0, -1.0, 1e-100, 1e100, 1e308, -1e308, 5e-324, 0.05, 80.0, 1000.0};
    const uint8_t kind = take_byte(input);
    double value = 0.0;
    if (kind < 64) {
        return special[kind % (sizeof special / sizeof *special)];
    }
    if (kind < 192) {
        return ((double)kind - 128.0) * 0.001 * take_byte(input);
    }
    if (kind < 200) {
        return kind % 2 ? NAN : INFINITY;
    }
    if ((size_t)(input->end - input->at) >= sizeof value) {
        memcpy(&value, input->at, sizeof value);
        input->at += sizeof value;
    }
    return value;
}

static double take_step_size(Input *input)
{
    static const double sizes[] = {0.002, 0.002, 0.002, 1e-6, 0.0005, 0.01, 0.1, 1.0, 10.0};
    const uint8_t kind = take_byte(input);
    return kind < 240 ? sizes[kind % (sizeof sizes / sizeof *sizes)] : take_double(input);
}

/* Save the state as bytes; returns NULL where there is no instance. */
static char *saved(const Run *run, size_t *size)
{
    void *state = NULL;
    char *bytes = NULL;
    *size = 0;
    if (run->fmu != NULL && get_state(run->fmu, &state) == OK) {
        REQUIRE(state_size(run->fmu, state, size) == OK, "the size of a state");
        bytes = malloc(*size);
        REQUIRE(bytes != NULL && to_bytes(run->fmu, state, bytes, *size) == OK, "the bytes of a state");
        REQUIRE(free_state(run->fmu, &state) == OK && state == NULL, "a state that can be freed");
    }
    return bytes;
}

static void check_outputs(Run *run)
{
    for (uint32_t i = FIRST_OUTPUT; i < FIRST_OUTPUT + OUTPUT_COUNT; ++i) {
        double value = 0.0;
        REQUIRE(get(run->fmu, variables[i].type, &i, 1, &value) == OK && isfinite(value), "an output that is finite");
    }
}

static Code set_anything(Run *run, Input *input)
{
    const uint32_t reference = take_byte(input) % (VARIABLE_COUNT + 2);
    if (reference < VARIABLE_COUNT && variables[reference].type == TYPE_TEXT) {
        char text[TEXT + 1] = {0};
        for (size_t i = 0, length = take_byte(input) % TEXT; i < length; ++i) {
            text[i] = (char)(1 + take_byte(input) % 255);
        }
        return set_text(run->fmu, reference, text);
    }
    double value = take_double(input);
    const Type type = reference < VARIABLE_COUNT ? variables[reference].type : TYPE_REAL;
    if (type != TYPE_REAL) {
        value = isfinite(value) ? fmod(value, 100.0) : 1.0; /* api.h converts it to int */
    }
    return set(run->fmu, type, &reference, 1, &value);
}

/* Restore a state whose bytes were changed; what is refused and what is taken must both be harmless. */
static Code restore_spoiled(Run *run, Input *input)
{
    size_t size = 0;
    void *state = NULL;
    char *bytes = saved(run, &size);
    if (bytes == NULL) {
        return OK;
    }
    for (int i = take_byte(input) % 4; i > 0; --i) {
        const size_t at = (size_t)take_byte(input) * 256 + take_byte(input);
        bytes[at % size] = (char)take_byte(input);
    }
    const size_t given = take_byte(input) < 250 ? size : take_byte(input) % size;
    Code code = from_bytes(run->fmu, bytes, given, &state);
    if (code == OK) {
        code = set_state(run->fmu, state);
        free_state(run->fmu, &state);
    }
    free(bytes);
    return code;
}

static Code step_on(Run *run, Input *input)
{
    const double size = take_step_size(input);
    const double time = take_byte(input) < 230 ? run->time : take_double(input);
    if (size > 0.0 && run->simulated + size > most_time) {
        return OK;
    }
    const Code code = step(run->fmu, time, size);
    if (code == OK || code == WARNING) {
        run->time = time + size;
        run->simulated += size;
        check_outputs(run);
    }
    return code;
}

static Code start(Run *run, Input *input)
{
    static const double times[] = {0.0, 0.0, 0.5, -3.0, 1e8};
    const double time = times[take_byte(input) % 5];
    const Code code = begin(run->fmu, time);
    run->time = code == OK ? time : run->time;
    return code;
}

static Code keep_state(Run *run)
{
    return get_state(run->fmu, &run->state);
}

static Code make_anew(Run *run)
{
    free_state(run->fmu, &run->state);
    discard(run->fmu);
    run->fmu = make("it", MODEL_TOKEN, true, &run->messages);
    REQUIRE(run->fmu != NULL, "an instance");
    run->state = NULL;
    return OK;
}

static Code call_once(Run *run, Input *input)
{
    const uint8_t kind = take_byte(input) % 32;
    int not_refused = 0;
    switch (kind) {
    case 0:
        return start(run, input);
    case 1:
        return end(run->fmu);
    case 2:
        return terminate_run(run->fmu);
    case 3:
        return reset(run->fmu);
    case 4:
        return keep_state(run);
    case 5:
        return run->state != NULL ? set_state(run->fmu, run->state) : OK;
    case 6:
        return run->state != NULL ? free_state(run->fmu, &run->state) : OK;
    case 7:
    case 8:
        return restore_spoiled(run, input);
    case 9:
        return make_anew(run);
    case 10:
        return set_logging(run->fmu, take_byte(input) % 2, 0, NULL);
    case 11:
        call_unsupported(run->fmu, &not_refused);
        REQUIRE(not_refused == 0, "unsupported functions that are refused");
        return OK;
    default:
        return kind < 20 ? set_anything(run, input) : step_on(run, input);
    }
}

/* Whether a call's refusal has to leave the state as it was: begin is two calls in FMI 2, and the first one counts. */
static bool leaves_no_trace(uint8_t kind)
{
    return kind % 32 != 0;
}

static void *play(void *bytes)
{
    Input input = *(Input *)bytes;
    Run run = {0};
    make_anew(&run);
    for (int i = 0; i < MOST_CALLS && input.at < input.end; ++i) {
        const uint8_t kind = *input.at;
        size_t before_size, after_size;
        char *before = leaves_no_trace(kind) ? saved(&run, &before_size) : NULL;
        const Code code = call_once(&run, &input);
        if (code == ERROR && before != NULL) {
            char *after = saved(&run, &after_size);
            REQUIRE(after != NULL && after_size == before_size && memcmp(before, after, before_size) == 0,
                    "a refused call without a trace");
            free(after);
        }
        free(before);
    }
    free_state(run.fmu, &run.state);
    discard(run.fmu);
    return NULL;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Input input = {data, data + size};
#ifdef THREADS
    pthread_t threads[2];
    for (int i = 0; i < 2; ++i) {
        REQUIRE(pthread_create(&threads[i], NULL, play, &input) == 0, "a thread");
    }
    for (int i = 0; i < 2; ++i) {
        pthread_join(threads[i], NULL);
    }
#else
    play(&input);
#endif
    return 0;
}

#ifdef STANDALONE
int main(int count, char **files)
{
    for (int i = 1; i < count; ++i) {
        static uint8_t data[1 << 16];
        FILE *stream = fopen(files[i], "rb");
        REQUIRE(stream != NULL, "a file that can be read");
        const size_t size = fread(data, 1, sizeof data, stream);
        fclose(stream);
        LLVMFuzzerTestOneInput(data, size);
    }
    printf("%d inputs\n", count - 1);
    return 0;
}
#endif
