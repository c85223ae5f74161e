/* Variables of the controller, the C twin of interface.py. Up is positive. */
#ifndef SEAT_CONTROLLER_INTERFACE_H
#define SEAT_CONTROLLER_INTERFACE_H

#include <stdbool.h>

/* Type of all signals: compile with -DSEAT_CONTROLLER_REAL=float for single precision. */
#ifndef SEAT_CONTROLLER_REAL
#define SEAT_CONTROLLER_REAL double
#endif
typedef SEAT_CONTROLLER_REAL seat_controller_real;

/* Control laws. */
enum { SEAT_CONTROLLER_PUBLISHED = 1, SEAT_CONTROLLER_ROBUST };

/* What the law uses of the estimates. */
enum { ESTIMATOR_OFF = 1, ESTIMATOR_MONITOR, ESTIMATOR_FRICTION, ESTIMATOR_FRICTION_AND_MASS };

/* Faults, in the order of interface.py. */
enum {
    FAULT_NONE = 1,
    FAULT_ACCELERATION_INVALID,
    FAULT_ACCELERATION_RANGE,
    FAULT_ACCELERATION_FROZEN,
    FAULT_ACCELERATION_BIAS,
    FAULT_FORCE_BALANCE,
    FAULT_DEFLECTION_INVALID,
    FAULT_DEFLECTION_RANGE,
    FAULT_DEFLECTION_JUMP,
    FAULT_DEFLECTION_FROZEN,
};

/* Measurements of the two sensors. */
typedef struct {
    seat_controller_real seat_acceleration;     /* Y_2 = z_s'' in m/s2, up positive */
    seat_controller_real suspension_deflection; /* delta = z_s - z_v in m */
} seat_controller_inputs;

/* Outputs after the last sample. */
typedef struct {
    seat_controller_real force;                /* u_sat (6) in N, to the actuator, up positive */
    seat_controller_real force_demand;         /* u (24) in N */
    seat_controller_real motor_torque;         /* T (33) in N.m, radicand clamped at 0 */
    seat_controller_real disturbance_estimate; /* F_hat (21) in N */
    seat_controller_real deflection_rate;      /* v in m/s, filtered */
    bool saturated;                            /* whether the force is limited */
    int fault;                                 /* latched fault of the mode robust */
    seat_controller_real driver_mass_estimate; /* in kg */
    seat_controller_real friction_estimate;    /* in N */
    bool driver_mass_trusted;                  /* whether the rides since the start carry enough information */
    bool friction_trusted;
} seat_controller_outputs;

typedef struct {
    seat_controller_real driver_mass;          /* m_b in kg */
    bool anti_windup;                          /* feed the observer u_sat instead of u */
    bool enabled;                              /* false: u = F_hat = 0, the rate filter continues */
    seat_controller_real force_limit;          /* u_lim in N */
    seat_controller_real observer_gamma;       /* Gamma in s/kg2, below 0 */
    seat_controller_real L1, L2;               /* observer gains in kg/s; 0: from Gamma by (23) */
    seat_controller_real rate_filter_cutoff;   /* f_c in Hz */
    seat_controller_real seat_mass;            /* m_s in kg */
    seat_controller_real suspension_stiffness; /* k_f in N/m */
    seat_controller_real driver_mass_min;      /* m_bmin in kg */
    seat_controller_real driver_mass_max;      /* m_bmax in kg */
    seat_controller_real K1_deflection;        /* K_1 in N/m */
    seat_controller_real K1_rate;              /* K_1 in N.s/m */
    seat_controller_real K2_deflection;        /* K_2 in N/m */
    seat_controller_real K2_rate;              /* K_2 in N.s/m */
    seat_controller_real link_length;          /* L in m */
    seat_controller_real initial_height;       /* h_0 in m */
    seat_controller_real gear_ratio;           /* r_g */
    seat_controller_real sample_time;          /* h in s */
    /* of the mode robust alone, see robust.c */
    int mode;                                       /* control law */
    seat_controller_real actuator_time_constant;    /* T_a in s */
    seat_controller_real actuator_delay;            /* T_d in s */
    seat_controller_real travel;                    /* x_e in m, 0: no stops known */
    int robust_estimator;                           /* what the law uses of the estimates */
    seat_controller_real robust_cushion_stiffness;  /* k_c in N/m */
    seat_controller_real robust_cushion_damping;    /* c_c in N.s/m */
    seat_controller_real robust_observer_rate;      /* P in 1/s */
    seat_controller_real robust_motion_bandwidth;   /* f_m in Hz */
    seat_controller_real robust_friction;           /* F_r in N */
    seat_controller_real robust_friction_share;     /* mu */
    seat_controller_real robust_friction_rate;      /* v_0 in m/s */
    seat_controller_real robust_centring_frequency; /* f_0 in Hz */
    seat_controller_real robust_centring_damping;   /* zeta */
    seat_controller_real robust_centring_filter;    /* f_l in Hz */
    seat_controller_real robust_bias_rate;          /* gamma_b in 1/s3 */
    seat_controller_real robust_follow_begin;       /* x_0/x_e */
    seat_controller_real robust_follow_slope;       /* beta per share of travel */
    seat_controller_real robust_follow_max;         /* beta_m */
    seat_controller_real robust_envelope_frequency; /* f_w in Hz */
    seat_controller_real robust_envelope_decay;     /* d in 1/s */
    seat_controller_real robust_overload_begin;     /* x_2/x_e */
    seat_controller_real robust_overload_end;       /* x_3/x_e */
    seat_controller_real robust_overload_damping;   /* c_p in N.s/m */
    seat_controller_real robust_safe_damping;       /* c_s in N.s/m */
    seat_controller_real robust_ramp_time;          /* in s */
    seat_controller_real robust_acceleration_range; /* in m/s2 */
    seat_controller_real robust_deflection_range;   /* in m */
} seat_controller_parameters;

#endif
