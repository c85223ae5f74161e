/* Variables of the seat, the C twin of interface.py. Up is positive. */
#ifndef SEAT_INTERFACE_H
#define SEAT_INTERFACE_H

typedef struct {
    double floor_displacement, floor_velocity, floor_acceleration; /* z_v in m, z_v' in m/s, z_v'' in m/s2 */
    double force;                                                  /* u_sat in N, on the seat */
    double driver_force;                                           /* of an external driver on the seat, in N */
} seat_plant_inputs;

typedef struct {
    double seat_acceleration;                                          /* z_s'' in m/s2 */
    double suspension_deflection, deflection_rate;                     /* z_s - z_v in m, its rate in m/s */
    double driver_acceleration;                                        /* z_b'' in m/s2 */
    double seat_displacement, driver_displacement;                     /* z_s, z_b in m */
    double friction_force;                                             /* f_r (35) in N, acts on the seat as -f_r */
    double seat_acceleration_measured, suspension_deflection_measured; /* in m/s2, m */
    double floor_force;                                                /* of the seat on the floor, in N */
    double seat_velocity;                                              /* z_s' in m/s */
    double head_acceleration; /* of a seated driver, else that of the driver, in m/s2 */
} seat_plant_outputs;

/* Floor inputs that are used; the others are derived from them. */
enum { SEAT_PLANT_ALL = 1, SEAT_PLANT_DISPLACEMENT = 2, SEAT_PLANT_VELOCITY = 3, SEAT_PLANT_ACCELERATION = 4 };

/* Drivers: one mass on the cushion, a seated body of four masses, outside behind a force. */
enum { SEAT_PLANT_LUMPED = 1, SEAT_PLANT_SEATED = 2, SEAT_PLANT_EXTERNAL = 3 };

typedef struct {
    double driver_mass, seat_mass;                                         /* m_b, m_s in kg */
    double suspension_stiffness, suspension_damping;                       /* k_f in N/m, c_f in N.s/m */
    double cushion_stiffness, cushion_damping;                             /* k_c in N/m, c_c in N.s/m */
    double friction_alpha;                                                 /* alpha in N/m */
    double friction_gamma, friction_beta;                                  /* gamma_d, beta_d in 1/m2 */
    double friction_amplitude;                                             /* A_d */
    int floor_signals;                                                     /* used floor inputs */
    double actuator_force_limit;                                           /* u_max in N, 0 for none */
    double actuator_delay, actuator_time_constant;                         /* T_d, T_a in s */
    double sensor_bandwidth;                                               /* f_s in Hz, 0 for none */
    double acceleration_noise, acceleration_bias, acceleration_resolution; /* in m/s2 */
    double deflection_noise, deflection_bias, deflection_resolution;       /* in m */
    int sensor_seed;
    double end_stop_travel;                      /* x_e in m, 0 for none */
    double end_stop_stiffness, end_stop_damping; /* k_e in N/m, c_e in N.s/m */
    double end_stop_height;                      /* x_m in m, of static equilibrium above the middle */
    int driver_model;                            /* who sits on the seat */
    double contact_stiffness, contact_damping;   /* k_4 in N/m, c_4 in N.s/m, of a seated driver */
} seat_plant_parameters;

#endif
