/* The shaker in C99: the twin of shaker.py. No globals, no recursion; memory and files in preparing a recording only. */
#ifndef SHAKER_H
#define SHAKER_H

#include <stddef.h>
#include <stdint.h>

/* Times closer than this, in s, are one instant: communication points carry rounding errors. */
#define SHAKER_SAME_INSTANT 1e-9

/* None: the shaker moves by time alone. (C knows no empty struct.) */
typedef struct {
    char none;
} shaker_inputs;

/* The cabin floor's motion: m, m/s, m/s2; the acceleration is its right limit at a jump. */
typedef struct {
    double floor_displacement, floor_velocity, floor_acceleration;
} shaker_outputs;

/* What the floor does, and which amplitude a sweep keeps. */
enum { SHAKER_BUMP = 1, SHAKER_SINE, SHAKER_SWEEP, SHAKER_RANDOM, SHAKER_FILE };
enum { SHAKER_SWEEP_ACCELERATION = 1, SHAKER_SWEEP_DISPLACEMENT };

typedef struct {
    int profile;
    double bump_height, bump_length, bump_speed;          /* a in m, l in m, v_0 in m/s (34) */
    double sine_frequency, sine_amplitude;                /* f in Hz, A in m */
    int sweep_mode;
    double sweep_start_frequency, sweep_stop_frequency;   /* in Hz */
    double sweep_duration;                                /* in s */
    double sweep_acceleration, sweep_displacement;        /* amplitudes in m/s2 and m, which one: the mode */
    double sweep_fade;                                    /* in s */
    int random_class;                                     /* 1 for EM1 */
    double random_scale;
    int random_seed;
    const char *file_path;                                /* of a recording, see recording.py */
    double file_high_pass, file_fade;                     /* in Hz, 0: none; in s */
    double platform_bandwidth, platform_damping;          /* in Hz, 0: it follows exactly; damping ratio */
    double platform_stroke;                               /* in m, 0: no limit, as below */
    double platform_velocity_limit;                       /* in m/s */
    double platform_acceleration_limit;                   /* in m/s2 */
} shaker_parameters;

/* ---- noise.c ----------------------------------------------------------------------------------------------------- */

enum { NOISE_MODES = 8 };

typedef struct {
    double re, im;
} noise_complex;

/* One pole in rad/s, what a tick does to its state, and its share in the three signals. */
typedef struct {
    noise_complex pole, growth, push;
    noise_complex displacement, velocity, acceleration;
} noise_mode;

typedef struct {
    int count;
    noise_mode modes[NOISE_MODES];
} noise_coefficients;

/* ---- replay.c ---------------------------------------------------------------------------------------------------- */

/* A recorded motion at its knots: s, m, m/s, m/s2. */
typedef struct {
    size_t count;
    double *times, *displacements, *velocities, *accelerations;
    double *memory;                                       /* of all of them, NULL for none */
    char message[1024];                                   /* what is wrong with the file */
} replay_curve;

/* ---- platform.c -------------------------------------------------------------------------------------------------- */

typedef struct {
    int present;
    double stiffness, damping;                            /* omega^2 in 1/s2, 2 zeta omega in 1/s */
    double tick;                                          /* in s */
    double stroke, velocity_limit, acceleration_limit;    /* in m, m/s, m/s2; infinite where there is none */
    double braking;                                       /* deceleration before the end of the stroke, in m/s2 */
} platform_coefficients;

/* ---- the component ----------------------------------------------------------------------------------------------- */

/* All of it at the begin of a tick. */
typedef struct {
    double tick;                                          /* number, from time 0 */
    double modes[2 * NOISE_MODES];                        /* real and imaginary parts */
    double platform_displacement, platform_velocity;      /* in m, m/s */
    double platform_acceleration;                         /* in m/s2, over the tick */
} shaker_state;

typedef struct {
    shaker_parameters parameters;
    int ticking;                                          /* whether there is noise or a platform */
    uint64_t stream;                                      /* of random numbers */
    noise_coefficients noise;
    replay_curve curve;
    platform_coefficients platform;
} shaker_coefficients;

/* Derive the coefficients; a recording's memory is theirs until they are released. Returns NULL, or what is wrong with the
 * parameters in terms of their names or with the recording; then there is nothing to release. */
const char *shaker_prepare(const shaker_parameters *parameters, shaker_coefficients *coefficients);

/* Free the memory of coefficients, prepared or all zero. */
void shaker_release(shaker_coefficients *coefficients);

/* Nothing to think about: NULL. */
const char *shaker_warning(const shaker_parameters *parameters);

/* Whether the state can be one of a run that has reached a time, in s: noise and platform are at its tick. */
int shaker_fits(const shaker_state *state, const shaker_parameters *parameters, double time);

/* Evaluate the floor at the start time, in s; noise and platform are at rest until the first tick. */
void shaker_initial(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, shaker_outputs *outputs);

/* Move the floor to time + step_size, both in s. */
void shaker_advance(shaker_state *state, const shaker_inputs *inputs, const shaker_coefficients *coefficients,
                    double time, double step_size, shaker_outputs *outputs);

#endif
