/* Rules of an instance, see instance.h. */
#include "instance.h"

#include "paths.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const Variable variables[VARIABLE_COUNT] = {MODEL_VARIABLES};

enum { MESSAGE_SIZE = 1024 };

/* ---- messages ---------------------------------------------------------------------------------------------------- */

static const char *const category_names[] = {MODEL_LOG_CATEGORIES};

enum { CATEGORY_COUNT = sizeof category_names / sizeof *category_names, ALL_CATEGORIES = (1 << CATEGORY_COUNT) - 1 };

static void say(const Instance *it, Status status, const char *message)
{
    const size_t category = status == STATUS_WARNING ? MODEL_WARNINGS : MODEL_ERRORS;
    if (it->host.messenger != NULL && it->host.callback != NULL && (it->categories & (1u << category)) != 0) {
        it->host.messenger(it, status, category_names[category], message);
    }
}

static void report(const Instance *it, Status status, const char *function, const char *format, va_list arguments)
{
    char message[MESSAGE_SIZE];
    const int length = snprintf(message, sizeof message, "%s: ", function);
    vsnprintf(message + length, sizeof message - (size_t)length, format, arguments);
    say(it, status, message);
}

/* Log a problem as a warning or an error, and return that status. */
static Status complain(const Instance *it, Status status, const char *function, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    report(it, status, function, format, arguments);
    va_end(arguments);
    return status;
}

Status instance_fail(const Instance *it, const char *function, const char *format, ...)
{
    if (it != NULL) {
        va_list arguments;
        va_start(arguments, format);
        report(it, STATUS_ERROR, function, format, arguments);
        va_end(arguments);
    }
    return STATUS_ERROR;
}

Status instance_unsupported(const Instance *it, const char *function, const char *reason)
{
    return instance_fail(it, function, "not supported by this FMU: %s", reason);
}

