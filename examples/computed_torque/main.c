/*
 * A computed-torque loop of robots/two_joint.toml at 1 kHz, on generated code alone.
 *
 * The controller has the inverse dynamics of the robot with its a-priori parameters. The plant has its direct dynamics,
 * integrated by the classical Runge-Kutta method with friction that is smooth at rest. Both start 0.1 rad beside a smooth
 * reference: the error decays as the gains say. README.md says how to generate, compile and run it.
 */
#include <math.h>
#include <stdio.h>

#define THETAHAT_SIGN(x) tanh((x) / 0.02)
#include "idm.h"
#include "ddm.h"

enum { N = 2, STEPS = 4000 };

/* Poles of the error: s^2 + 2 w s + w^2, w in rad/s. */
static const double W = 20.0;
static const double STEP_S = 0.001;

/* A reference of each joint: position, velocity and acceleration at a time in s. */
static void reference(double t, double q[N], double dq[N], double ddq[N]) {
    static const double amplitude[N] = {0.8, 0.6}, frequency[N] = {2.0, 3.0};
    for (int j = 0; j < N; j++) {
        const double a = amplitude[j], w = frequency[j];
        q[j] = a * sin(w * t);
        dq[j] = a * w * cos(w * t);
        ddq[j] = -a * w * w * sin(w * t);
    }
}

/* Torques that make the error decay: inverse dynamics of the reference's acceleration, corrected by the error. */
static void control(double t, const double q[N], const double dq[N], double tau[N]) {
    double q_ref[N], dq_ref[N], ddq[N];
    reference(t, q_ref, dq_ref, ddq);
    for (int j = 0; j < N; j++) {
        ddq[j] += 2.0 * W * (dq_ref[j] - dq[j]) + W * W * (q_ref[j] - q[j]);
    }
    arm_inverse_dynamics(q, dq, ddq, tau);
}

/* Derivatives of the state, positions and then velocities, with torques that are held. */
static void plant(const double x[2 * N], const double tau[N], double dx[2 * N]) {
    for (int j = 0; j < N; j++) {
        dx[j] = x[N + j];
    }
    arm_forward_dynamics(x, x + N, tau, dx + N);
}

static void integrate(double x[2 * N], const double tau[N]) {
    static const double place[4] = {0.0, 0.5, 0.5, 1.0}, weight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
    double k[2 * N] = {0.0}, next[2 * N];
    for (int i = 0; i < 2 * N; i++) {
        next[i] = x[i];
    }
    for (int stage = 0; stage < 4; stage++) {
        double at[2 * N];
        for (int i = 0; i < 2 * N; i++) {
            at[i] = x[i] + place[stage] * STEP_S * k[i];
        }
        plant(at, tau, k);
        for (int i = 0; i < 2 * N; i++) {
            next[i] += weight[stage] * STEP_S * k[i];
        }
    }
    for (int i = 0; i < 2 * N; i++) {
        x[i] = next[i];
    }
}

int main(void) {
    double x[2 * N], q[N], dq[N], ddq[N], tau[N], last = 0.0;
    reference(0.0, x, x + N, ddq);
    x[0] += 0.1;
    x[1] -= 0.1;
    for (int step = 0; step <= STEPS; step++) {
        const double t = step * STEP_S;
        reference(t, q, dq, ddq);
        last = fmax(fabs(q[0] - x[0]), fabs(q[1] - x[1]));
        if (step % 500 == 0) {
            printf("t %.1f s: largest error %.2e rad\n", t, last);
        }
        control(t, x, x + N, tau);
        integrate(x, tau);
    }
    /* The torques are held over each step: what is left of the error is of the order of the step. */
    return last < 2e-4 ? 0 : 1;
}
