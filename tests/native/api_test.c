/* Every function in every state, for any component and either standard. Prints what fails; ends with the number. */
#include "api.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const Variable variables[VARIABLE_COUNT] = {MODEL_VARIABLES};
static int failures;

#define CHECK(condition)                                   \
    do {                                                   \
        if (!(condition)) {                                \
            printf("line %d: %s\n", __LINE__, #condition); \
            ++failures;                                    \
        }                                                  \
    } while (0)

enum { OK, WARNING, DISCARD, ERROR };
enum { INSTANTIATED, INITIALISING, STEPPING, TERMINATED, PHASES };

static const double h = 0.002;

/* A number in [-1, 1] that depends on its two arguments alone. */
static double noise(unsigned a, unsigned b)
{
    uint32_t x = a * 2654435761u + b * 40503u + 12345u;
    x ^= x >> 16, x *= 0x7feb352du, x ^= x >> 15, x *= 0x846ca68bu, x ^= x >> 16;
    return (double)x / 2147483648.0 - 1.0;
}

static Code get_one(Fmu fmu, uint32_t reference, double *value)
{
    return get(fmu, variables[reference].type, &reference, 1, value);
}

static Code set_one(Fmu fmu, uint32_t reference, double value)
{
    return set(fmu, variables[reference].type, &reference, 1, &value);
}

static Fmu make_in(int phase, MessageLog *messages)
{
    Fmu fmu = make("instance", MODEL_TOKEN, true, messages);
    CHECK(fmu != NULL);
    if (phase >= INITIALISING) {
        CHECK(begin(fmu, 0.0) == OK);
    }
    if (phase >= STEPPING) {
        CHECK(end(fmu) == OK);
    }
    if (phase >= TERMINATED) {
        CHECK(terminate_run(fmu) == OK);
    }
    return fmu;
}

/* Set inputs that depend on a seed and the step alone, step, read all outputs. */
static Code drive(Fmu fmu, unsigned seed, unsigned k, double outputs[OUTPUT_COUNT])
{
    for (uint32_t i = FIRST_INPUT; i < FIRST_INPUT + INPUT_COUNT; ++i) {
        CHECK(set_one(fmu, i, 0.05 * noise(seed + i, k)) == OK);
    }
    const Code code = step(fmu, k * h, h);
    for (uint32_t i = 0; i < OUTPUT_COUNT; ++i) {
        CHECK(get_one(fmu, FIRST_OUTPUT + i, &outputs[i]) == OK);
    }
    return code;
}

static bool same(const double a[OUTPUT_COUNT], const double b[OUTPUT_COUNT])
{
    return memcmp(a, b, OUTPUT_COUNT * sizeof *a) == 0;
}

/* ---- tests ------------------------------------------------------------------------------------------------------- */

static void null_instances_are_refused(void)
{
    void *state = NULL;
    size_t size = 0;
    double value = 0.0;
    char byte = 0;
    int not_refused = 0;
    discard(NULL);
    CHECK(set_logging(NULL, true, 0, NULL) == ERROR);
    CHECK(begin(NULL, 0.0) == ERROR && end(NULL) == ERROR && step(NULL, 0.0, h) == ERROR);
    CHECK(terminate_run(NULL) == ERROR && reset(NULL) == ERROR);
    for (int type = TYPE_REAL; type <= TYPE_INTEGER; ++type) {
        const uint32_t reference = 0;
        CHECK(get(NULL, (Type)type, &reference, 1, &value) == ERROR);
        CHECK(set(NULL, (Type)type, &reference, 1, &value) == ERROR);
    }
    CHECK(get_state(NULL, &state) == ERROR && set_state(NULL, &value) == ERROR && free_state(NULL, &state) == ERROR);
    CHECK(state_size(NULL, &value, &size) == ERROR && to_bytes(NULL, &value, &byte, 1) == ERROR);
    CHECK(from_bytes(NULL, &byte, 1, &state) == ERROR);
    CHECK(call_unsupported(NULL, &not_refused) > 0 && not_refused == 0);
}

static void wrong_instantiations_are_refused(void)
{
    MessageLog messages = {0};
    CHECK(make("instance", "{another}", true, &messages) == NULL && strstr(messages.last, "got {another}") != NULL);
    CHECK(make("instance", NULL, true, &messages) == NULL && make(NULL, MODEL_TOKEN, true, &messages) == NULL);
    CHECK(make("", MODEL_TOKEN, true, &messages) == NULL && make_of_another_kind(&messages) == NULL);
    CHECK(messages.errors >= 5);
    messages.errors = 0;
    CHECK(make("instance", "{another}", false, &messages) == NULL && messages.errors == 0);
    Fmu fmu = make_without_logger();
    CHECK(fmu != NULL && step(fmu, 0.0, h) == ERROR);
    discard(fmu);
}

static void calls_are_legal_in_their_states_only(void)
{
    typedef Code (*Call)(Fmu);
    const struct {
        Call call;
        bool legal[PHASES];
    } calls[] = {
        {end, {false, true, false, false}},
        {terminate_run, {false, false, true, false}},
        {reset, {true, true, true, true}},
    };
    for (int phase = INSTANTIATED; phase < PHASES; ++phase) {
        MessageLog messages = {0};
        double outputs[OUTPUT_COUNT];
        int not_refused = 0;
        Fmu fmu = make_in(phase, &messages);
        const int count = call_unsupported(fmu, &not_refused);
        CHECK(not_refused == 0 && messages.errors == count);
        CHECK((step(fmu, 0.0, h) == OK) == (phase == STEPPING));
        CHECK(get(fmu, TYPE_REAL, &(uint32_t){FIRST_OUTPUT}, 1, outputs) == OK);
        discard(fmu);
        fmu = make_in(phase, &messages);
        CHECK((begin(fmu, 0.0) == OK) == (phase == INSTANTIATED));
        discard(fmu);
        for (size_t i = 0; i < sizeof calls / sizeof *calls; ++i) {
            fmu = make_in(phase, &messages);
            CHECK((calls[i].call(fmu) == OK) == calls[i].legal[phase]);
            discard(fmu);
        }
    }
}

static bool settable(const Variable *v, int phase)
{
    return phase != TERMINATED && (v->causality == CAUSALITY_INPUT || v->variability == VARIABILITY_TUNABLE ||
                                   (v->variability == VARIABILITY_FIXED && phase != STEPPING));
}

static void every_variable_can_be_read_and_is_guarded(void)
{
    for (int phase = INSTANTIATED; phase < PHASES; ++phase) {
        MessageLog messages = {0};
        Fmu fmu = make_in(phase, &messages);
        for (uint32_t i = 0; i < VARIABLE_COUNT; ++i) {
            const Variable *v = &variables[i];
            const bool parameter = v->causality == CAUSALITY_PARAMETER;
            double before = -1.0, after = -2.0;
            if (v->type == TYPE_TEXT) {
                continue;
            }
            CHECK(get_one(fmu, i, &before) == OK);
            CHECK(v->causality == CAUSALITY_OUTPUT || before == v->start);
            CHECK((set_one(fmu, i, before) == OK) == settable(v, phase));
            if (parameter && isfinite(v->minimum) && v->type != TYPE_BOOLEAN) {
                CHECK(set_one(fmu, i, v->minimum - 1.0) == ERROR);
            }
            if (parameter && isfinite(v->maximum) && v->type != TYPE_BOOLEAN) {
                CHECK(set_one(fmu, i, v->maximum + 1.0) == ERROR);
            }
            if (parameter && v->type == TYPE_REAL) {
                CHECK(set_one(fmu, i, NAN) == ERROR && set_one(fmu, i, INFINITY) == ERROR);
                CHECK(strstr(messages.last, v->name) != NULL || phase == TERMINATED);
            }
            for (int type = TYPE_REAL; type <= TYPE_INTEGER; ++type) {
                CHECK((get(fmu, (Type)type, &i, 1, &after) == OK) == (v->type == (Type)type));
                if (v->type != (Type)type) {
                    CHECK(set(fmu, (Type)type, &i, 1, &after) == ERROR);
                }
            }
            CHECK(get_one(fmu, i, &after) == OK && memcmp(&before, &after, sizeof before) == 0);
        }
        const uint32_t wrong[] = {VARIABLE_COUNT, UINT32_MAX};
        double value = 1.0;
        for (size_t i = 0; i < 2; ++i) {
            CHECK(get(fmu, TYPE_REAL, &wrong[i], 1, &value) == ERROR);
            CHECK(set(fmu, TYPE_REAL, &wrong[i], 1, &value) == ERROR);
        }
        CHECK(get_into_nothing(fmu) == ERROR && set_from_nothing(fmu) == ERROR);
        CHECK(get(fmu, TYPE_REAL, NULL, 0, NULL) == OK);
        discard(fmu);
    }
}

static void texts_are_kept_and_guarded(void)
{
    char longest[MAX_TEXT_SIZE + 2];
    memset(longest, 'x', sizeof longest);
    longest[MAX_TEXT_SIZE + 1] = '\0';
    for (uint32_t i = 0; i < VARIABLE_COUNT; ++i) {
        MessageLog messages = {0};
        const char *text = NULL;
        char start[MAX_TEXT_SIZE + 1];
        void *state = NULL;
        double number;
        if (variables[i].type != TYPE_TEXT) {
            continue;
        }
        Fmu fmu = make_in(INSTANTIATED, &messages);
        CHECK(get_text(fmu, i, &text) == OK && *text != '\0');
        strcpy(start, text);
        CHECK(set_text(fmu, i, longest) == ERROR && strstr(messages.last, variables[i].name) != NULL);
        CHECK(set_text(fmu, i, NULL) == ERROR && get_text(fmu, i, &text) == OK && strcmp(text, start) == 0);
        CHECK(set_text(fmu, i, longest + 1) == OK && get_text(fmu, i, &text) == OK && strcmp(text, longest + 1) == 0);
        CHECK(set_text(fmu, i, "/a b/%n.csv") == OK && get_text(fmu, i, &text) == OK);
        CHECK(strcmp(text, "/a b/%n.csv") == 0);
        for (int type = TYPE_REAL; type <= TYPE_INTEGER; ++type) {
            CHECK(get(fmu, (Type)type, &i, 1, &number) == ERROR && set(fmu, (Type)type, &i, 1, &number) == ERROR);
        }
        CHECK(get_text(fmu, 0, &text) == ERROR && set_text(fmu, 0, "x") == ERROR);
        CHECK(get_text(NULL, i, &text) == ERROR && set_text(NULL, i, "x") == ERROR);
        CHECK(begin(fmu, 0.0) == OK && end(fmu) == OK && set_text(fmu, i, "late") == ERROR);
        CHECK(get_state(fmu, &state) == OK && reset(fmu) == OK);
        CHECK(get_text(fmu, i, &text) == OK && strcmp(text, start) == 0);
        CHECK(set_state(fmu, state) == OK && free_state(fmu, &state) == OK);
        CHECK(get_text(fmu, i, &text) == OK && strcmp(text, "/a b/%n.csv") == 0 && step(fmu, 0.0, h) == OK);
        discard(fmu);
    }
}

static void steps_refuse_what_is_wrong_and_leave_everything(void)
{
    const double times[][2] = {{1.0, h}, {NAN, h}, {0.0, 0.0}, {0.0, -h}, {0.0, NAN}, {0.0, INFINITY}, {0.0, 1e9}};
    MessageLog messages = {0};
    double first[OUTPUT_COUNT], second[OUTPUT_COUNT], time = 0.0;
    Fmu straight = make_in(STEPPING, &messages), fmu = make_in(STEPPING, &messages);
    for (size_t i = 0; i < sizeof times / sizeof *times; ++i) {
        CHECK(step(fmu, times[i][0], times[i][1]) == ERROR);
    }
    for (uint32_t i = FIRST_INPUT; i < FIRST_INPUT + INPUT_COUNT; ++i) {
        CHECK(set_one(fmu, i, i % 2 ? NAN : INFINITY) == OK && step(fmu, 0.0, h) == ERROR);
        CHECK(strstr(messages.last, variables[i].name) != NULL && strstr(messages.last, "t = 0 s") != NULL);
        CHECK(set_one(fmu, i, 0.0) == OK);
    }
    CHECK(drive(straight, 1, 0, first) == OK && drive(fmu, 1, 0, second) == OK && same(first, second));
    CHECK(get_one(fmu, 0, &time) == OK && time == h);
    discard(fmu);
    fmu = make_in(INSTANTIATED, &messages);
    CHECK(begin(fmu, NAN) == ERROR && begin(fmu, 1e300) == ERROR && begin(fmu, -5.0) == OK);
    if (INPUT_COUNT > 0) {
        CHECK(set_one(fmu, FIRST_INPUT, NAN) == OK && get_one(fmu, FIRST_OUTPUT, first) == WARNING &&
              end(fmu) == ERROR);
        CHECK(set_one(fmu, FIRST_INPUT, 0.0) == OK);
    }
    CHECK(end(fmu) == OK && step(fmu, -5.0, h) == OK);
    discard(fmu);
    discard(straight);
}

static void logging_obeys(void)
{
    const char *const warnings[] = {"logStatusWarning"}, *const all[] = {"logAll"}, *const wrong[] = {"gossip", NULL};
    MessageLog messages = {0};
    Fmu fmu = make_in(INSTANTIATED, &messages);
    CHECK(set_logging(fmu, true, 1, warnings) == OK && step(fmu, 0.0, h) == ERROR && messages.errors == 0);
    CHECK(set_logging(fmu, true, 1, all) == OK && step(fmu, 0.0, h) == ERROR && messages.errors == 1);
    CHECK(set_logging(fmu, false, 0, NULL) == OK && step(fmu, 0.0, h) == ERROR && messages.errors == 1);
    CHECK(set_logging(fmu, true, 0, NULL) == OK && step(fmu, 0.0, h) == ERROR && messages.errors == 2);
    CHECK(set_logging(fmu, true, 1, wrong) == ERROR && set_logging(fmu, true, 1, wrong + 1) == ERROR);
    CHECK(set_logging(fmu, true, 1, NULL) == ERROR);
    discard(fmu);
}

static void reset_is_as_good_as_new(void)
{
    MessageLog messages = {0};
    double first[OUTPUT_COUNT], second[OUTPUT_COUNT];
    Fmu fmu = make_in(STEPPING, &messages), fresh = make_in(STEPPING, &messages);
    for (unsigned k = 0; k < 10; ++k) {
        CHECK(drive(fmu, 9, k, first) == OK);
    }
    CHECK(reset(fmu) == OK && begin(fmu, 0.0) == OK && end(fmu) == OK);
    for (unsigned k = 0; k < 10; ++k) {
        CHECK(drive(fmu, 5, k, first) == OK && drive(fresh, 5, k, second) == OK && same(first, second));
    }
    discard(fmu);
    discard(fresh);
}

/* Round trips through memory and bytes, into this instance and another, at times that a seed chooses. */
static void states_continue_bit_identically(unsigned seed)
{
    MessageLog messages = {0};
    double expected[OUTPUT_COUNT], found[OUTPUT_COUNT];
    void *state = NULL;
    size_t size = 0;
    Fmu straight = make_in(STEPPING, &messages), one = make_in(STEPPING, &messages), other = make_in(0, &messages);
    for (unsigned k = 0; k < 200; ++k) {
        const double choice = noise(seed, k);
        if (choice > 0.8) { /* a detour that is undone */
            CHECK(get_state(one, &state) == OK);
            CHECK(drive(one, 77, k, found) == OK && drive(one, 78, k + 1, found) == OK);
            CHECK(set_state(one, state) == OK);
        } else if (choice < -0.8) { /* into the other instance, as bytes */
            void *copy = NULL;
            CHECK(get_state(one, &state) == OK && state_size(one, state, &size) == OK);
            char *bytes = malloc(size);
            CHECK(to_bytes(one, state, bytes, size) == OK && to_bytes(one, state, bytes, size - 1) == ERROR);
            CHECK(from_bytes(other, bytes, size, &copy) == OK && set_state(other, copy) == OK);
            CHECK(free_state(other, &copy) == OK && copy == NULL);
            free(bytes);
            Fmu swap = one;
            one = other, other = swap;
        }
        CHECK(drive(straight, seed, k, expected) == OK && drive(one, seed, k, found) == OK && same(expected, found));
    }
    CHECK(free_state(one, &state) == OK && state == NULL && free_state(one, &state) == OK &&
          free_state(one, NULL) == OK);
    discard(straight);
    discard(one);
    discard(other);
}

static void foreign_bytes_are_refused(void)
{
    MessageLog messages = {0};
    void *state = NULL, *restored = NULL;
    size_t size = 0;
    Fmu fmu = make_in(STEPPING, &messages);
    CHECK(get_state(fmu, NULL) == ERROR && set_state(fmu, NULL) == ERROR && state_size(fmu, NULL, &size) == ERROR);
    CHECK(get_state(fmu, &state) == OK && state_size(fmu, state, NULL) == ERROR && state_size(fmu, state, &size) == OK);
    char *bytes = malloc(size + 1);
    CHECK(to_bytes(fmu, state, NULL, size) == ERROR && to_bytes(fmu, NULL, bytes, size) == ERROR);
    CHECK(to_bytes(fmu, state, bytes, size) == OK && from_bytes(fmu, NULL, size, &restored) == ERROR);
    CHECK(from_bytes(fmu, bytes, size, NULL) == ERROR);
    CHECK(from_bytes(fmu, bytes, size - 1, &restored) == ERROR && from_bytes(fmu, bytes, 0, &restored) == ERROR);
    for (size_t i = 0; i < size; ++i) {
        bytes[i] = (char)(bytes[i] ^ 1);
        const bool padding = i >= 8 + sizeof MODEL_TOKEN && i < 48; /* of the token, looked at by nobody */
        CHECK((from_bytes(fmu, bytes, size, &restored) == OK) == padding);
        bytes[i] = (char)(bytes[i] ^ 1);
    }
    CHECK(from_bytes(fmu, bytes, size, &restored) == OK);
    CHECK(free_state(fmu, &restored) == OK && free_state(fmu, &state) == OK);
    free(bytes);
    discard(fmu);
}

/* ---- threads ----------------------------------------------------------------------------------------------------- */

enum { THREADS = 4, STEPS = 2000 };

static void *run_alone(void *outputs)
{
    MessageLog messages = {0};
    Fmu fmu = make_in(STEPPING, &messages);
    for (unsigned k = 0; k < STEPS; ++k) {
        CHECK(drive(fmu, 3, k, outputs) == OK);
    }
    discard(fmu);
    return NULL;
}

static void threads_do_not_meet(void)
{
    pthread_t threads[THREADS];
    double outputs[THREADS][OUTPUT_COUNT], alone[OUTPUT_COUNT];
    run_alone(alone);
    for (int i = 0; i < THREADS; ++i) {
        CHECK(pthread_create(&threads[i], NULL, run_alone, outputs[i]) == 0);
    }
    for (int i = 0; i < THREADS; ++i) {
        CHECK(pthread_join(threads[i], NULL) == 0 && same(outputs[i], alone));
    }
}

int main(void)
{
    null_instances_are_refused();
    wrong_instantiations_are_refused();
    calls_are_legal_in_their_states_only();
    every_variable_can_be_read_and_is_guarded();
    texts_are_kept_and_guarded();
    steps_refuse_what_is_wrong_and_leave_everything();
    logging_obeys();
    reset_is_as_good_as_new();
    for (unsigned seed = 1; seed <= 5; ++seed) {
        states_continue_bit_identically(seed);
    }
    foreign_bytes_are_refused();
    threads_do_not_meet();
    CHECK(check_particulars() == 0);
    printf("%d failures\n", failures);
    return failures == 0 ? 0 : 1;
}
