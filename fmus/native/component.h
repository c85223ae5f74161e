/* Interface of a model to the glue code: its variables and a few functions. model.h is generated from the declaration
 * of the component. It defines counts, names, limits, the table MODEL_VARIABLES, and the conversion of values to the
 * types of the model. Times are in s.
 *
 *   typedef ... ModelParameters, ModelCoefficients, ModelState, ModelInputs, ModelOutputs;
 *
 *   const char *model_prepare(const ModelParameters *, ModelCoefficients *);
 *       Derives the coefficients. Returns NULL, or a message, valid as long as the coefficients.
 *   void model_release(ModelCoefficients *);
 *       Frees the memory of coefficients that are prepared or all zero.
 *   const char *model_warning(const ModelParameters *);
 *       Returns NULL, or a warning about legal parameters.
 *   void model_initialize(ModelState *, const ModelInputs *, const ModelCoefficients *, double time, ModelOutputs *);
 *       Sets the state at the start and its outputs.
 *   void model_advance(ModelState *, const ModelInputs *, const ModelCoefficients *, double time, double step_size,
 *                      ModelOutputs *);
 *       Advances the state over one communication step; the outputs are those at its end.
 *   int model_is_valid_state(const ModelState *, const ModelParameters *, double time);
 *       Whether a run that has reached a time can have this state with finite numbers.
 *
 *   ModelInputs model_inputs(const double values[]);
 *   ModelParameters model_parameters(const double values[], const char *const texts[]);
 *   void model_store_outputs(const ModelOutputs *, double values[]);
 *       Conversion between the table of values and the types of the model.
 *   void model_pack(const ModelState *, double packed[]);
 *   void model_unpack(ModelState *, const double packed[]);
 *       Conversion between a state and STATE_COUNT numbers.
 *   size_t model_tail_length(const ModelState *);
 *   void model_copy(ModelState *to, const ModelState *from, size_t tail_length);
 *       Copy of a state without the unused values at its end.
 *
 * Every variable has one double in a table of values, beginning with the time; its position is its value reference.
 * Texts, which are paths of files, have an array of their own, in the order of their value references.
 */
#ifndef COMPONENT_H
#define COMPONENT_H

typedef enum { TYPE_REAL, TYPE_BOOLEAN, TYPE_INTEGER, TYPE_TEXT } Type;

typedef enum {
    CAUSALITY_INDEPENDENT,
    CAUSALITY_INPUT,
    CAUSALITY_OUTPUT,
    CAUSALITY_PARAMETER,
    CAUSALITY_LOCAL
} Causality;

typedef enum {
    VARIABILITY_CONSTANT,
    VARIABILITY_FIXED,
    VARIABILITY_TUNABLE,
    VARIABILITY_DISCRETE,
    VARIABILITY_CONTINUOUS
} Variability;

/* A variable as declared; an enumeration is an integer with the minimum 1. */
typedef struct {
    const char *name;
    const char *unit; /* empty where there is none */
    Type type;
    Causality causality;
    Variability variability;
    double start, minimum, maximum; /* in the unit; infinite where there is no bound */
} Variable;

#include "model.h"

#endif
