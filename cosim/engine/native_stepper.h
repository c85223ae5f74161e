/* What the master and its loop in C share; native_stepper.py mirrors it, and a test compares the two. Declarations
 * only. */

typedef void (*Function)(void); /* of an FMU; called by its own type */
typedef void Notice(void);      /* of the caller */
typedef bool Verdict(void);     /* of the caller */

/* Types of values. */
typedef enum { float64, float32, bool8, int8, int16, int32, int64, uint8, uint16, uint32, uint64 } ValueType;

/* Some variables of one type that one call moves between an FMU and the table of values. */
typedef struct {
    Function function; /* getter or setter */
    const uint32_t *references;
    void *buffer;         /* elements of all variables */
    const int64_t *index; /* of each element in the table; NULL of an output that is read right into the table */
    const double *factors, *offsets; /* transform values on their way from the table; NULL where they stay */
    const double *low, *high;        /* range of each element of an input; NULL where all values fit */
    int64_t count, reference_count;  /* elements, variables */
    ValueType type;
    int64_t may_be_inexact; /* whether values of an output may not be exact in the table */
    int64_t sampled;        /* whether the outputs are values at the begin of a step */
    int64_t warned;         /* whether the caller knows that this call warns in this run */
} VariableAccess;

typedef struct {
    void *instance;
    Function do_step;
    VariableAccess *inputs, *outputs;
    int64_t input_count, output_count;
    int64_t fmi_version;      /* major */
    int64_t factor, substeps; /* it steps at every factor-th tick, in so many substeps; one of the two is 1 */
    double step_size;         /* of a substep, in s */
    int64_t warned;           /* as of a variable access: whether its step does */
} Component;

/* A value that is recorded: values[index] into a row's column. */
typedef struct {
    int64_t column, index;
} RecordedValue;

/* What is called, or what went wrong. */
typedef enum {
    nothing,
    setting,
    stepping,
    getting,
    terminated,
    returned_early,
    not_finite,
    out_of_range,
    inexact
} Cause;

/* The call that is made, so that the caller can tell which one an FMU's message comes from; in the end, what went
 * wrong. */
typedef struct {
    const Component *component;
    Cause cause;
    int64_t number;  /* of the input or output access, or of the substep */
    int64_t element; /* of the access, whose value does not fit */
    int64_t status;
    double reached; /* time in s that the FMU says it has reached */
} Call;

typedef struct {
    Component *components;          /* in the order in which they step */
    int64_t component_count, group; /* group: how many exchange values at once */
    double *values;                 /* of all outputs, and constants */
    int64_t value_count;
    double *rows;                              /* where the row of tick `first_recorded` goes; the others follow */
    const RecordedValue *continuous, *sampled; /* recorded before a tick's step, and after it */
    int64_t width, continuous_count, sampled_count, record_every, first_recorded;
    int64_t done;                 /* number of ticks that are complete */
    double start_time, step_size; /* of the run and of communication, in s */
    Notice *warned;               /* called when a call warns for the first time in a run */
    Verdict *inexact;             /* called for a value that is not exact; whether the run can go on */
    Call call;
} Schedule;

/* The hash of the sources that the library was compiled of. */
const char *stepper_source(void);

/* Begin a run: no tick is complete, no call has warned. */
void stepper_begin(Schedule *schedule);

/* Step from one tick to another; whether nothing went wrong, else `call` says what. */
bool stepper_run(Schedule *schedule, int64_t first, int64_t last);
