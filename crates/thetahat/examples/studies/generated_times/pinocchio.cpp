// Times of Pinocchio's algorithms on a robot, ns a call: `pinocchio < joints`, where each joint of a chain is a line of its rotation (row by
// row) and origin in the frame before, and of mass, first moments and inertia (xx, xy, yy, xz, yz, zz) about its own origin.
//
// Prints the torques of a state first, for comparison, then inverse dynamics, mass matrix, forward dynamics and regressor.
#include <pinocchio/fwd.hpp>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/regressor.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/multibody.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <string>

// As of the generated code.
static const int ROUNDS = 500, CALLS = 1000;

template <typename Call> static void print_least(Call call) {
    double best = INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        const auto start = std::chrono::steady_clock::now();
        for (int k = 0; k < CALLS; k++) call(k);
        const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
        best = std::min(best, time.count() / CALLS);
    }
    std::printf("%.17g\n", best);
}

static pinocchio::Model read_model() {
    pinocchio::Model model;
    model.gravity.linear() = Eigen::Vector3d(0.0, 0.0, -9.81);
    pinocchio::JointIndex joint = 0;
    double numbers[22];
    for (int count = 0;; count++) {
        for (double &number : numbers)
            if (!(std::cin >> number)) return model;
        const Eigen::Matrix3d rotation = Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers);
        const pinocchio::SE3 placement(rotation, Eigen::Map<Eigen::Vector3d>(numbers + 9));
        joint = model.addJoint(joint, pinocchio::JointModelRZ(), placement, "joint_" + std::to_string(count));
        const Eigen::Matrix<double, 10, 1> parameters = Eigen::Map<Eigen::Matrix<double, 10, 1>>(numbers + 12);
        model.inertias[joint] = pinocchio::Inertia::FromDynamicParameters(parameters);
    }
}

int main() {
    const pinocchio::Model model = read_model();
    pinocchio::Data data(model);
    Eigen::VectorXd q(model.nq), v(model.nv), a(model.nv), tau(model.nv);
    for (int k = 0; k < model.nq; k++) q[k] = v[k] = a[k] = (k * 37 % 101) / 50.0 - 1.0;
    tau = pinocchio::rnea(model, data, q, v, a);
    for (double torque : tau) std::printf("%.17g\n", torque);
    volatile double sink = 0.0;
    const auto move = [&](int k) { q[k % model.nq] += 1e-9; };
    print_least([&](int k) { pinocchio::rnea(model, data, q, v, a), sink += data.tau[0], move(k); });
    print_least([&](int k) { pinocchio::crba(model, data, q, pinocchio::Convention::LOCAL), sink += data.M(0, 0), move(k); });
    print_least([&](int k) { pinocchio::aba(model, data, q, v, tau, pinocchio::Convention::LOCAL), sink += data.ddq[0], move(k); });
    print_least([&](int k) { pinocchio::computeJointTorqueRegressor(model, data, q, v, a), sink += data.jointTorqueRegressor(0, 0), move(k); });
}
