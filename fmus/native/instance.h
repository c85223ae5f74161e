/* An instance of the model and the rules that all standards share: legal calls in each state, legal values, the
 * sequence of a step, the content of a saved state. Independent of model and standard. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include "component.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Numbered as in both standards. */
typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR } Status;

enum { TEXT_SIZE = MAX_TEXT_SIZE + 1, TEXTS_SIZE = TEXT_COUNT * TEXT_SIZE + 8 }; /* the latter is never 0 */

typedef enum { PHASE_INSTANTIATED, PHASE_INITIALIZING, PHASE_STEPPING, PHASE_TERMINATED, PHASE_COUNT } Phase;

typedef struct Instance Instance;

/* Passes a message to the callback of the host. */
typedef void (*MessageLogger)(const Instance *instance, Status status, const char *category, const char *message);

/* The callback of the host, of the type that its standard defines. */
typedef void (*HostCallback)(void);

typedef struct {
    MessageLogger log_message;
    HostCallback callback;
    void *environment;
} Host;

struct Instance {
    char name[128]; /* for messages; longer names are cut */
    Host host;
    unsigned categories; /* one bit for each category that is logged */
    Phase phase;
    double values[VARIABLE_COUNT]; /* by value reference; the first is the time that the run has reached, in s */
    double stop_time;              /* limit of steps in s; infinite where the host has given none */
    char texts[TEXTS_SIZE];        /* one after the other, TEXT_SIZE bytes each */
    char resources[TEXT_SIZE];     /* folder of the FMU's resources, empty where the host gives none */
    ModelState state;
    ModelCoefficients coefficients;
    bool prepared;    /* whether the coefficients are those of the present parameters */
    bool outputs_due; /* whether initial outputs must be computed, as a variable was set */
    bool examined;    /* whether the present parameters were examined for a warning */
    bool warned;      /* whether a warning about the parameters examined last was logged */
};

/* In all functions below `function` is the name of the called function of the standard, for messages. Functions that
 * return a status accept a null pointer as the instance and return an error. */

/* Create an instance, or return NULL if name or token is wrong. `resources` is a folder, its URI, or NULL. */
Instance *instance_new(const char *name, const char *token, const char *resources, bool logging, Host host,
                       const char *function);
void instance_free(Instance *instance);

/* Log an error and return its status. The format is that of printf. */
Status instance_fail(const Instance *instance, const char *function, const char *format, ...);
/* Refuse the call of a function that this FMU does not support. */
Status instance_unsupported(const Instance *instance, const char *function, const char *reason);

/* Switch logging on or off for the named categories, or for all if none is named. */
Status instance_set_logging(Instance *instance, const char *function, bool on, size_t count, const char *const names[]);

/* Life cycle; times in s. The stop time is infinite where the host gives none. */
Status instance_set_up(Instance *instance, const char *function, double start_time, double stop_time);
Status instance_enter_initialization(Instance *instance, const char *function);
Status instance_exit_initialization(Instance *instance, const char *function);
Status instance_step(Instance *instance, const char *function, double time, double step_size);
Status instance_terminate(Instance *instance, const char *function);
Status instance_reset(Instance *instance, const char *function);

/* Check that values of a type can be read into an array, and bring the outputs up to date. Before the end of the
 * initialisation this may be impossible: a warning. Unless the status is an error, read `values` then. */
Status instance_prepare_read(Instance *instance, const char *function, Type type, const uint32_t references[],
                             size_t count, const void *values);
/* Check that values of a type can be written from an array; then write one by one. */
Status instance_check_write(const Instance *instance, const char *function, Type type, const uint32_t references[],
                            size_t count, const void *values);
Status instance_write(Instance *instance, const char *function, uint32_t reference, double value);
Status instance_write_text(Instance *instance, const char *function, uint32_t reference, const char *text);
const char *instance_text(const Instance *instance, uint32_t reference);
/* Refuse the access to a type that no variable has, unless there are no references. */
Status instance_refuse_type(const Instance *instance, const char *function, const char *type, size_t count);

/* Complete states: saved into `*state`, which is allocated if NULL, restored, freed, converted to and from bytes. */
Status instance_get_state(const Instance *instance, const char *function, void **state);
Status instance_set_state(Instance *instance, const char *function, const void *state);
Status instance_free_state(const Instance *instance, const char *function, void **state);
Status instance_state_size(const Instance *instance, const char *function, const void *state, size_t *size);
Status instance_state_to_bytes(const Instance *instance, const char *function, const void *state, void *bytes,
                               size_t size);
Status instance_state_from_bytes(const Instance *instance, const char *function, const void *bytes, size_t size,
                                 void **state);

#endif
