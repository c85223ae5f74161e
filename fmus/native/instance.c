/* Rules of an instance. */
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

/* Pass a message to the host if its category is logged. */
static void log_message(const Instance *instance, Status status, const char *message)
{
    const size_t category = status == STATUS_WARNING ? MODEL_WARNINGS : MODEL_ERRORS;
    if (instance->host.log_message != NULL && instance->host.callback != NULL &&
        (instance->categories & (1u << category)) != 0) {
        instance->host.log_message(instance, status, category_names[category], message);
    }
}

/* Log a message with the name of the called function. */
static void log_arguments(const Instance *instance, Status status, const char *function, const char *format,
                          va_list arguments)
{
    char message[MESSAGE_SIZE];
    const int length = snprintf(message, sizeof message, "%s: ", function);
    vsnprintf(message + length, sizeof message - (size_t)length, format, arguments);
    log_message(instance, status, message);
}

/* Log a message with a status and return this status. */
static Status log_status(const Instance *instance, Status status, const char *function, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    log_arguments(instance, status, function, format, arguments);
    va_end(arguments);
    return status;
}

Status instance_fail(const Instance *instance, const char *function, const char *format, ...)
{
    if (instance != NULL) {
        va_list arguments;
        va_start(arguments, format);
        log_arguments(instance, STATUS_ERROR, function, format, arguments);
        va_end(arguments);
    }
    return STATUS_ERROR;
}

Status instance_unsupported(const Instance *instance, const char *function, const char *reason)
{
    return instance_fail(instance, function, "not supported by this FMU: %s", reason);
}

static bool is_name_character(char c)
{
    return isalnum((unsigned char)c) || c == '_';
}

/* Whether a text mentions the name of a variable, as a whole word. */
static bool mentions(const char *text, const char *name)
{
    const size_t length = strlen(name);
    for (const char *at = strstr(text, name); at != NULL; at = strstr(at + 1, name)) {
        const bool begins = at == text || !(is_name_character(at[-1]) || at[-1] == '.');
        const bool ends = !(is_name_character(at[length]) || (at[length] == '.' && is_name_character(at[length + 1])));
        if (begins && ends) {
            return true;
        }
    }
    return false;
}

/* Append to a message of the model the values of all variables that it mentions, unless it contains values already. */
static void describe_parameters(const Instance *instance, const char *text, char message[MESSAGE_SIZE])
{
    const char *separator = "; got ";
    int length = snprintf(message, MESSAGE_SIZE, "%s", text);
    const size_t count = strstr(text, ", got ") == NULL ? VARIABLE_COUNT : 0;
    for (size_t i = 0; i < count && length > 0 && length < MESSAGE_SIZE; ++i) {
        if (mentions(text, variables[i].name)) {
            length +=
                snprintf(message + length, (size_t)(MESSAGE_SIZE - length), "%s%s = %.10g%s%s", separator,
                         variables[i].name, instance->values[i], *variables[i].unit ? " " : "", variables[i].unit);
            separator = ", ";
        }
    }
}

Status instance_set_logging(Instance *instance, const char *function, bool on, size_t count, const char *const names[])
{
    unsigned chosen = 0;
    if (instance == NULL || (count > 0 && names == NULL)) {
        return instance_fail(instance, function, "expected names of categories, got none");
    }
    for (size_t i = 0; i < count; ++i) {
        size_t category = 0;
        while (category < CATEGORY_COUNT && (names[i] == NULL || strcmp(names[i], category_names[category]) != 0)) {
            ++category;
        }
        if (category == CATEGORY_COUNT) {
            return instance_fail(instance, function, "expected a category of this FMU, got %s",
                                 names[i] == NULL ? "a null pointer" : names[i]);
        }
        chosen |= category == MODEL_ALL_MESSAGES ? ALL_CATEGORIES : 1u << category;
    }
    chosen = count > 0 ? chosen : ALL_CATEGORIES;
    instance->categories = on ? chosen : instance->categories & ~chosen;
    return STATUS_OK;
}

/* ---- legal calls ------------------------------------------------------------------------------------------------- */

typedef enum { CALL_SET_UP, CALL_ENTER, CALL_EXIT, CALL_STEP, CALL_TERMINATE, CALL_SET, CALL_COUNT } Call;

