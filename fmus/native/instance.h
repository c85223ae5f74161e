/* An instance of the model and its rules, which are the same in all standards: who may call what when, which values are
 * legal, how a step goes, what a saved state is. Knows neither a model nor a standard. */
#ifndef INSTANCE_H
#define INSTANCE_H

#include "component.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* As both standards number them. */
typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR } Status;

enum { TEXT_SIZE = LONGEST_TEXT + 1, TEXTS_SIZE = TEXT_COUNT * TEXT_SIZE + 8 }; /* the latter never 0 */

typedef enum { PHASE_INSTANTIATED, PHASE_INITIALISING, PHASE_STEPPING, PHASE_TERMINATED, PHASE_COUNT } Phase;

typedef struct Instance Instance;

/* Hands a message to the host, in the way of a standard. */
typedef void (*Messenger)(const Instance *it, Status status, const char *category, const char *message);

/* The host's own callback, of the type its standard gives it. */
typedef void (*HostCallback)(void);

/* What to tell the host and how. */
typedef struct {
    Messenger messenger;
    HostCallback callback;
    void *environment;
} Host;

struct Instance {
    char name[128]; /* longer names are cut, in messages only */
    Host host;
    unsigned categories; /* bit of each category that is logged */
    Phase phase;
    double values[VARIABLE_COUNT]; /* by value reference; the first is the time reached, in s */
    double stop_time;              /* past which no step may go, in s; the host's, so no part of a state */
    char texts[TEXTS_SIZE];        /* one after the other, each in as much room */
    char resources[TEXT_SIZE];     /* folder of the FMU's resources, empty where the host has told none */
    ModelState state;
    ModelCoefficients coefficients;
    bool prepared;    /* whether the coefficients are those of the parameters */
    bool outputs_due; /* whether the initial outputs are to be computed, as something was set */
    bool warned;      /* whether the parameters as they are were warned of */
};

/* In all that follows `function` is the standard's name of the function that was called, for messages. Functions that
 * return a status check that there is an instance. */

/* Make an instance, or return NULL where name or token is wrong. The resources are a folder or its URI, or NULL. */
Instance *instance_new(const char *name, const char *token, const char *resources, bool logging, Host host,
                       const char *function);
void instance_free(Instance *it);

/* Log an error and return its status. The format is printf's. */
Status instance_fail(const Instance *it, const char *function, const char *format, ...);
/* Refuse a function that this FMU has no use for, for a reason. */
Status instance_unsupported(const Instance *it, const char *function, const char *reason);

/* Switch logging, of some categories or, where none is named, of all. */
Status instance_set_logging(Instance *it, const char *function, bool on, size_t count, const char *const names[]);

/* The life cycle; times in s. */
/* The stop time is infinite where the host has none. */
Status instance_set_up(Instance *it, const char *function, double start_time, double stop_time);
Status instance_enter_initialisation(Instance *it, const char *function);
Status instance_exit_initialisation(Instance *it, const char *function);
Status instance_step(Instance *it, const char *function, double time, double step_size);
Status instance_terminate(Instance *it, const char *function);
Status instance_reset(Instance *it, const char *function);

/* Check that values of a type can be read into an array, and bring outputs up to date, which before the end of the
 * initialisation may not be possible: a warning. Unless that is an error, read `values` then. */
Status instance_read(Instance *it, const char *function, Type type, const uint32_t references[], size_t count,
                     const void *values);
/* Check the same for writing; then write one by one. */
Status instance_may_write(const Instance *it, const char *function, Type type, const uint32_t references[],
                          size_t count, const void *values);
Status instance_write(Instance *it, const char *function, uint32_t reference, double value);
/* The same for a text, and how to read one. */
Status instance_write_text(Instance *it, const char *function, uint32_t reference, const char *text);
const char *instance_text(const Instance *it, uint32_t reference);
/* Refuse an access to a type that no variable here has; none of nothing is fine. */
Status instance_no_such_type(const Instance *it, const char *function, const char *type, size_t count);

/* Complete states: allocated, reused where `*state` is one already, copied back, freed, as bytes. */
Status instance_get_state(const Instance *it, const char *function, void **state);
Status instance_set_state(Instance *it, const char *function, const void *state);
Status instance_free_state(const Instance *it, const char *function, void **state);
Status instance_state_size(const Instance *it, const char *function, const void *state, size_t *size);
Status instance_state_to_bytes(const Instance *it, const char *function, const void *state, void *bytes, size_t size);
Status instance_state_from_bytes(const Instance *it, const char *function, const void *bytes, size_t size,
                                 void **state);

#endif