static bool in_a_name(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

/* Whether a variable is named in a text, as a whole word. */
static bool is_named(const char *name, const char *text)
{
    const size_t length = strlen(name);
    for (const char *at = strstr(text, name); at != NULL; at = strstr(at + 1, name)) {
        const bool begins = at == text || !(in_a_name(at[-1]) || at[-1] == '.');
        const bool ends = !(in_a_name(at[length]) || (at[length] == '.' && in_a_name(at[length + 1])));
        if (begins && ends) {
            return true;
        }
    }
    return false;
}

/* Write what a model says of its parameters, and the values of all that it names. */
static void explain(const Instance *it, const char *text, char message[MESSAGE_SIZE])
{
    const char *joint = "; got ";
    int length = snprintf(message, MESSAGE_SIZE, "%s", text);
    const size_t count = strstr(text, ", got ") == NULL ? VARIABLE_COUNT : 0; /* or it says so itself */
    for (size_t i = 0; i < count && length > 0 && length < MESSAGE_SIZE; ++i) {
        if (is_named(variables[i].name, text)) {
            length += snprintf(message + length, (size_t)(MESSAGE_SIZE - length), "%s%s = %.10g%s%s", joint,
                               variables[i].name, it->values[i], *variables[i].unit ? " " : "", variables[i].unit);
            joint = ", ";
        }
    }
}

Status instance_set_logging(Instance *it, const char *function, bool on, size_t count, const char *const names[])
{
    unsigned chosen = 0;
    if (it == NULL || (count > 0 && names == NULL)) {
        return instance_fail(it, function, "expected names of categories, got none");
    }
    for (size_t i = 0; i < count; ++i) {
        size_t category = 0;
        while (category < CATEGORY_COUNT && (names[i] == NULL || strcmp(names[i], category_names[category]) != 0)) {
            ++category;
        }
        if (category == CATEGORY_COUNT) {
            return instance_fail(it, function, "expected a category of this FMU, got %s",
                                 names[i] == NULL ? "a null pointer" : names[i]);
        }
        chosen |= category == MODEL_ALL_MESSAGES ? ALL_CATEGORIES : 1u << category;
    }
    chosen = count > 0 ? chosen : ALL_CATEGORIES;
    it->categories = on ? chosen : it->categories & ~chosen;
    return STATUS_OK;
}

/* ---- legal calls ------------------------------------------------------------------------------------------------- */

typedef enum { CALL_SET_UP, CALL_ENTER, CALL_EXIT, CALL_STEP, CALL_TERMINATE, CALL_SET, CALL_COUNT } Call;

static const bool legal_calls[CALL_COUNT][PHASE_COUNT] = {
    /*                 instantiated, initialising, stepping, terminated */
    [CALL_SET_UP] =    {true,        false,        false,    false},
    [CALL_ENTER] =     {true,        false,        false,    false},
    [CALL_EXIT] =      {false,       true,         false,    false},
    [CALL_STEP] =      {false,       false,        true,     false},
    [CALL_TERMINATE] = {false,       false,        true,     false},
    [CALL_SET] =       {true,        true,         true,     false},
}; /* everything else is legal always */

static const char *const phase_names[PHASE_COUNT] = {"instantiated", "initializing", "stepping", "terminated"};

static Status check_call(const Instance *it, const char *function, Call call)
{
    if (it == NULL) {
        return STATUS_ERROR;
    }
    if (!legal_calls[call][it->phase]) {
        return instance_fail(it, function, "expected another state of the FMU for this call, got it while %s",
                             phase_names[it->phase]);
    }
    return STATUS_OK;
}

/* ---- life cycle -------------------------------------------------------------------------------------------------- */

static void start_anew(Instance *it)
{
    static const char *const texts[] = {MODEL_TEXTS};
    memset(it->texts, 0, sizeof it->texts);
    for (size_t i = TEXT_COUNT; i-- > 0;) {
        snprintf(it->texts + i * TEXT_SIZE, TEXT_SIZE, "%s", texts[i]);
    }
    for (size_t i = 0; i < VARIABLE_COUNT; ++i) {
        it->values[i] = variables[i].start;
    }
    it->stop_time = INFINITY;
    it->phase = PHASE_INSTANTIATED;
    it->prepared = it->warned = false;
    it->outputs_due = true;
}

Instance *instance_new(const char *name, const char *token, const char *resources, bool logging, Host host,
                       const char *function)
{
    Instance *it = calloc(1, sizeof *it);
    if (it == NULL) {
        return NULL;
    }
    it->host = host;
    it->categories = logging ? ALL_CATEGORIES : 0;
    snprintf(it->name, sizeof it->name, "%s", name == NULL ? "" : name);
    path_of_resources(resources, it->resources, sizeof it->resources);
    start_anew(it);
    if (*it->name == '\0') {
        instance_fail(it, function, "expected a name of the instance, got none");
    } else if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        instance_fail(it, function, "expected the GUID or token %s of this " MODEL_NAME ", got %s", MODEL_TOKEN,
                      token == NULL ? "none" : token);
    } else {
        return it;
    }
    free(it);
    return NULL;
}

void instance_free(Instance *it)
{
    if (it != NULL) {
        model_release(&it->coefficients);
    }
    free(it);
}

Status instance_set_up(Instance *it, const char *function, double start_time, double stop_time)
{
    if (check_call(it, function, CALL_SET_UP) != STATUS_OK) {
        return STATUS_ERROR;
    }
    if (!(fabs(start_time) <= LATEST_TIME)) {
        return instance_fail(it, function, "start time: expected at most %.10g s either way, got %.10g s", LATEST_TIME,
                             start_time);
    }
    it->values[0] = start_time;
    it->stop_time = stop_time;
    it->outputs_due = true;
    return STATUS_OK;
}

Status instance_enter_initialisation(Instance *it, const char *function)
{
    const Status status = check_call(it, function, CALL_ENTER);
    if (status == STATUS_OK) {
        it->phase = PHASE_INITIALISING;
    }
    return status;
}

