/* What the glue knows of a model: its variables and a few functions. model.h, generated from the component's declaration,
 * says the rest: counts, the table MODEL_VARIABLES, names and limits, and how the model's own types come from values.
 *
 *   typedef ... ModelParameters, ModelCoefficients, ModelState, ModelInputs, ModelOutputs;
 *   const char *model_prepare(const ModelParameters *, ModelCoefficients *);         NULL, or what is wrong, which lasts
 *                                                                                    as long as the coefficients
 *   void model_release(ModelCoefficients *);                                         what was prepared, or all zero
 *   const char *model_warning(const ModelParameters *);                              NULL, or what to think about
 *   void model_initial(ModelState *, const ModelInputs *, const ModelCoefficients *, double time, ModelOutputs *);
 *   void model_advance(ModelState *, const ModelInputs *, const ModelCoefficients *, double time, double step_size,
 *                      ModelOutputs *);
 *   int model_is_valid_state(const ModelState *, const ModelParameters *, double time);        whether a run can have that state at a
 *                                                                                    time; its numbers are finite
 *   ModelInputs model_inputs(const double values[]);
 *   ModelParameters model_parameters(const double values[], const char *const texts[]);
 *   void model_store_outputs(const ModelOutputs *, double values[]);
 *   void model_pack(const ModelState *, double *packed);                             and model_unpack
 *
 * Every variable has one double in a table of values, the time first; its position is its value reference. Texts, which
 * are names of files, stand apart, in their order.
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

/* A variable as declared; an enumeration is an integer from 1, which its bounds say. */
typedef struct {
    const char *name;
    const char *unit; /* empty where it has none */
    Type type;
    Causality causality;
    Variability variability;
    double start, minimum, maximum; /* in the unit; infinite where there is no bound */
} Variable;

#include "model.h"

#endif
