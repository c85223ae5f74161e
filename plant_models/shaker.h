/* The shaker in C99: the twin of shaker.py. No allocation, no globals, no recursion, no input or output. */
#ifndef SHAKER_H
#define SHAKER_H

/* None: the shaker moves by time alone. (C knows no empty struct.) */
typedef struct {
    char none;
} shaker_inputs;

/* The cabin floor's motion: m, m/s, m/s2; the acceleration is its right limit at a jump. */
typedef struct {
    double floor_displacement, floor_velocity, floor_acceleration;
} shaker_outputs;

/* What the floor does. */
enum { SHAKER_BUMP = 1, SHAKER_SINE = 2 };

typedef struct {
    int profile;
    double bump_height, bump_length, bump_speed;   /* a in m, l in m, v_0 in m/s (34) */
    double sine_frequency, sine_amplitude;         /* f in Hz, A in m */
} shaker_parameters;

/* None yet: the profiles so far are functions of time. */
typedef struct {
    char none;
} shaker_state;

typedef shaker_parameters shaker_coefficients;

/* Derive the coefficients. Returns NULL: the parameters cannot contradict one another. */
const char *shaker_prepare(const shaker_parameters *parameters, shaker_coefficients *coefficients);

/* Nothing to think about: NULL. */
const char *shaker_warning(const shaker_parameters *parameters);

/* Evaluate the floor at the start time, in s. */
void shaker_initial(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, shaker_outputs *outputs);

/* Move the floor to time + step_size, both in s. */
void shaker_advance(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, double step_size, shaker_outputs *outputs);

#endif