/* Derive the coefficients of the parameters as they are now; a contradiction between them has the given status. */
static Status prepare(Instance *it, const char *function, Status failure)
{
    char message[MESSAGE_SIZE];
    if (it->prepared) {
        return STATUS_OK;
    }
    char paths[TEXT_COUNT + 1][2 * TEXT_SIZE];
    const char *texts[TEXT_COUNT + 1] = {NULL};
    for (size_t i = TEXT_COUNT; i-- > 0;) {
        path_in_folder(it->resources, it->texts + i * TEXT_SIZE, paths[i], sizeof paths[i]);
        texts[i] = paths[i];
    }
    const ModelParameters parameters = model_parameters(it->values, texts);
    ModelCoefficients coefficients;
    const char *problem = model_prepare(&parameters, &coefficients);
    if (problem != NULL) {
        explain(it, problem, message);
        return complain(it, failure, function, "%s", message);
    }
    model_release(&it->coefficients);
    it->coefficients = coefficients;
    it->prepared = true;
    const char *warning = model_warning(&parameters);
    if (warning != NULL && !it->warned) {
        explain(it, warning, message);
        say(it, STATUS_WARNING, message);
    }
    it->warned = warning != NULL;
    return STATUS_OK;
}

static Status check_finite(const Instance *it, const char *function, Status failure, const double values[],
                           size_t first, size_t count)
{
    for (size_t i = first; i < first + count; ++i) {
        if (!isfinite(values[i])) {
            return complain(it, failure, function, "%s: expected a finite number, got %g at t = %.10g s",
                            variables[i].name, values[i], it->values[0]);
        }
    }
    return STATUS_OK;
}

/* Compute the state and the outputs at the start, from inputs and parameters as they are now; where they do not allow it,
 * return the given status and leave everything as it was. */
static Status initialise(Instance *it, const char *function, Status failure)
{
    if (check_finite(it, function, failure, it->values, FIRST_INPUT, INPUT_COUNT) != STATUS_OK ||
        prepare(it, function, failure) != STATUS_OK) {
        return failure;
    }
    const ModelInputs inputs = model_inputs(it->values);
    ModelState state = {0};
    ModelOutputs outputs;
    double values[VARIABLE_COUNT];
    model_initial(&state, &inputs, &it->coefficients, it->values[0], &outputs);
    model_store_outputs(&outputs, values);
    if (check_finite(it, function, failure, values, FIRST_OUTPUT, OUTPUT_COUNT) != STATUS_OK) {
        return failure;
    }
    memcpy(&it->state, &state, sizeof state);
    memcpy(it->values + FIRST_OUTPUT, values + FIRST_OUTPUT, OUTPUT_COUNT * sizeof *values);
    it->outputs_due = false;
    return STATUS_OK;
}

Status instance_exit_initialisation(Instance *it, const char *function)
{
    if (check_call(it, function, CALL_EXIT) != STATUS_OK || initialise(it, function, STATUS_ERROR) != STATUS_OK) {
        return STATUS_ERROR;
    }
    it->phase = PHASE_STEPPING;
    return STATUS_OK;
}

static Status check_step(Instance *it, const char *function, double time, double step_size)
{
    const double reached = it->values[0];
    if (!(fabs(time - reached) <= SAME_TIME * fmax(1.0, fabs(reached)))) {
        return instance_fail(it, function, "expected the time %.10g s, got %.10g s", reached, time);
    }
    if (!(step_size > 0.0 && step_size <= LONGEST_STEP)) {
        return instance_fail(it, function, "expected a step size above 0 and up to %.10g s, got %.10g s at t = %.10g s",
                             LONGEST_STEP, step_size, time);
    }
    if (time + step_size > it->stop_time + SAME_TIME * fmax(1.0, fabs(it->stop_time))) {
        return instance_fail(it, function, "expected a step to the stop time %.10g s at most, got one to %.10g s",
                             it->stop_time, time + step_size);
    }
    if (!(fabs(time + step_size) <= LATEST_TIME)) {
        return instance_fail(it, function, "expected a step that ends within %.10g s either way, got %.10g s at t = %.10g s",
                             LATEST_TIME, step_size, time);
    }
    return check_finite(it, function, STATUS_ERROR, it->values, FIRST_INPUT, INPUT_COUNT);
}

