/* The floor derived from one of its signals; see floor.py for the method. */
#include "floor.h"

/* A sample that follows the last one sooner, in s, is ignored: its differences are mostly rounding errors. */
static const double min_interval = 1e-5;

/* Replace the used signal in the motion at initialisation by its first sample. */
static void first_sample(floor_motion *node, const seat_plant_inputs *inputs, int signals)
{
    if (signals == SEAT_PLANT_DISPLACEMENT) {
        node->displacement = inputs->floor_displacement;
    } else if (signals == SEAT_PLANT_VELOCITY) {
        node->velocity = inputs->floor_velocity;
    } else {
        node->acceleration = inputs->floor_acceleration;
    }
}

/* Derive the motion at a new sample from that at the last one. */
static void next_sample(floor_motion *node, double age, double interval, const seat_plant_inputs *inputs, int signals)
{
    const double z = node->displacement, v = node->velocity, a = node->acceleration;
    if (signals == SEAT_PLANT_DISPLACEMENT) {
        const double slope = (inputs->floor_displacement - z) / age;
        const double slope_before = v - 0.5 * a * interval;
        node->displacement = inputs->floor_displacement;
        node->acceleration = interval > 0.0 ? 2.0 * (slope - slope_before) / (age + interval) : 0.0;
        node->velocity = slope + 0.5 * age * node->acceleration;
    } else if (signals == SEAT_PLANT_VELOCITY) {
        node->velocity = inputs->floor_velocity;
        node->displacement = z + 0.5 * age * (v + node->velocity);
        node->acceleration = (node->velocity - v) / age;
    } else {
        node->acceleration = inputs->floor_acceleration;
        node->velocity = v + 0.5 * age * (a + node->acceleration);
        node->displacement = z + age * (v + age * (2.0 * a + node->acceleration) / 6.0);
    }
}

floor_motion floor_derive_motion(floor_history *history, const seat_plant_inputs *inputs, int signals, double step_size)
{
    const double age = history->age;
    floor_motion node = {history->displacement, history->velocity, history->acceleration};
    floor_motion motion;
    if (age > 0.0 && age < min_interval) {
        motion = motion_from_time(&node, age);
        history->age = age + step_size;
    } else {
        if (age > 0.0) {
            next_sample(&node, age, history->interval, inputs, signals);
            history->interval = age;
        } else {
            first_sample(&node, inputs, signals);
            history->end_displacement = node.displacement;
        }
        motion = node;
        history->age = step_size;
    }
    /* the correction takes as long as the deviation took to arise: in a short step after a long one it would be a
     * jump */
    motion.velocity += (motion.displacement - history->end_displacement) / (step_size > age ? step_size : age);
    motion.displacement = history->end_displacement;
    history->displacement = node.displacement;
    history->velocity = node.velocity;
    history->acceleration = node.acceleration;
    history->end_displacement = motion_displacement_at(&motion, step_size);
    return motion;
}
