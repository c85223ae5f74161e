/* The seat in C99: the twin of seat.py and friction.py. No allocation, no globals, no recursion, no input or output. */
#ifndef SEAT_PLANT_H
#define SEAT_PLANT_H

#include <stdint.h>

/* What the floor and the actuator do to the seat: m, m/s, m/s2, N. */
typedef struct {
    double floor_displacement, floor_velocity, floor_acceleration;
    double force;
} seat_plant_inputs;

/* What the seat does, and what its sensors report. */
typedef struct {
    double seat_acceleration;                         /* z_s'' in m/s2 */
    double suspension_deflection, deflection_rate;    /* z_s - z_v in m, its rate in m/s */
    double driver_acceleration;                       /* z_b'' in m/s2 */
    double seat_displacement, driver_displacement;    /* z_s, z_b in m */
    double friction_force;                            /* f_r (35) in N */
    double seat_acceleration_measured, suspension_deflection_measured;
} seat_plant_outputs;

/* Which of the floor's inputs are alive; the others are derived. */
enum { SEAT_PLANT_ALL = 1, SEAT_PLANT_DISPLACEMENT = 2, SEAT_PLANT_VELOCITY = 3, SEAT_PLANT_ACCELERATION = 4 };

typedef struct {
    double driver_mass, seat_mass;                    /* m_b, m_s in kg */
    double suspension_stiffness, suspension_damping;  /* k_f in N/m, c_f in N.s/m */
    double cushion_stiffness, cushion_damping;        /* k_c in N/m, c_c in N.s/m */
    double friction_alpha;                            /* alpha in N/m */
    double friction_gamma, friction_beta;             /* gamma_d, beta_d in 1/m2 */
    double friction_amplitude;                        /* A_d */
    int floor_signals;                                /* which floor inputs are alive */
    double actuator_force_limit;                      /* u_max in N, 0 for none */
    double actuator_delay, actuator_time_constant;    /* T_d, T_a in s */
    double sensor_bandwidth;                          /* f_s in Hz, 0 for none */
    double acceleration_noise, acceleration_bias, acceleration_resolution;   /* in m/s2 */
    double deflection_noise, deflection_bias, deflection_resolution;         /* in m */
    int sensor_seed;
    double end_stop_travel;                           /* x_e in m, 0 for none */
    double end_stop_stiffness, end_stop_damping;      /* k_e in N/m, c_e in N.s/m */
} seat_plant_parameters;

/* Changes in the actuator's delay line. */
enum { SEAT_PLANT_PLACES = 128 };

typedef struct {
    double seat_displacement, seat_velocity;          /* z_s in m, z_s' in m/s */
    double driver_displacement, driver_velocity;      /* z_b in m, z_b' in m/s */
    double friction;                                  /* z_d of (36) in m */
    /* what a derived floor remembers: its motion at the last sample in m, m/s, m/s2, */
    double floor_displacement, floor_velocity, floor_acceleration;
    double floor_age, floor_interval;                 /* the time since then and from the sample before till then in s, */
    double floor_reached;                             /* and where the last step has left it in m */
    double sensed_acceleration, sensed_deflection;    /* what has passed the sensors' low-pass in m/s2, m */
    double force_commanded, force_target, force;      /* latest into the delay, latest out of it, on the seat in N */
    double line_length;                               /* numbers in use of the delay line: */
    double line[2 * SEAT_PLANT_PLACES];               /* arrival in s and force in N of each change, then zeros */
} seat_plant_state;

/* Coefficients of the closed-form friction step. */
typedef struct {
    double plateau;                                   /* sqrt(A_d/(gamma_d + beta_d)) in m */
    double loading_rate;                              /* sqrt(A_d (gamma_d + beta_d)) in 1/m */
    double unloading_scale;                           /* sqrt(A_d/(gamma_d - beta_d)) in m */
    double unloading_rate;                            /* sqrt(A_d (gamma_d - beta_d)) in 1/m */
} seat_plant_friction;

/* What the actuator does to a force; the limit may be infinite. */
typedef struct {
    double limit, delay, time_constant;
} seat_plant_actuator;

/* What a sensor does to its signal, and its stream of random numbers. */
typedef struct {
    double noise, bias, resolution;
    uint64_t stream;
    int ideal;                                        /* whether it does nothing */
} seat_plant_sensor;

/* Parameters as the step needs them, in the symbols of (1), (2) and (35). */
typedef struct {
    double per_m_s, per_m_b;                          /* 1/m_s, 1/m_b in 1/kg */
    double k_f, c_f, k_c, c_c, alpha;
    seat_plant_friction friction;
    double substep;                                   /* longest Runge-Kutta substep in s */
    int floor_signals;
    double x_e, k_e, c_e;                             /* x_e is infinite where there are no end stops */
    seat_plant_actuator actuator;
    double bandwidth;                                 /* of the sensors in rad/s */
    int steady;                                       /* neither delay, lag, low-pass nor end stop divides a step */
    seat_plant_sensor accelerometer, deflection_sensor;
} seat_plant_coefficients;

/* States of smaller magnitude are zero: fading out, they would become denormal, which is slow. */
static inline double seat_plant_flushed(double state)
{
    return state > -1e-30 && state < 1e-30 ? 0.0 : state;
}

/* Derive the coefficients. Returns NULL, or what is wrong with the parameters in terms of their names. */
const char *seat_plant_prepare(const seat_plant_parameters *parameters, seat_plant_coefficients *coefficients);

/* Nothing to think about: NULL. */
const char *seat_plant_warning(const seat_plant_parameters *parameters);

/* Whether the state can be one of a run: the delay line holds pairs, no more than there is room for. */
int seat_plant_fits(const seat_plant_state *state, const seat_plant_parameters *parameters, double time);

/* Start at rest in static equilibrium; a derived floor starts from the inputs' motion. */
void seat_plant_initial(seat_plant_state *state, const seat_plant_inputs *inputs,
                        const seat_plant_coefficients *coefficients, double time, seat_plant_outputs *outputs);

/* Integrate (1)-(2) over a communication step, in s; the force is held, the floor goes on as floor.py says. */
void seat_plant_advance(seat_plant_state *state, const seat_plant_inputs *inputs,
                        const seat_plant_coefficients *coefficients, double time, double step_size,
                        seat_plant_outputs *outputs);

#endif
