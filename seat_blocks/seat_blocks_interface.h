/* Variables of the blocks, the C twin of interface.py. Up is positive. */
#ifndef SEAT_BLOCKS_INTERFACE_H
#define SEAT_BLOCKS_INTERFACE_H

#include "seat.h"

/* Motion of the cabin floor. */
typedef struct {
    double floor_displacement, floor_velocity, floor_acceleration; /* z_v in m, z_v' in m/s, z_v'' in m/s2 */
} seat_block_inputs;

/* Outputs that all blocks have. */
typedef struct {
    double driver_acceleration, seat_acceleration; /* z_b'', z_s'' in m/s2 */
    double suspension_deflection;                  /* z_s - z_v in m */
    double floor_force;                            /* of the seat on the floor, in N */
    double deflection_rate;                        /* in m/s */
    double seat_displacement, driver_displacement; /* z_s, z_b in m */
    double friction_force;                         /* f_r (35) in N, acts on the seat as -f_r */
    double head_acceleration;                      /* of the driver's head in m/s2 */
} seat_signals;

/* Outputs of the blocks that measure: what the law takes next, in m/s2 and m. */
typedef struct {
    double seat_acceleration_measured, suspension_deflection_measured;
} seat_measurements;

typedef seat_block_inputs passive_seat_inputs;
typedef seat_block_inputs semi_active_seat_inputs;

typedef struct {
    seat_signals seat;
    double force; /* 0 N */
} passive_seat_outputs;

typedef struct {
    seat_signals seat;
    seat_measurements measured;
    double force;             /* of the damper on the seat, in N */
    double damping;           /* c in N.s/m */
    double velocity_estimate; /* w in m/s */
} semi_active_seat_outputs;

typedef struct {
    seat_plant_parameters seat;
} passive_seat_parameters;

typedef struct {
    double minimum, maximum, skyhook; /* c_min, c_max, c_sky in N.s/m */
    double time_constant;             /* T_c in s */
    double velocity_corner;           /* f_l in Hz */
    double rate_filter_cutoff;        /* f_c in Hz */
} damper_parameters;

typedef struct {
    damper_parameters damper;
    seat_plant_parameters seat;
    double sample_time; /* h in s */
} semi_active_seat_parameters;

/* Return what a block gives of the outputs of its seat. */
static inline seat_signals seat_signals_of(const seat_plant_outputs *outputs)
{
    seat_signals signals;
    signals.driver_acceleration = outputs->driver_acceleration;
    signals.seat_acceleration = outputs->seat_acceleration;
    signals.suspension_deflection = outputs->suspension_deflection;
    signals.floor_force = outputs->floor_force;
    signals.deflection_rate = outputs->deflection_rate;
    signals.seat_displacement = outputs->seat_displacement;
    signals.driver_displacement = outputs->driver_displacement;
    signals.friction_force = outputs->friction_force;
    signals.head_acceleration = outputs->head_acceleration;
    return signals;
}

/* Return the measurements of a block's seat. */
static inline seat_measurements measurements_of(const seat_plant_outputs *outputs)
{
    const seat_measurements measured = {outputs->seat_acceleration_measured, outputs->suspension_deflection_measured};
    return measured;
}

/* Return the inputs of a seat without forces from outside. */
static inline seat_plant_inputs seat_inputs_of(const seat_block_inputs *inputs)
{
    const seat_plant_inputs of_seat = {inputs->floor_displacement, inputs->floor_velocity, inputs->floor_acceleration,
                                       0.0, 0.0};
    return of_seat;
}

#endif