static const bool legal_calls[CALL_COUNT][PHASE_COUNT] = {
    /*                 instantiated, initializing, stepping, terminated */
    [CALL_SET_UP] = {true, false, false, false},    [CALL_ENTER] = {true, false, false, false},
    [CALL_EXIT] = {false, true, false, false},      [CALL_STEP] = {false, false, true, false},
    [CALL_TERMINATE] = {false, false, true, false}, [CALL_SET] = {true, true, true, false},
}; /* all other calls are always legal */

static const char *const phase_names[PHASE_COUNT] = {"instantiated", "initializing", "stepping", "terminated"};

static Status check_call(const Instance *instance, const char *function, Call call)
{
    if (instance == NULL) {
        return STATUS_ERROR;
    }
    if (!legal_calls[call][instance->phase]) {
        return instance_fail(instance, function, "expected this call in another state, got one while %s",
                             phase_names[instance->phase]);
    }
    return STATUS_OK;
}

/* ---- life cycle -------------------------------------------------------------------------------------------------- */

/* Set all variables to their start values and return to the first phase. */
static void reset_instance(Instance *instance)
{
    static const char *const texts[] = {MODEL_TEXTS};
    memset(instance->texts, 0, sizeof instance->texts);
    for (size_t i = TEXT_COUNT; i-- > 0;) {
        snprintf(instance->texts + i * TEXT_SIZE, TEXT_SIZE, "%s", texts[i]);
    }
    for (size_t i = 0; i < VARIABLE_COUNT; ++i) {
        instance->values[i] = variables[i].start;
    }
    instance->stop_time = INFINITY;
    instance->phase = PHASE_INSTANTIATED;
    instance->prepared = instance->examined = instance->warned = false;
    instance->outputs_due = true;
}

Instance *instance_new(const char *name, const char *token, const char *resources, bool logging, Host host,
                       const char *function)
{
    Instance *instance = calloc(1, sizeof *instance);
    if (instance == NULL) {
        return NULL;
    }
    instance->host = host;
    instance->categories = logging ? ALL_CATEGORIES : 0;
    snprintf(instance->name, sizeof instance->name, "%s", name == NULL ? "" : name);
    path_of_resources(resources, instance->resources, sizeof instance->resources);
    reset_instance(instance);
    if (*instance->name == '\0') {
        instance_fail(instance, function, "expected a name of the instance, got none");
    } else if (token == NULL || strcmp(token, MODEL_TOKEN) != 0) {
        instance_fail(instance, function, "expected the GUID or token %s of this " MODEL_NAME ", got %s", MODEL_TOKEN,
                      token == NULL ? "none" : token);
    } else {
        return instance;
    }
    free(instance);
    return NULL;
}

void instance_free(Instance *instance)
{
    if (instance != NULL) {
        model_release(&instance->coefficients);
    }
    free(instance);
}

Status instance_set_up(Instance *instance, const char *function, double start_time, double stop_time)
{
    if (check_call(instance, function, CALL_SET_UP) != STATUS_OK) {
        return STATUS_ERROR;
    }
    if (!(fabs(start_time) <= MAX_TIME)) {
        return instance_fail(instance, function, "start time: expected at most %.10g s either way, got %.10g s",
                             MAX_TIME, start_time);
    }
    instance->values[0] = start_time;
    instance->stop_time = isnan(stop_time) ? INFINITY : stop_time;
    instance->outputs_due = true;
    return STATUS_OK;
}

Status instance_enter_initialization(Instance *instance, const char *function)
{
    const Status status = check_call(instance, function, CALL_ENTER);
    if (status == STATUS_OK) {
        instance->phase = PHASE_INITIALIZING;
    }
    return status;
}

/* The present paths of files, from the folder of the resources. */
typedef char Paths[TEXT_COUNT + 1][2 * TEXT_SIZE];

static ModelParameters present_parameters(const Instance *instance, Paths paths)
{
    const char *texts[TEXT_COUNT + 1] = {NULL};
    for (size_t i = TEXT_COUNT; i-- > 0;) {
        path_in_folder(instance->resources, instance->texts + i * TEXT_SIZE, paths[i], sizeof paths[i]);
        texts[i] = paths[i];
    }
    return model_parameters(instance->values, texts);
}

/* Derive the coefficients of the present parameters, if they changed; returns `failure` if these contradict one
 * another. */
