/* The shaker's variables in C99: the twin of interface.py. */
#ifndef SHAKER_INTERFACE_H
#define SHAKER_INTERFACE_H

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

#endif
