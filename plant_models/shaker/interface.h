/* Variables of the shaker, the C twin of interface.py. Up is positive. */
#ifndef SHAKER_INTERFACE_H
#define SHAKER_INTERFACE_H

/* Times closer than this, in s, are equal: communication points carry rounding errors. */
#define SHAKER_TIME_TOLERANCE 1e-9

/* There are no inputs: the motion depends on time alone. (C has no empty struct.) */
typedef struct {
    char none;
} shaker_inputs;

/* z_v in m, z_v' in m/s, z_v'' in m/s2; the acceleration is its right limit at a jump. */
typedef struct {
    double floor_displacement, floor_velocity, floor_acceleration;
} shaker_outputs;

/* Excitation profiles, and the signal of constant amplitude in a sweep. */
enum { SHAKER_BUMP = 1, SHAKER_SINE, SHAKER_SWEEP, SHAKER_RANDOM, SHAKER_FILE };
enum { SHAKER_SWEEP_ACCELERATION = 1, SHAKER_SWEEP_DISPLACEMENT };

typedef struct {
    int profile;
    double bump_height, bump_length, bump_speed;   /* a in m, l in m, v_0 in m/s (34) */
    double sine_frequency, sine_amplitude;         /* f in Hz, A in m */
    int sweep_mode;                                /* signal of constant amplitude */
    double sweep_start_frequency;                  /* in Hz */
    double sweep_stop_frequency;                   /* in Hz */
    double sweep_duration;                         /* in s */
    double sweep_acceleration, sweep_displacement; /* amplitudes in m/s2 and m; the mode selects one */
    double sweep_fade;                             /* in s */
    int random_class;                              /* 1 for EM1 */
    double random_scale;
    int random_seed;
    const char *file_path;              /* of a recording, see recording.py */
    double file_high_pass;              /* corner frequency in Hz, 0 for none */
    double file_fade;                   /* in s */
    double platform_bandwidth;          /* natural frequency in Hz, 0 for no lag */
    double platform_damping;            /* damping ratio */
    double platform_stroke;             /* in m, 0 for no limit, as below */
    double platform_velocity_limit;     /* in m/s */
    double platform_acceleration_limit; /* in m/s2 */
} shaker_parameters;

#endif