static Status prepare(Instance *instance, const char *function, Status failure)
{
    char message[MESSAGE_SIZE];
    if (instance->prepared) {
        return STATUS_OK;
    }
    Paths paths;
    const ModelParameters parameters = present_parameters(instance, paths);
    ModelCoefficients coefficients;
    const char *problem = model_prepare(&parameters, &coefficients);
    if (problem != NULL) {
        describe_parameters(instance, problem, message);
        return log_status(instance, failure, function, "%s", message);
    }
    model_release(&instance->coefficients);
    instance->coefficients = coefficients;
    instance->prepared = true;
    return STATUS_OK;
}

/* Log a warning about the present parameters, if there is one and it is new. Called where a call has succeeded: a call
 * that is refused leaves no trace. */
static void examine_parameters(Instance *instance)
{
    char message[MESSAGE_SIZE];
    if (instance->examined) {
        return;
    }
    Paths paths;
    const ModelParameters parameters = present_parameters(instance, paths);
    const char *warning = model_warning(&parameters);
    if (warning != NULL && !instance->warned) {
        describe_parameters(instance, warning, message);
        log_message(instance, STATUS_WARNING, message);
    }
    instance->warned = warning != NULL;
    instance->examined = true;
}

/* Check that values are finite; returns `failure` otherwise. */
static Status check_finite(const Instance *instance, const char *function, Status failure, const double values[],
                           size_t first, size_t count)
{
    for (size_t i = first; i < first + count; ++i) {
        if (!isfinite(values[i])) {
            return log_status(instance, failure, function, "%s: expected a finite number, got %g at t = %.10g s",
                              variables[i].name, values[i], instance->values[0]);
        }
    }
    return STATUS_OK;
}

/* Check that the inputs are finite. */
static Status check_inputs(const Instance *instance, const char *function, Status failure)
{
    if (check_finite(instance, function, failure, instance->values, FIRST_INPUT, INPUT_COUNT) != STATUS_OK ||
        check_finite(instance, function, failure, instance->values, FIRST_ADDED_INPUT, ADDED_INPUT_COUNT) !=
            STATUS_OK) {
        return failure;
    }
    return STATUS_OK;
}

/* Check that the outputs in a table of values are finite. */
static Status check_outputs(const Instance *instance, const char *function, Status failure, const double values[])
{
    if (check_finite(instance, function, failure, values, FIRST_OUTPUT, OUTPUT_COUNT) != STATUS_OK ||
        check_finite(instance, function, failure, values, FIRST_ADDED_OUTPUT, ADDED_OUTPUT_COUNT) != STATUS_OK) {
        return failure;
    }
    return STATUS_OK;
}

/* Take over the outputs in a table of values. */
static void take_outputs(Instance *instance, const double values[])
{
    memcpy(instance->values + FIRST_OUTPUT, values + FIRST_OUTPUT, OUTPUT_COUNT * sizeof *values);
    memcpy(instance->values + FIRST_ADDED_OUTPUT, values + FIRST_ADDED_OUTPUT, ADDED_OUTPUT_COUNT * sizeof *values);
}

/* Compute state and outputs at the start from the present inputs and parameters. Where this is impossible, returns
 * `failure` and changes nothing. */
static Status initialize(Instance *instance, const char *function, Status failure)
{
    if (check_inputs(instance, function, failure) != STATUS_OK || prepare(instance, function, failure) != STATUS_OK) {
        return failure;
    }
    const ModelInputs inputs = model_inputs(instance->values);
    ModelState state = {0};
    ModelOutputs outputs;
    double values[VARIABLE_COUNT];
    model_initialize(&state, &inputs, &instance->coefficients, instance->values[0], &outputs);
    model_store_outputs(&outputs, values);
    if (check_outputs(instance, function, failure, values) != STATUS_OK) {
        return failure;
    }
    memcpy(&instance->state, &state, sizeof state);
    take_outputs(instance, values);
    instance->outputs_due = false;
    examine_parameters(instance);
    return STATUS_OK;
}

Status instance_exit_initialization(Instance *instance, const char *function)
{
    if (check_call(instance, function, CALL_EXIT) != STATUS_OK ||
        initialize(instance, function, STATUS_ERROR) != STATUS_OK) {
        return STATUS_ERROR;
    }
    instance->phase = PHASE_STEPPING;
    return STATUS_OK;
}

