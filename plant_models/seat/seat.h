/* The seat, the C twin of seat.py. No allocation, no globals, no recursion, no input or output. Up is positive; times
 * in s; equation numbers are those of the paper. */
#ifndef SEAT_PLANT_H
#define SEAT_PLANT_H

#include "actuator.h"
#include "body.h"
#include "floor.h"
#include "friction.h"
#include "seat_interface.h"
#include "sensors.h"

/* Mechanical state: seat, driver and the friction between seat and floor. */
typedef struct {
    double seat_displacement, seat_velocity;     /* z_s in m, z_s' in m/s */
    double driver_displacement, driver_velocity; /* z_b in m, z_b' in m/s */
    double friction;                             /* z_d of (36) in m */
    double upper_displacements[BODY_MASSES - 1]; /* of a seated body above its pelvis in m, 0 with other drivers */
    double upper_velocities[BODY_MASSES - 1];    /* in m/s */
} seat_plant_masses;

/* Sensor signals after the low-pass: z_s'' in m/s2, z_s - z_v in m. */
typedef struct {
    double acceleration, deflection;
} seat_plant_filtered;

typedef struct {
    seat_plant_masses masses;
    floor_history floor;
    seat_plant_filtered filtered;
    actuator_state actuator;
} seat_plant_state;

/* Coefficients of the step, in the symbols of (1), (2) and (35). */
typedef struct {
    double per_m_s, per_m_b; /* 1/m_s, 1/m_b in 1/kg */
    double k_f, c_f;         /* suspension: stiffness in N/m, damping in N.s/m */
    double k_c, c_c;         /* cushion, or contact of a seated driver; 0 with an external one */
    int driver_model;        /* who sits on the seat */
    body_coefficients body;  /* of a seated driver */
    double alpha;            /* friction force per friction state in N/m */
    friction_coefficients friction;
    double substep;       /* longest Runge-Kutta substep in s */
    int floor_signals;    /* used floor inputs */
    double x_e, k_e, c_e; /* end stops: travel in m, infinite where there are none; N/m; N.s/m */
    double x_m;           /* height of static equilibrium above the middle of the travel in m */
    actuator_coefficients actuator;
    double bandwidth; /* corner frequency of the sensors' low-pass in rad/s, 0 for none */
    int single_span;  /* whether there is no delay, lag, low-pass or end stop: a step is one span */
    sensor_coefficients accelerometer, deflection_sensor;
} seat_plant_coefficients;

/* Derive the coefficients. Returns NULL, or a message about the parameters in terms of their names. */
const char *seat_plant_prepare(const seat_plant_parameters *parameters, seat_plant_coefficients *coefficients);

/* Return a warning about legal parameters: always NULL. */
const char *seat_plant_warning(const seat_plant_parameters *parameters);

/* Check that a run can have a state with finite numbers. */
int seat_plant_is_valid_state(const seat_plant_state *state, const seat_plant_parameters *parameters, double time);

/* Set the state of rest in static equilibrium; a derived floor starts from the motion in the inputs. */
void seat_plant_initialize(seat_plant_state *state, const seat_plant_inputs *inputs,
                           const seat_plant_coefficients *coefficients, double time, seat_plant_outputs *outputs);

/* Extrapolate the floor over a communication step, as in floor.py; moves the history of the floor to its end. */
floor_motion seat_plant_begin_step(seat_plant_state *state, const seat_plant_inputs *inputs,
                                   const seat_plant_coefficients *coefficients, double step_size);

/* Integrate (1)-(2) over a communication step, or a part of one, on a floor of known motion; the forces of the actuator
 * and of an external driver are held. */
void seat_plant_advance_on_floor(seat_plant_state *state, const floor_motion *motion, double force, double driver_force,
                                 const seat_plant_coefficients *coefficients, double time, double step_size,
                                 seat_plant_outputs *outputs);

/* Integrate (1)-(2) over one communication step; the forces are held, the floor is extrapolated as in floor.py. */
void seat_plant_advance(seat_plant_state *state, const seat_plant_inputs *inputs,
                        const seat_plant_coefficients *coefficients, double time, double step_size,
                        seat_plant_outputs *outputs);

#endif
