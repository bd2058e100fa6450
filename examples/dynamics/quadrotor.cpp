// A quadrotor: an actuator model as a plug-in. It keeps a height above the ground, and tilts to follow commands.
//
//   cmake -B build -DCMAKE_PREFIX_PATH=PREFIX && cmake --build build
//   sensorfarm run quadrotor.world --duration 20
//
// A rigid body under one thrust along its z axis. An attitude controller (proportional and derivative) turns the body
// to the tilt whose thrust accelerates it as wanted, and drag slows it down. Walls stop it at the heights of its body.

#include <sensorfarm/plugin.h>

#include <cmath>

namespace {

constexpr double kGravity = 9.81;  // [m/s^2]
constexpr double kStep = 2e-3;     // [s]

/// The state besides the pose. It is all doubles, so that it fits into the farm's.
struct State {
  double v[3];      // [m/s] in the world frame
  double rates[3];  // [rad/s] of roll, pitch and yaw
};

class Quadrotor : public sensorfarm::Dynamics {
 public:
  Quadrotor(const sensorfarm::DynamicsSite&, sensorfarm::Settings& settings)
      : height_(settings.number("height", 1.5, 0.0, 1e3)),
        most_tilt_(settings.number("tilt", 0.5, 0.01, 1.0)),
        drag_(settings.number("drag", 0.3, 0.0, 10.0)) {}

  std::size_t state_size() const override { return sizeof(State) / sizeof(double); }

  void place(const sensorfarm::BodyState& at, std::span<double> state) const override {
    const double s = std::sin(at.pose.yaw), c = std::cos(at.pose.yaw);
    write({{c * at.velocity.forward - s * at.velocity.left, s * at.velocity.forward + c * at.velocity.left, 0.0},
           {0.0, 0.0, at.velocity.turn}},
          state);
  }

  sensorfarm::BodyState move(const sensorfarm::BodyState& from, const sensorfarm::Twist& command, double seconds,
                             const sensorfarm::Ground& ground, std::span<double> state) const override {
    sensorfarm::BodyState body = from;
    State now = read(state);
    const double steps = std::ceil(seconds / kStep);
    for (double k = 0.0; k < steps; ++k) step(body, now, command, seconds / steps, ground);
    write(now, state);
    const double s = std::sin(body.pose.yaw), c = std::cos(body.pose.yaw);
    body.velocity = {c * now.v[0] + s * now.v[1], c * now.v[1] - s * now.v[0], now.rates[2]};
    return body;
  }

 private:
  static State read(std::span<const double> n) { return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}}; }
  static void write(const State& now, std::span<double> n) {
    for (int k = 0; k < 3; ++k) n[k] = now.v[k], n[k + 3] = now.rates[k];
  }
  static double within(double value, double most) { return std::fmax(-most, std::fmin(most, value)); }

  void step(sensorfarm::BodyState& body, State& now, const sensorfarm::Twist& command, double dt,
            const sensorfarm::Ground& ground) const {
    const double s = std::sin(body.pose.yaw), c = std::cos(body.pose.yaw);
    const double forward = c * now.v[0] + s * now.v[1], left = c * now.v[1] - s * now.v[0];
    const double below = ground.height(body.pose.x, body.pose.y, body.pose.z + 0.1);

    // Tilt for the wanted acceleration, and thrust for the height.
    const double pitch =
        within(std::atan((2.0 * (command.forward - forward) + drag_ * forward) / kGravity), most_tilt_);
    const double roll = within(-std::atan((2.0 * (command.left - left) + drag_ * left) / kGravity), most_tilt_);
    const double rise = within(4.0 * (below + height_ - body.pose.z) - 4.0 * now.v[2], 5.0);
    const double upright = std::cos(body.roll) * std::cos(body.pitch);
    const double thrust = (kGravity + rise) / std::fmax(0.3, upright);

    // Attitude.
    now.rates[0] += dt * (100.0 * (roll - body.roll) - 16.0 * now.rates[0]);
    now.rates[1] += dt * (100.0 * (pitch - body.pitch) - 16.0 * now.rates[1]);
    now.rates[2] += dt * 5.0 * (command.turn - now.rates[2]);
    body.roll += dt * now.rates[0], body.pitch += dt * now.rates[1], body.pose.yaw += dt * now.rates[2];

    // The z axis of Rz(yaw) Ry(pitch) Rx(roll) in the frame of the heading.
    const double ahead = std::sin(body.pitch) * std::cos(body.roll), aside = -std::sin(body.roll);
    const double push[] = {c * ahead - s * aside, s * ahead + c * aside, upright};
    double* const p[] = {&body.pose.x, &body.pose.y, &body.pose.z};
    for (int k = 0; k < 3; ++k) {
      now.v[k] += dt * (thrust * push[k] - drag_ * now.v[k] - (k == 2 ? kGravity : 0.0));
      *p[k] += dt * now.v[k];
    }
    if (body.pose.z < below) body.pose.z = below, now.v[2] = std::fmax(0.0, now.v[2]);
  }

  double height_;     // [m] above the ground
  double most_tilt_;  // [rad]
  double drag_;       // [1/s]
};

}  // namespace

SENSORFARM_PLUGIN(plugin) { plugin.add_dynamics<Quadrotor>("quadrotor", "flies at a height above the ground"); }