/* Check time, step size and inputs of a step. */
static Status check_step(Instance *instance, const char *function, double time, double step_size)
{
    const double reached = instance->values[0];
    if (!(fabs(time - reached) <= TIME_TOLERANCE * fmax(1.0, fabs(reached)))) {
        return instance_fail(instance, function, "expected the time %.10g s, got %.10g s", reached, time);
    }
    if (!(step_size > 0.0 && step_size <= MAX_STEP_SIZE)) {
        return instance_fail(instance, function,
                             "expected a step size above 0 and up to %.10g s, got %.10g s at t = %.10g s",
                             MAX_STEP_SIZE, step_size, time);
    }
    if (time + step_size > instance->stop_time + TIME_TOLERANCE * fmax(1.0, fabs(instance->stop_time))) {
        return instance_fail(instance, function, "expected a step to the stop time %.10g s at most, got one to %.10g s",
                             instance->stop_time, time + step_size);
    }
    if (!(fabs(time + step_size) <= MAX_TIME)) {
        return instance_fail(instance, function,
                             "expected a step that ends within %.10g s either way, got %.10g s at t = %.10g s",
                             MAX_TIME, step_size, time);
    }
    return check_inputs(instance, function, STATUS_ERROR);
}

Status instance_step(Instance *instance, const char *function, double time, double step_size)
{
    if (check_call(instance, function, CALL_STEP) != STATUS_OK ||
        check_step(instance, function, time, step_size) != STATUS_OK ||
        prepare(instance, function, STATUS_ERROR) != STATUS_OK) {
        return STATUS_ERROR;
    }
    const ModelInputs inputs = model_inputs(instance->values);
    const size_t tail = model_tail_length(&instance->state);
    ModelState before; /* restored if the step fails */
    ModelOutputs outputs;
    double values[VARIABLE_COUNT];
    model_copy(&before, &instance->state, tail);
    model_advance(&instance->state, &inputs, &instance->coefficients, time, step_size, &outputs);
    model_store_outputs(&outputs, values);
    if (check_outputs(instance, function, STATUS_ERROR, values) != STATUS_OK) {
        memset(&instance->state, 0, sizeof instance->state);
        model_copy(&instance->state, &before, tail);
        return STATUS_ERROR;
    }
    take_outputs(instance, values);
    instance->values[0] = time + step_size;
    examine_parameters(instance);
    return STATUS_OK;
}

Status instance_terminate(Instance *instance, const char *function)
{
    const Status status = check_call(instance, function, CALL_TERMINATE);
    if (status == STATUS_OK) {
        instance->phase = PHASE_TERMINATED;
    }
    return status;
}