Status instance_step(Instance *it, const char *function, double time, double step_size)
{
    if (check_call(it, function, CALL_STEP) != STATUS_OK || check_step(it, function, time, step_size) != STATUS_OK ||
        prepare(it, function, STATUS_ERROR) != STATUS_OK) {
        return STATUS_ERROR;
    }
    const ModelInputs inputs = model_inputs(it->values);
    const size_t tail = model_tail(&it->state);
    ModelState before; /* the instance stays as it is unless all goes well */
    ModelOutputs outputs;
    double values[VARIABLE_COUNT];
    model_copy(&before, &it->state, tail);
    model_advance(&it->state, &inputs, &it->coefficients, time, step_size, &outputs);
    model_store_outputs(&outputs, values);
    if (check_finite(it, function, STATUS_ERROR, values, FIRST_OUTPUT, OUTPUT_COUNT) != STATUS_OK) {
        memset(&it->state, 0, sizeof it->state);
        model_copy(&it->state, &before, tail);
        return STATUS_ERROR;
    }
    memcpy(it->values + FIRST_OUTPUT, values + FIRST_OUTPUT, OUTPUT_COUNT * sizeof *values);
    it->values[0] = time + step_size;
    return STATUS_OK;
}

Status instance_terminate(Instance *it, const char *function)
{
    const Status status = check_call(it, function, CALL_TERMINATE);
    if (status == STATUS_OK) {
        it->phase = PHASE_TERMINATED;
    }
    return status;
}

