/* The two standards under one set of names, as far as they agree: what api_test.c calls. FMI is 2 or 3. */
#ifndef API_H
#define API_H

#include "component.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef void *Fmu;
typedef int Code; /* 0 ok, 1 warning, 3 error in both standards */

typedef struct {
    int warnings, errors;
    char last[1024];
} MessageLog;

Fmu make(const char *name, const char *token, bool logging, MessageLog *messages);
Fmu make_of_another_kind(MessageLog *messages);
Fmu make_without_logger(void);
void discard(Fmu fmu);

Code set_logging(Fmu fmu, bool on, size_t count, const char *const names[]);
Code begin(Fmu fmu, double start_time); /* into initialisation */
Code end(Fmu fmu);                      /* out of it */
Code step(Fmu fmu, double time, double step_size);
Code terminate_run(Fmu fmu);
Code reset(Fmu fmu);

Code get(Fmu fmu, Type type, const uint32_t *references, size_t count, double *values);
Code set(Fmu fmu, Type type, const uint32_t *references, size_t count, const double *values);
Code get_text(Fmu fmu, uint32_t reference, const char **text);
Code set_text(Fmu fmu, uint32_t reference, const char *text);
Code get_into_nothing(Fmu fmu);
Code set_from_nothing(Fmu fmu);

Code get_state(Fmu fmu, void **state);
Code set_state(Fmu fmu, void *state);
Code free_state(Fmu fmu, void **state);
Code state_size(Fmu fmu, void *state, size_t *size);
Code to_bytes(Fmu fmu, void *state, char *bytes, size_t size);
Code from_bytes(Fmu fmu, const char *bytes, size_t size, void **state);

/* Call every function this FMU has no use for; returns how many there are, and adds those that did not refuse. */
int call_unsupported(Fmu fmu, int *not_refused);

/* What the standard asks besides: versions, status, arguments that are its own. Returns the number of failures. */
int check_particulars(void);

#endif