Status instance_reset(Instance *instance, const char *function)
{
    (void)function;
    if (instance == NULL) {
        return STATUS_ERROR;
    }
    reset_instance(instance);
    return STATUS_OK;
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

static const char *const type_names[] = {"number", "Boolean", "integer", "text"};

/* Check that value references exist and have a type. */
static Status check_references(const Instance *instance, const char *function, Type type, const uint32_t references[],
                               size_t count, const void *values)
{
    if (instance == NULL) {
        return STATUS_ERROR;
    }
    if (count > 0 && (references == NULL || values == NULL)) {
        return instance_fail(instance, function,
                             "expected arrays of %zu value references and values, got a null pointer", count);
    }
    for (size_t i = 0; i < count; ++i) {
        if (references[i] >= VARIABLE_COUNT) {
            return instance_fail(instance, function, "expected a value reference below %d, got %lu",
                                 (int)VARIABLE_COUNT, (unsigned long)references[i]);
        }
        if (variables[references[i]].type != type) {
            return instance_fail(instance, function, "%s: expected the access of a %s, got that of a %s",
                                 variables[references[i]].name, type_names[variables[references[i]].type],
                                 type_names[type]);
        }
    }
    return STATUS_OK;
}

Status instance_prepare_read(Instance *instance, const char *function, Type type, const uint32_t references[],
                             size_t count, const void *values)
{
    if (check_references(instance, function, type, references, count, values) != STATUS_OK) {
        return STATUS_ERROR;
    }
    if (instance->outputs_due && (instance->phase == PHASE_INSTANTIATED || instance->phase == PHASE_INITIALIZING)) {
        for (size_t i = 0; i < count; ++i) {
            if (variables[references[i]].causality == CAUSALITY_OUTPUT) {
                /* contradicting values may be corrected before the initialisation ends */
                return initialize(instance, function, STATUS_WARNING);
            }
        }
    }
    return STATUS_OK;
}

Status instance_check_write(const Instance *instance, const char *function, Type type, const uint32_t references[],
                            size_t count, const void *values)
{
    return check_call(instance, function, CALL_SET) != STATUS_OK
               ? STATUS_ERROR
               : check_references(instance, function, type, references, count, values);
}

static const char *const causality_names[] = {"independent", "input", "output", "parameter", "local"};
static const char *const variability_names[] = {"constant", "fixed", "tunable", "discrete", "continuous"};

/* Whether a variable may be set in the present phase. */
static bool is_settable(const Instance *instance, const Variable *variable)
{
    return variable->causality == CAUSALITY_INPUT || variable->variability == VARIABILITY_TUNABLE ||
           (variable->variability == VARIABILITY_FIXED && instance->phase != PHASE_STEPPING);
}

/* Whether a value is legal for a variable. An input accepts any value: it is checked in the step. */
static bool is_legal(const Variable *variable, double value)
{
    if (variable->causality == CAUSALITY_INPUT) {
        return true;
    }
    return isfinite(value) && value >= variable->minimum && value <= variable->maximum;
}

/* Mark what depends on a variable as out of date. */
static Status mark_changed(Instance *instance, const Variable *variable)
{
    instance->outputs_due = true;
    if (variable->causality == CAUSALITY_PARAMETER) {
        instance->prepared = instance->examined = false;
    }
    return STATUS_OK;
}

Status instance_write(Instance *instance, const char *function, uint32_t reference, double value)
{
    const Variable *variable = &variables[reference];
    if (!is_settable(instance, variable)) {
        return instance_fail(instance, function, "%s: a %s %s may not be set while %s, got %.10g", variable->name,
                             variability_names[variable->variability], causality_names[variable->causality],
                             phase_names[instance->phase], value);
    }
    if (!is_legal(variable, value)) {
        return instance_fail(instance, function, "%s: expected a value in [%.10g, %.10g]%s%s, got %.10g",
                             variable->name, variable->minimum, variable->maximum, *variable->unit ? " " : "",
                             variable->unit, value);
    }
    instance->values[reference] = value;
    return mark_changed(instance, variable);
}

/* Return the offset of a text in the array of all texts. */
static size_t text_offset(uint32_t reference)
{
    size_t before = 0;
    for (uint32_t i = 0; i < reference; ++i) {
        before += variables[i].type == TYPE_TEXT;
    }
    return before * TEXT_SIZE;
}

const char *instance_text(const Instance *instance, uint32_t reference)
{
    return instance->texts + text_offset(reference);
}

Status instance_write_text(Instance *instance, const char *function, uint32_t reference, const char *text)
{
    const Variable *variable = &variables[reference];
    if (!is_settable(instance, variable)) {
        return instance_fail(instance, function, "%s: a %s %s may not be set while %s, got %.100s", variable->name,
                             variability_names[variable->variability], causality_names[variable->causality],
                             phase_names[instance->phase], text == NULL ? "a null pointer" : text);
    }
    if (text == NULL || strlen(text) > MAX_TEXT_SIZE) {
        return instance_fail(instance, function, "%s: expected a text of at most %d bytes, got %s", variable->name,
                             (int)MAX_TEXT_SIZE, text == NULL ? "a null pointer" : "more");
    }
    char *stored = instance->texts + text_offset(reference);
    memset(stored, 0, TEXT_SIZE);
    memcpy(stored, text, strlen(text));
    return mark_changed(instance, variable);
}

Status instance_refuse_type(const Instance *instance, const char *function, const char *type, size_t count)
{
    if (instance == NULL) {
        return STATUS_ERROR;
    }
    return count == 0 ? STATUS_OK
                      : instance_fail(instance, function, "expected the type of a variable of this FMU, got %s", type);
}

/* ---- states ------------------------------------------------------------------------------------------------------ */

enum { FLAG_PHASE, FLAG_OUTPUTS_DUE, FLAG_WARNED, FLAG_COUNT };
enum {
    STOP_TIME_AT = FLAG_COUNT,
    VALUES_AT,
    STATE_AT = VALUES_AT + VARIABLE_COUNT,
    CONTENT_COUNT = STATE_AT + STATE_COUNT
};

/* A saved instance, in memory and as bytes. The coefficients are not saved: they follow from the parameters. */
typedef struct {
    char magic[8];
    char token[40];
    uint64_t size;
    uint64_t checksum;
    double content[CONTENT_COUNT];
    char texts[TEXTS_SIZE];
} Snapshot;

static const char magic[8] = {'F', 'M', 'U', 's', 't', 'a', 't', 'e'};

/* Return the FNV-1a hash of content and texts. */
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

/* Save an instance. */
static void save_snapshot(const Instance *instance, Snapshot *snapshot)
{
    memset(snapshot, 0, sizeof *snapshot);
    memcpy(snapshot->magic, magic, sizeof magic);
    memcpy(snapshot->token, MODEL_TOKEN, sizeof MODEL_TOKEN);
    snapshot->size = sizeof *snapshot;
    snapshot->content[FLAG_PHASE] = (double)instance->phase;
    snapshot->content[FLAG_OUTPUTS_DUE] = (double)instance->outputs_due;
    snapshot->content[FLAG_WARNED] = (double)instance->warned;
    snapshot->content[STOP_TIME_AT] = instance->stop_time;
    memcpy(snapshot->content + VALUES_AT, instance->values, sizeof instance->values);
    model_pack(&instance->state, snapshot->content + STATE_AT);
    memcpy(snapshot->texts, instance->texts, sizeof instance->texts);
    snapshot->checksum = checksum(snapshot);
}

static bool is_whole(double number)
{
    return number == floor(number);
}

/* Whether a saved value is possible for a variable. */
static bool is_value(const Variable *variable, double value)
{
    switch (variable->causality) {
    case CAUSALITY_INDEPENDENT:
        return fabs(value) <= MAX_TIME;
    case CAUSALITY_LOCAL:
        return value == variable->start;
    default:
        return is_legal(variable, value) && (variable->type == TYPE_REAL || is_whole(value));
    }
}

/* Whether an instance can reach a saved state. The checksum detects damage, not intent, so all values are checked. */
static bool is_reachable(const Snapshot *snapshot)
{
    const double *flags = snapshot->content, *values = flags + VALUES_AT, *packed = flags + STATE_AT;
    const double phase = flags[FLAG_PHASE];
    const char *texts[TEXT_COUNT + 1] = {NULL};
    bool valid = !isnan(flags[STOP_TIME_AT]) && phase >= 0.0 && phase < (double)PHASE_COUNT && is_whole(phase);
    for (size_t i = FLAG_PHASE + 1; i < FLAG_COUNT; ++i) {
        valid = valid && (flags[i] == 0.0 || flags[i] == 1.0);
    }
    for (size_t i = 0; i < VARIABLE_COUNT; ++i) {
        valid = valid && is_value(&variables[i], values[i]);
    }
    for (size_t i = 0; i < STATE_COUNT; ++i) {
        valid = valid && isfinite(packed[i]);
    }
    for (size_t i = TEXT_COUNT; i-- > 0;) {
        texts[i] = snapshot->texts + i * TEXT_SIZE;
        valid = valid && memchr(texts[i], '\0', TEXT_SIZE) != NULL;
    }
    if (valid && phase == (double)PHASE_STEPPING) {
        const ModelParameters parameters = model_parameters(values, texts);
        ModelState state = {0};
        model_unpack(&state, packed);
        valid = model_is_valid_state(&state, &parameters, values[0]);
    }
    return valid;
}

/* Return what is wrong with the bytes of a snapshot, or NULL. */
static const char *snapshot_error(const Snapshot *snapshot, size_t size)
{
    if (memcmp(snapshot->magic, magic, sizeof magic) != 0 ||
        memcmp(snapshot->token, MODEL_TOKEN, sizeof MODEL_TOKEN) != 0) {
        return "bytes of another origin";
    }
    if (snapshot->size != size || snapshot->checksum != checksum(snapshot)) {
        return "damaged bytes";
    }
    return is_reachable(snapshot) ? NULL : "numbers or texts that no instance can have";
}

Status instance_get_state(const Instance *instance, const char *function, void **state)
{
    if (instance == NULL || state == NULL) {
        return instance_fail(instance, function, "expected a pointer for a state, got a null pointer");
    }
    if (*state == NULL) {
        *state = malloc(sizeof(Snapshot));
    }
    if (*state == NULL) {
        return instance_fail(instance, function, "expected memory for a state, got none");
    }
    save_snapshot(instance, *state);
    return STATUS_OK;
}

/* Whether an instance and a snapshot have the same parameters. */
static bool has_parameters(const Instance *instance, const Snapshot *snapshot)
{
    bool same = memcmp(instance->texts, snapshot->texts, sizeof instance->texts) == 0;
    for (size_t i = 0; i < VARIABLE_COUNT; ++i) {
        same =
            same && (variables[i].causality != CAUSALITY_PARAMETER ||
                     memcmp(&instance->values[i], &snapshot->content[VALUES_AT + i], sizeof instance->values[i]) == 0);
    }
    return same;
}

/* Restore an instance, except its coefficients. */
static void load_snapshot(Instance *instance, const Snapshot *snapshot)
{
    instance->phase = (Phase)(int)snapshot->content[FLAG_PHASE];
    instance->outputs_due = snapshot->content[FLAG_OUTPUTS_DUE] > 0.0;
    instance->warned = snapshot->content[FLAG_WARNED] > 0.0;
    instance->examined = false;
    instance->stop_time = snapshot->content[STOP_TIME_AT];
    memcpy(instance->values, snapshot->content + VALUES_AT, sizeof instance->values);
    memcpy(instance->texts, snapshot->texts, sizeof instance->texts);
    model_unpack(&instance->state, snapshot->content + STATE_AT);
}

Status instance_set_state(Instance *instance, const char *function, const void *state)
{
    const Snapshot *snapshot = state;
    if (instance == NULL || snapshot == NULL) {
        return instance_fail(instance, function, "expected a state, got a null pointer");
    }
    const bool prepared = instance->prepared;
    instance->prepared = prepared && has_parameters(instance, snapshot);
    if (instance->prepared || snapshot->content[FLAG_PHASE] != (double)PHASE_STEPPING) {
        load_snapshot(instance, snapshot);
        return STATUS_OK;
    }
    Snapshot before; /* restored if the saved parameters cannot be prepared any more: a file may be missing */
    save_snapshot(instance, &before);
    load_snapshot(instance, snapshot);
    const Status status = prepare(instance, function, STATUS_ERROR); /* here, so that a later step cannot fail */
    if (status != STATUS_OK) {
        load_snapshot(instance, &before);
        instance->prepared = prepared;
    }
    return status;
}

Status instance_free_state(const Instance *instance, const char *function, void **state)
{
    (void)function;
    if (instance == NULL) {
        return STATUS_ERROR;
    }
    if (state != NULL) {
        free(*state);
        *state = NULL;
    }
    return STATUS_OK;
}

Status instance_state_size(const Instance *instance, const char *function, const void *state, size_t *size)
{
    if (instance == NULL || state == NULL || size == NULL) {
        return instance_fail(instance, function, "expected a state and a pointer for its size, got a null pointer");
    }
    *size = sizeof(Snapshot);
    return STATUS_OK;
}

Status instance_state_to_bytes(const Instance *instance, const char *function, const void *state, void *bytes,
                               size_t size)
{
    if (instance == NULL || state == NULL || bytes == NULL) {
        return instance_fail(instance, function, "expected a state and a buffer for its bytes, got a null pointer");
    }
    if (size < sizeof(Snapshot)) {
        return instance_fail(instance, function, "expected room for %zu bytes, got %zu", sizeof(Snapshot), size);
    }
    memcpy(bytes, state, sizeof(Snapshot));
    return STATUS_OK;
}

Status instance_state_from_bytes(const Instance *instance, const char *function, const void *bytes, size_t size,
                                 void **state)
{
    Snapshot snapshot;
    if (instance == NULL || bytes == NULL || state == NULL) {
        return instance_fail(instance, function, "expected bytes and a pointer for their state, got a null pointer");
    }
    if (size != sizeof snapshot) {
        return instance_fail(instance, function, "expected a state of %zu bytes of " MODEL_NAME ", got %zu bytes",
                             sizeof snapshot, size);
    }
    memcpy(&snapshot, bytes, sizeof snapshot);
    const char *problem = snapshot_error(&snapshot, size);
    if (problem != NULL) {
        return instance_fail(instance, function, "expected a state of " MODEL_NAME " " MODEL_TOKEN ", got %s", problem);
    }
    if (*state == NULL) {
        *state = malloc(sizeof snapshot);
    }
    if (*state == NULL) {
        return instance_fail(instance, function, "expected memory for a state, got none");
    }
    memcpy(*state, &snapshot, sizeof snapshot);
    return STATUS_OK;
}
