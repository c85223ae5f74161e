/* A truck that drives over a road at constant speed; see truck.py. */
#include "truck.h"

#include <math.h>
#include <stddef.h>

/* Largest difference in s between a state and the time that the run has reached; allows for rounding errors of hosts.
 */
static const double clock_tolerance = 1.0;

typedef truck_cab_coefficients coefficients_t;

const char *truck_cab_prepare(const truck_cab_parameters *parameters, coefficients_t *c)
{
    const char *problem = vehicle_prepare(parameters, &c->vehicle);
    c->speed = parameters->speed;
    c->wheelbase = parameters->wheelbase;
    return problem != NULL ? problem : road_prepare(parameters, &c->road);
}

void truck_cab_release(coefficients_t *coefficients)
{
    road_release(&coefficients->road);
}

const char *truck_cab_warning(const truck_cab_parameters *parameters)
{
    (void)parameters;
    return NULL;
}

int truck_cab_is_valid_state(const truck_cab_state *state, const truck_cab_parameters *parameters, double time)
{
    const double elapsed = time - state->start;
    const double distance = parameters->speed * elapsed, tolerance = parameters->speed * clock_tolerance;
    return elapsed >= -clock_tolerance &&
           road_is_valid_track(&state->front, parameters->road_profile, distance, tolerance) &&
           road_is_valid_track(&state->rear, parameters->road_profile, distance - parameters->wheelbase, tolerance);
}

void truck_cab_initialize(truck_cab_state *state, const truck_cab_inputs *inputs, const coefficients_t *coefficients,
                          double time, truck_cab_outputs *outputs)
{
    static const truck_cab_state rest;
    static const vehicle_motion still;
    static const vehicle_road flat;
    *state = rest;
    state->start = time;
    state->seat_force = inputs->seat_force;
    state->front = state->rear = road_before();
    vehicle_outputs(&still, &flat, inputs->seat_force, &coefficients->vehicle, outputs);
}

/* Advance both axles to a time since the start; return the elevations under them. */
static vehicle_road drive(truck_cab_state *state, double elapsed, const coefficients_t *c)
{
    const double distance = c->speed * elapsed;
    const double behind = distance - c->wheelbase;
    vehicle_road under;
    road_advance(&state->front, distance, &c->road);
    road_advance(&state->rear, behind, &c->road);
    under.front = road_elevation(&state->front, distance, &c->road);
    under.rear = road_elevation(&state->rear, behind, &c->road);
    return under;
}

void truck_cab_advance(truck_cab_state *state, const truck_cab_inputs *inputs, const coefficients_t *c, double time,
                       double step_size, truck_cab_outputs *outputs)
{
    const double elapsed = time - state->start, needed = ceil(step_size / c->vehicle.substep - 1e-6);
    const double count = needed > 1.0 ? needed : 1.0;
    const double h = step_size / count;
    const double before = state->seat_force, change = inputs->seat_force - state->seat_force;
    vehicle_motion motion;
    vehicle_road roads[3];
    for (int i = 0; i < VEHICLE_DEGREES; ++i) {
        motion.z[i] = state->displacements[i];
        motion.v[i] = state->velocities[i];
    }
    roads[0] = drive(state, elapsed, c);
    for (double index = 0.0; index < count; index += 1.0) {
        roads[1] = drive(state, elapsed + (index + 0.5) * h, c);
        roads[2] = drive(state, elapsed + (index + 1.0) * h, c);
        const double forces[3] = {before + change * (index / count), before + change * ((index + 0.5) / count),
                                  before + change * ((index + 1.0) / count)};
        vehicle_substep(&motion, h, roads, forces, &c->vehicle);
        roads[0] = roads[2];
    }
    for (int i = 0; i < VEHICLE_DEGREES; ++i) {
        state->displacements[i] = motion.z[i];
        state->velocities[i] = motion.v[i];
    }
    state->seat_force = inputs->seat_force;
    vehicle_outputs(&motion, &roads[0], inputs->seat_force, &c->vehicle, outputs);
}
