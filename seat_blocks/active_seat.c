/* Controller and seat in one block; see active_seat.py for the order of their steps. */
#include "active_seat.h"

#include "parts.h"

#include <math.h>
#include <stddef.h>

/* Largest difference of the driver's mass that the controller assumes, as a share of it, without a warning. */
static const double mass_tolerance = 0.2;

/* Ranges of the controller's parameters that can be the seat's, as interface.py declares them. */
static const double min_driver_mass = 20.0, max_driver_mass = 250.0; /* in kg */
static const double max_time_constant = 0.2, max_delay = 0.1;        /* in s */
static const double max_travel = 1.0;                                /* in m */

/* Return what the controller assumes: its own parameter above 0, otherwise the seat's, within the range. */
static double known(double own, double of_seat, double low, double high)
{
    const double value = own > 0.0 ? own : of_seat;
    return value < low ? low : value > high ? high : value;
}

/* Return the shorter way to an end stop from static equilibrium in m, 0 for no stops. */
static double free_travel(double travel, double height)
{
    const double shorter = travel - fabs(height);
    return shorter > 0.0 ? shorter : 0.0;
}

/* Return the parameters of the controller with what it knows of the seat. */
static seat_controller_parameters controller_parameters(const active_seat_parameters *p)
{
    const seat_plant_parameters *seat = &p->seat;
    const double travel = free_travel(seat->end_stop_travel, seat->end_stop_height);
    seat_controller_parameters c = p->controller;
    c.driver_mass = known(c.driver_mass, seat->driver_mass, min_driver_mass, max_driver_mass);
    c.actuator_time_constant = known(c.actuator_time_constant, seat->actuator_time_constant, 0.0, max_time_constant);
    c.actuator_delay = known(c.actuator_delay, seat->actuator_delay, 0.0, max_delay);
    c.travel = known(c.travel, travel, 0.0, max_travel);
    return c;
}

const char *active_seat_prepare(const active_seat_parameters *parameters, active_seat_coefficients *coefficients)
{
    const seat_controller_parameters of_controller = controller_parameters(parameters);
    const double h = of_controller.sample_time;
    const double samples = floor(parameters->inner_step_size / h + sample_tolerance);
    const char *problem = seat_controller_prepare(&of_controller, &coefficients->controller);
    coefficients->interval = parameters->inner_step_size > 0.0 ? (samples > 1.0 ? samples : 1.0) * h : 0.0;
    return problem != NULL ? problem : prepare_seat(&parameters->seat, &coefficients->seat);
}

const char *active_seat_warning(const active_seat_parameters *parameters)
{
    const seat_controller_parameters of_controller = controller_parameters(parameters);
    const double assumed = parameters->controller.driver_mass, true_mass = parameters->seat.driver_mass;
    if (assumed > 0.0 && fabs(assumed - true_mass) > mass_tolerance * true_mass) {
        return "controller.driver_mass is not seat.driver_mass: the gains are those of another driver; 0 is the seat's";
    }
    return seat_controller_warning(&of_controller);
}

int active_seat_is_valid_state(const active_seat_state *state, const active_seat_parameters *parameters, double time)
{
    const seat_controller_parameters of_controller = controller_parameters(parameters);
    return seat_controller_is_valid_state(&state->controller, &of_controller, time) &&
           seat_plant_is_valid_state(&state->seat, &parameters->seat, time);
}

void active_seat_initialize(active_seat_state *state, const active_seat_inputs *inputs,
                            const active_seat_coefficients *coefficients, double time, active_seat_outputs *outputs)
{
    const seat_controller_inputs none = {0.0, 0.0};
    seat_plant_inputs at_rest = seat_inputs_of(inputs);
    seat_plant_outputs of_seat;
    seat_controller_initialize(&state->controller, &none, &coefficients->controller, time, &outputs->controller);
    at_rest.force = outputs->controller.force;
    seat_plant_initialize(&state->seat, &at_rest, &coefficients->seat, time, &of_seat);
    state->acceleration = of_seat.seat_acceleration_measured;
    state->deflection = of_seat.suspension_deflection_measured;
    outputs->seat = seat_signals_of(&of_seat);
    outputs->measured = measurements_of(&of_seat);
}

void active_seat_advance(active_seat_state *state, const active_seat_inputs *inputs,
                         const active_seat_coefficients *coefficients, double time, double step_size,
                         active_seat_outputs *outputs)
{
    const active_seat_coefficients *c = coefficients;
    const seat_plant_inputs floor_inputs = seat_inputs_of(inputs);
    const floor_motion motion = seat_plant_begin_step(&state->seat, &floor_inputs, &c->seat, step_size);
    seat_plant_outputs of_seat;
    double begin = 0.0;
    do {
        const double end = end_of_part(time, begin, step_size, c->interval);
        const seat_controller_inputs measured = {state->acceleration, state->deflection};
        const floor_motion rest = motion_from_time(&motion, begin);
        seat_controller_advance(&state->controller, &measured, &c->controller, time + begin, end - begin,
                                &outputs->controller);
        seat_plant_advance_on_floor(&state->seat, &rest, outputs->controller.force, 0.0, &c->seat, time + begin,
                                    end - begin, &of_seat);
        state->acceleration = of_seat.seat_acceleration_measured;
        state->deflection = of_seat.suspension_deflection_measured;
        begin = end;
    } while (begin < step_size);
    outputs->seat = seat_signals_of(&of_seat);
    outputs->measured = measurements_of(&of_seat);
}
