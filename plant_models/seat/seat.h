/* The seat in C99: the twin of seat.py. No allocation, no globals, no recursion, no input or output. */
#ifndef SEAT_PLANT_H
#define SEAT_PLANT_H

#include "actuator.h"
#include "floor.h"
#include "friction.h"
#include "interface.h"
#include "sensors.h"

/* What moves: two masses and the friction between them and the floor. */
typedef struct {
    double seat_displacement, seat_velocity;     /* z_s in m, z_s' in m/s */
    double driver_displacement, driver_velocity; /* z_b in m, z_b' in m/s */
    double friction;                             /* z_d of (36) in m */
} seat_plant_masses;

/* What has passed the sensors' low-pass, in m/s2 and m. */
typedef struct {
    double acceleration, deflection;
} seat_plant_sensed;

typedef struct {
    seat_plant_masses masses;
    floor_history floor;
    seat_plant_sensed sensed;
    actuator_state actuator;
} seat_plant_state;

/* Parameters as the step needs them, in the symbols of (1), (2) and (35). */
typedef struct {
    double per_m_s, per_m_b;                                   /* 1/m_s, 1/m_b in 1/kg */
    double k_f, c_f, k_c, c_c, alpha;
    friction_coefficients friction;
    double substep;                                            /* longest Runge-Kutta substep in s */
    int floor_signals;
    double x_e, k_e, c_e;                                      /* x_e is infinite where there are no end stops */
    actuator_coefficients actuator;
    double bandwidth;                                          /* of the sensors in rad/s */
    int steady;                                                /* neither delay, lag, low-pass nor end stop divides a step */
    sensor_coefficients accelerometer, deflection_sensor;
} seat_plant_coefficients;

/* Derive the coefficients. Returns NULL, or what is wrong with the parameters in terms of their names. */
const char *seat_plant_prepare(const seat_plant_parameters *parameters, seat_plant_coefficients *coefficients);

/* Nothing to think about: NULL. */
const char *seat_plant_warning(const seat_plant_parameters *parameters);

/* Whether the state can be one of a run: the delay line holds pairs, no more than there is room for. */
int seat_plant_is_valid_state(const seat_plant_state *state, const seat_plant_parameters *parameters, double time);

/* Start at rest in static equilibrium; a derived floor starts from the inputs' motion. */
void seat_plant_initial(seat_plant_state *state, const seat_plant_inputs *inputs,
                        const seat_plant_coefficients *coefficients, double time, seat_plant_outputs *outputs);

/* Integrate (1)-(2) over a communication step, in s; the force is held, the floor goes on as floor.py says. */
void seat_plant_advance(seat_plant_state *state, const seat_plant_inputs *inputs,
                        const seat_plant_coefficients *coefficients, double time, double step_size,
                        seat_plant_outputs *outputs);

#endif
