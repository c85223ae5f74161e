/* Variables of the seated driver, the C twin of interface.py. Up is positive. */
#ifndef DRIVER_INTERFACE_H
#define DRIVER_INTERFACE_H

typedef struct {
    double seat_displacement, seat_velocity, seat_acceleration; /* z_s in m, z_s' in m/s, z_s'' in m/s2 */
} seated_driver_inputs;

typedef struct {
    double contact_force;                          /* of the driver on the seat, in N */
    double driver_acceleration, head_acceleration; /* of pelvis and thighs, of head and neck, in m/s2 */
    double driver_displacement, head_displacement; /* of the same, in m */
} seated_driver_outputs;

typedef struct {
    double driver_mass;                        /* m_b in kg, on the seat */
    double contact_stiffness, contact_damping; /* k_4 in N/m, c_4 in N.s/m, of the published body */
} seated_driver_parameters;

#endif