Status instance_reset(Instance *it, const char *function)
{
    (void)function;
    if (it == NULL) {
        return STATUS_ERROR;
    }
    start_anew(it);
    return STATUS_OK;
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

static const char *const type_names[] = {"number", "Boolean", "integer", "text"};

static Status check_references(const Instance *it, const char *function, Type type, const uint32_t references[],
                               size_t count, const void *values)
{
    if (it == NULL) {
        return STATUS_ERROR;
    }
    if (count > 0 && (references == NULL || values == NULL)) {
        return instance_fail(it, function, "expected arrays of %zu value references and values, got a null pointer",
                             count);
    }
    for (size_t i = 0; i < count; ++i) {
        if (references[i] >= VARIABLE_COUNT) {
            return instance_fail(it, function, "expected a value reference below %d, got %lu", (int)VARIABLE_COUNT,
                                 (unsigned long)references[i]);
        }
        if (variables[references[i]].type != type) {
            return instance_fail(it, function, "%s: expected the access of a %s, got that of a %s",
                                 variables[references[i]].name, type_names[variables[references[i]].type],
                                 type_names[type]);
        }
    }
    return STATUS_OK;
}

Status instance_read(Instance *it, const char *function, Type type, const uint32_t references[], size_t count,
                     const void *values)
{
    if (check_references(it, function, type, references, count, values) != STATUS_OK) {
        return STATUS_ERROR;
    }
    if (it->outputs_due && (it->phase == PHASE_INSTANTIATED || it->phase == PHASE_INITIALISING)) {
        for (size_t i = 0; i < count; ++i) {
            if (variables[references[i]].causality == CAUSALITY_OUTPUT) {
                /* values that contradict one another may still be mended before initialisation ends */
                return initialise(it, function, STATUS_WARNING);
            }
        }
    }
    return STATUS_OK;
}

Status instance_may_write(const Instance *it, const char *function, Type type, const uint32_t references[],
                          size_t count, const void *values)
{
    return check_call(it, function, CALL_SET) != STATUS_OK
               ? STATUS_ERROR
               : check_references(it, function, type, references, count, values);
}

static const char *const causality_names[] = {"independent", "input", "output", "parameter", "local"};
static const char *const variability_names[] = {"constant", "fixed", "tunable", "discrete", "continuous"};

static bool may_be_set(const Instance *it, const Variable *variable)
{
    return variable->causality == CAUSALITY_INPUT || variable->variability == VARIABILITY_TUNABLE ||
           (variable->variability == VARIABILITY_FIXED && it->phase != PHASE_STEPPING);
}

/* Whether a value is legal for a variable. An input may be anything: the step looks at it. */
static bool is_legal(const Variable *variable, double value)
{
    if (variable->causality == CAUSALITY_INPUT) {
        return true;
    }
    return isfinite(value) && value >= variable->minimum && value <= variable->maximum;
}

/* Note that a variable was set. */
static Status set_anew(Instance *it, const Variable *variable)
{
    it->outputs_due = true;
    if (variable->causality == CAUSALITY_PARAMETER) {
        it->prepared = false;
    }
    return STATUS_OK;
}

Status instance_write(Instance *it, const char *function, uint32_t reference, double value)
{
    const Variable *variable = &variables[reference];
    if (!may_be_set(it, variable)) {
        return instance_fail(it, function, "%s: a %s %s may not be set while %s, got %.10g", variable->name,
                             variability_names[variable->variability], causality_names[variable->causality],
                             phase_names[it->phase], value);
    }
    if (!is_legal(variable, value)) {
        return instance_fail(it, function, "%s: expected a value in [%.10g, %.10g]%s%s, got %.10g", variable->name,
                             variable->minimum, variable->maximum, *variable->unit ? " " : "", variable->unit, value);
    }
    it->values[reference] = value;
    return set_anew(it, variable);
}

/* Where a text begins among all texts. */
static size_t text_at(uint32_t reference)
{
    size_t before = 0;
    for (uint32_t i = 0; i < reference; ++i) {
        before += variables[i].type == TYPE_TEXT;
    }
    return before * TEXT_SIZE;
}

const char *instance_text(const Instance *it, uint32_t reference)
{
    return it->texts + text_at(reference);
}

Status instance_write_text(Instance *it, const char *function, uint32_t reference, const char *text)
{
    const Variable *variable = &variables[reference];
    if (!may_be_set(it, variable)) {
        return instance_fail(it, function, "%s: a %s %s may not be set while %s, got %.100s", variable->name,
                             variability_names[variable->variability], causality_names[variable->causality],
                             phase_names[it->phase], text == NULL ? "a null pointer" : text);
    }
    if (text == NULL || strlen(text) > LONGEST_TEXT) {
        return instance_fail(it, function, "%s: expected a text of at most %d bytes, got %s", variable->name,
                             (int)LONGEST_TEXT, text == NULL ? "a null pointer" : "more");
    }
    char *place = it->texts + text_at(reference);
    memset(place, 0, TEXT_SIZE);
    memcpy(place, text, strlen(text));
    return set_anew(it, variable);
}

Status instance_no_such_type(const Instance *it, const char *function, const char *type, size_t count)
{
    if (it == NULL) {
        return STATUS_ERROR;
    }
    return count == 0 ? STATUS_OK
                      : instance_fail(it, function, "expected the type of a variable of this FMU, got %s", type);
}

/* ---- states ------------------------------------------------------------------------------------------------------ */

enum { FLAG_PHASE, FLAG_OUTPUTS_DUE, FLAG_WARNED, FLAG_COUNT };
enum { VALUES_AT = FLAG_COUNT, STATE_AT = VALUES_AT + VARIABLE_COUNT, CONTENT_COUNT = STATE_AT + STATE_COUNT };

/* All that an instance is, coefficients aside, which follow from the parameters; the same in memory and as bytes. */
typedef struct {
    char magic[8];
    char token[40];
    uint64_t size;
    uint64_t checksum;
    double content[CONTENT_COUNT];
    char texts[TEXTS_SIZE];
} Snapshot;

static const char magic[8] = {'F', 'M', 'U', 's', 't', 'a', 't', 'e'};

/* FNV-1a over the content and the texts. */
static uint64_t checksum(const Snapshot *snapshot)
{
    unsigned char bytes[sizeof snapshot->content + sizeof snapshot->texts];
    uint64_t sum = 14695981039346656037u;
    memcpy(bytes, snapshot->content, sizeof snapshot->content);
    memcpy(bytes + sizeof snapshot->content, snapshot->texts, sizeof snapshot->texts);
    for (size_t i = 0; i < sizeof bytes; ++i) {
        sum = (sum ^ bytes[i]) * 1099511628211u;
    }
    return sum;
}

static void take(const Instance *it, Snapshot *snapshot)
{
    memset(snapshot, 0, sizeof *snapshot);
    memcpy(snapshot->magic, magic, sizeof magic);
    memcpy(snapshot->token, MODEL_TOKEN, sizeof MODEL_TOKEN);
    snapshot->size = sizeof *snapshot;
    snapshot->content[FLAG_PHASE] = (double)it->phase;
    snapshot->content[FLAG_OUTPUTS_DUE] = (double)it->outputs_due;
    snapshot->content[FLAG_WARNED] = (double)it->warned;
    memcpy(snapshot->content + VALUES_AT, it->values, sizeof it->values);
    model_pack(&it->state, snapshot->content + STATE_AT);
    memcpy(snapshot->texts, it->texts, sizeof it->texts);
    snapshot->checksum = checksum(snapshot);
}

static bool is_whole(double number)
{
    return number == floor(number);
}

/* Whether a value can be that of a variable. */
static bool is_value(const Variable *variable, double value)
{
    switch (variable->causality) {
    case CAUSALITY_INDEPENDENT:
        return fabs(value) <= LATEST_TIME;
    case CAUSALITY_LOCAL:
        return value == variable->start;
    default:
        return is_legal(variable, value) && (variable->type == TYPE_REAL || is_whole(value));
    }
}

/* Whether an instance can have got into this state. A checksum shows damage, not intent: what goes beyond is looked at. */
static bool is_possible(const Snapshot *snapshot)
{
    const double *flags = snapshot->content, *values = flags + VALUES_AT, *packed = flags + STATE_AT;
    const double phase = flags[FLAG_PHASE];
    const char *texts[TEXT_COUNT + 1] = {NULL};
    bool fine = phase >= 0.0 && phase < (double)PHASE_COUNT && is_whole(phase);
    for (size_t i = FLAG_PHASE + 1; i < FLAG_COUNT; ++i) {
        fine = fine && (flags[i] == 0.0 || flags[i] == 1.0);
    }
    for (size_t i = 0; i < VARIABLE_COUNT; ++i) {
        fine = fine && is_value(&variables[i], values[i]);
    }
    for (size_t i = 0; i < STATE_COUNT; ++i) {
        fine = fine && isfinite(packed[i]);
    }
    for (size_t i = TEXT_COUNT; i-- > 0;) {
        texts[i] = snapshot->texts + i * TEXT_SIZE;
        fine = fine && memchr(texts[i], '\0', TEXT_SIZE) != NULL;
    }
    if (fine && phase == (double)PHASE_STEPPING) {
        const ModelParameters parameters = model_parameters(values, texts);
        ModelState state = {0};
        model_unpack(&state, packed);
        fine = model_is_valid_state(&state, &parameters, values[0]);
    }
    return fine;
}

/* What is wrong with bytes that should be a state of this model, or NULL. */
static const char *flaw(const Snapshot *snapshot, size_t size)
{
    if (memcmp(snapshot->magic, magic, sizeof magic) != 0 ||
        memcmp(snapshot->token, MODEL_TOKEN, sizeof MODEL_TOKEN) != 0) {
        return "bytes of another origin";
    }
    if (snapshot->size != size || snapshot->checksum != checksum(snapshot)) {
        return "damaged bytes";
    }
    return is_possible(snapshot) ? NULL : "numbers or texts that no instance can have";
}

Status instance_get_state(const Instance *it, const char *function, void **state)
{
    if (it == NULL || state == NULL) {
        return instance_fail(it, function, "expected where to put a state, got a null pointer");
    }
    if (*state == NULL) {
        *state = malloc(sizeof(Snapshot));
    }
    if (*state == NULL) {
        return instance_fail(it, function, "expected memory for a state, got none");
    }
    take(it, *state);
    return STATUS_OK;
}

/* Whether the parameters of an instance are those of a state. */
static bool has_parameters(const Instance *it, const Snapshot *snapshot)
{
    bool same = memcmp(it->texts, snapshot->texts, sizeof it->texts) == 0;
    for (size_t i = 0; i < VARIABLE_COUNT; ++i) {
        same = same && (variables[i].causality != CAUSALITY_PARAMETER ||
                        memcmp(&it->values[i], &snapshot->content[VALUES_AT + i], sizeof it->values[i]) == 0);
    }
    return same;
}

static void put(Instance *it, const Snapshot *snapshot)
{
    it->phase = (Phase)(int)snapshot->content[FLAG_PHASE];
    it->outputs_due = snapshot->content[FLAG_OUTPUTS_DUE] > 0.0;
    it->warned = snapshot->content[FLAG_WARNED] > 0.0;
    memcpy(it->values, snapshot->content + VALUES_AT, sizeof it->values);
    memcpy(it->texts, snapshot->texts, sizeof it->texts);
    model_unpack(&it->state, snapshot->content + STATE_AT);
}

Status instance_set_state(Instance *it, const char *function, const void *state)
{
    const Snapshot *snapshot = state;
    if (it == NULL || snapshot == NULL) {
        return instance_fail(it, function, "expected a state, got a null pointer");
    }
    const bool prepared = it->prepared;
    it->prepared = prepared && has_parameters(it, snapshot);
    if (it->prepared || snapshot->content[FLAG_PHASE] != (double)PHASE_STEPPING) {
        put(it, snapshot);
        return STATUS_OK;
    }
    Snapshot before; /* the instance stays as it is where the state's parameters no longer work: a file may be gone */
    take(it, &before);
    put(it, snapshot);
    const Status status = prepare(it, function, STATUS_ERROR); /* now, not in a step */
    if (status != STATUS_OK) {
        put(it, &before);
        it->prepared = prepared;
    }
    return status;
}

Status instance_free_state(const Instance *it, const char *function, void **state)
{
    (void)function;
    if (it == NULL) {
        return STATUS_ERROR;
    }
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return STATUS_OK;
}

Status instance_state_size(const Instance *it, const char *function, const void *state, size_t *size)
{
    if (it == NULL || state == NULL || size == NULL) {
        return instance_fail(it, function, "expected a state and where to put its size, got a null pointer");
    }
    *size = sizeof(Snapshot);
    return STATUS_OK;
}

Status instance_state_to_bytes(const Instance *it, const char *function, const void *state, void *bytes, size_t size)
{
    if (it == NULL || state == NULL || bytes == NULL) {
        return instance_fail(it, function, "expected a state and where to put its bytes, got a null pointer");
    }
    if (size < sizeof(Snapshot)) {
        return instance_fail(it, function, "expected room for %zu bytes, got %zu", sizeof(Snapshot), size);
    }
    memcpy(bytes, state, sizeof(Snapshot));
    return STATUS_OK;
}

Status instance_state_from_bytes(const Instance *it, const char *function, const void *bytes, size_t size,
                                 void **state)
{
    Snapshot snapshot;
    if (it == NULL || bytes == NULL || state == NULL) {
        return instance_fail(it, function, "expected bytes and where to put their state, got a null pointer");
    }
    if (size != sizeof snapshot) {
        return instance_fail(it, function, "expected a state of %zu bytes of " MODEL_NAME ", got %zu bytes",
                             sizeof snapshot, size);
    }
    memcpy(&snapshot, bytes, sizeof snapshot);
    const char *problem = flaw(&snapshot, size);
    if (problem != NULL) {
        return instance_fail(it, function, "expected a state of " MODEL_NAME " " MODEL_TOKEN ", got %s", problem);
    }
    if (*state == NULL) {
        *state = malloc(sizeof snapshot);
    }
    if (*state == NULL) {
        return instance_fail(it, function, "expected memory for a state, got none");
    }
    memcpy(*state, &snapshot, sizeof snapshot);
    return STATUS_OK;
}
