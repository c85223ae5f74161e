/* Variables of the truck, the C twin of interface.py. Up and nose down are positive. */
#ifndef TRUCK_INTERFACE_H
#define TRUCK_INTERFACE_H

/* Force F of the seat on the cab floor in N, beyond the static one; held over a step. */
typedef struct {
    double seat_force;
} truck_cab_inputs;

/* From static equilibrium on a flat road. */
typedef struct {
    double floor_displacement, floor_velocity, floor_acceleration; /* at the seat, in m, m/s, m/s2 */
    double road_elevation;                                         /* under the front axle, in m */
    double chassis_acceleration;                                   /* at the centre of gravity, in m/s2 */
    double cab_pitch;                                              /* in rad */
    double front_tyre_force, rear_tyre_force;                      /* of the road on the axles, in N */
} truck_cab_outputs;

/* Profiles of the road. */
enum { TRUCK_ISO8608 = 1, TRUCK_BUMP, TRUCK_POTHOLE, TRUCK_KERB, TRUCK_FILE };

/* Masses in kg, inertias in kg.m2, lengths in m, stiffnesses in N/m, dampings in N.s/m, of both sides together. */
typedef struct {
    double speed;                                               /* v in m/s */
    int road_profile, road_class, road_seed;                    /* class 1 for A */
    double road_fade;                                           /* distance in m over which the road rises */
    const char *road_file;                                      /* of a road, see recording.py */
    double obstacle_height, obstacle_length, obstacle_position; /* in m */
    double cab_mass, cab_pitch_inertia;
    double cab_position;                    /* behind the front axle */
    double cab_front_mount, cab_rear_mount; /* from the cab's centre of gravity */
    double cab_front_stiffness, cab_rear_stiffness, cab_front_damping, cab_rear_damping;
    double chassis_mass, chassis_pitch_inertia;
    double chassis_position; /* behind the front axle */
    double wheelbase;
    double front_stiffness, rear_stiffness, front_damping, rear_damping;
    double front_axle_mass, rear_axle_mass;
    double front_tyre_stiffness, rear_tyre_stiffness;
    double seat_position; /* ahead of the cab's centre of gravity */
} truck_cab_parameters;

#endif
