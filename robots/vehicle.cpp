#include "robots/vehicle.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/elementary.h"
#include "robots/kinematics.h"

namespace sf::robots {

namespace {

constexpr double kHoldRate = 100.0;  // [rad/s] of a standing car on the hold of its tyres
constexpr double kContacts = 12.0;   // wheels and corners
constexpr double kResponse = 0.25;   // [s] in which the drive-line corrects speeds
// The drive pauses while a driven wheel spins faster than 1.5 times the wanted speed and 1 m/s, as at the limit of an
// engine's revolutions. Wheels with grip slip less.
constexpr double kMostSpin = 1.5;    // [-]
constexpr double kSpinMargin = 1.0;  // [m/s]

/// Returns the energy [J] of a spring whose force is bounded. @param most [N] >= 0
double stored(double stiffness, double compression, double most) {
  const double elastic = std::min(compression, most / stiffness);
  return 0.5 * stiffness * elastic * elastic + most * (compression - elastic);
}

}  // namespace

/// Layout of `state` in Dynamics::move.
struct Vehicle::State {
  glm::dvec3 v, w;
  std::array<double, kWheels> spin{};
  std::array<glm::dvec2, kWheels> hold{};
  double steer = 0.0;
  double forward = 0.0, turn = 0.0;  ///< Goal

  static State read(std::span<const double> numbers) {
    State state;
    std::memcpy(static_cast<void*>(&state), numbers.data(), sizeof state);
    return state;
  }
  void write(std::span<double> numbers) const { std::memcpy(numbers.data(), this, sizeof *this); }
};

Vehicle::Vehicle(const VehicleModel& model, const world::Mover& mover)
    : model_(model), max_acceleration_(mover.max_acceleration), max_turn_acceleration_(mover.max_turn_acceleration) {
  const CarModel& car = model_.car;
  centre_ = {0.5 * car.wheelbase() - car.front, 0.0, car.height};
  double farthest = 0.0;
  for (std::size_t k = 0; k < kWheels; ++k) {
    const bool front = k < kRearLeft;
    const double side = (k % 2 == 0 ? 0.5 : -0.5) * (front ? car.front_track : car.rear_track);
    Rest& rest = rest_[k];
    rest.p = {front ? car.front : -car.rear, side, -car.height};
    rest.load = 0.5 * (front ? car.front_load() : car.rear_load());
    rest.compression = rest.load / model_.spring;
    rest.drive = 0.5 * (front ? model_.drive_share : 1.0 - model_.drive_share);
    rest.brake = 0.5 * (front ? car.brake_share : 1.0 - car.brake_share);
    rest.lateral = front ? car.front_stiffness : car.rear_stiffness;
    farthest = std::max(farthest, rest.p.x * rest.p.x + side * side);
  }
  const double tilt_inertia = std::min(model_.roll_inertia, model_.pitch_inertia);
  contact_mass_ = 0.25 / (1.0 / car.mass + car.height * car.height / tilt_inertia + farthest / car.inertia);
  most_load_ = std::max(4.0 / kContacts * contact_mass_ / kVehicleStep, car.mass * kGravity);
  hold_ = 0.25 * car.mass * kHoldRate * kHoldRate;
  const Friction& f = car.friction;
  peak_ = f.at(base::log(f.c1 * f.c2 / f.c3) / f.c2);
}

std::size_t Vehicle::state_size() const { return sizeof(State) / sizeof(double); }

void Vehicle::place(const base::Report& at, std::span<double> state) const {
  const VehicleBody body = body_at(at);
  State{body.v, body.w, body.spin, {}, 0.0, at.velocity.forward, at.velocity.turn}.write(state);
}

void Vehicle::stop(const base::Report& at, std::span<double> state) const {
  State now = State::read(state);
  const VehicleBody stopped = body_at(at);
  now.v = {stopped.v.x, stopped.v.y, now.v.z};
  now.w.z = stopped.w.z;
  now.spin = stopped.spin, now.hold = {}, now.forward = at.velocity.forward, now.turn = at.velocity.turn;
  now.write(state);
}

base::Report Vehicle::move(const base::Report& from, const base::Twist& command, double seconds,
                           const world::Ground& ground, std::span<double> state) const {
  const double steps = std::max(1.0, std::ceil(seconds / kVehicleStep - 1e-9)), dt = seconds / steps;
  const State before = State::read(state);
  VehicleBody body = body_at(from);
  body.v = before.v, body.w = before.w, body.spin = before.spin, body.hold = before.hold, body.steer = before.steer;
  Goal goal{before.forward, before.turn};
  glm::dvec2 rolled{};
  for (double k = 0.0; k < steps; k += 1.0) {
    approach(goal, command, dt);
    step(body, controls_for(body, goal), dt, ground);
    rolled += dt * rims_of(body);
  }
  State{body.v, body.w, body.spin, body.hold, body.steer, goal.forward, goal.turn}.write(state);
  const base::Report after = report_of(body);
  base::Report report = from;
  report.X_WM = after.X_WM, report.tilt = after.tilt, report.velocity = after.velocity;
  report.wheels = {static_cast<float>(rolled.x / seconds), static_cast<float>(rolled.y / seconds)};
  return report;
}

double Vehicle::fastest_rim(const VehicleBody& body) const {
  double fastest = 0.0;
  for (std::size_t k = 0; k < kWheels; ++k)
    if (rest_[k].drive > 0.0) fastest = std::max(fastest, model_.car.wheel_radius * std::abs(body.spin[k]));
  return fastest;
}

// A rolling wheel's part along the axis is the way of the axle, however it is steered.
glm::dvec2 Vehicle::rims_of(const VehicleBody& body) const {
  const base::SinCos steer = base::sin_cos(body.steer);
  glm::dvec2 sum{};
  int axles = 0;
  for (const std::size_t left : {kFrontLeft, kRearLeft}) {
    if (rest_[left].drive == 0.0 && !model_.skid) continue;
    ++axles;
    for (const std::size_t side : {0u, 1u})
      sum[static_cast<int>(side)] += body.spin[left + side] * heading_of(left + side, steer).x;
  }
  return model_.car.wheel_radius / axles * sum;
}

VehicleBody Vehicle::body_at(const base::Report& at) const {
  const glm::dmat3 R = base::rotation_of(at.tilt.roll, at.tilt.pitch, at.X_WM.yaw);
  const glm::dvec3 centre = R * centre_;
  const WorldVelocity velocity = velocity_on_slope(at);
  VehicleBody body{.p = glm::dvec3{at.X_WM.x, at.X_WM.y, at.X_WM.z} + centre,
                   .q = base::quaternion_of(at.X_WM.yaw, at.tilt),
                   .v = velocity.linear,
                   .w = velocity.angular};
  body.v += glm::cross(body.w, centre);
  body.spin.fill(at.velocity.forward / model_.car.wheel_radius);
  return body;
}

base::Report Vehicle::report_of(const VehicleBody& body) const {
  const glm::dmat3 R = base::rotation_of(body.q);
  const glm::dvec3 centre = R * centre_;
  const base::TiltedPose pose = base::tilted_pose_of({R, body.p - centre});
  const glm::dvec3 v = body.v - glm::cross(body.w, centre), rates = glm::transpose(R) * body.w;
  const glm::dvec2 planar = base::rotate(-pose.X.yaw, {v.x, v.y});
  const auto [s, c] = base::sin_cos(pose.tilt.roll);
  const double level = base::cos(pose.tilt.pitch);
  const double turn = level > 0.01 ? (s * rates.y + c * rates.z) / level : body.w.z;
  return {.X_WM = pose.X, .velocity = {planar.x, planar.y, turn}, .tilt = pose.tilt};
}

void Vehicle::approach(Goal& goal, const base::Twist& command, double dt) const {
  const auto towards = [dt](double now, double wanted, double most) {
    return std::abs(wanted - now) <= most * dt ? wanted : now + std::copysign(most * dt, wanted - now);
  };
  const double before = goal.forward;
  goal.forward = towards(goal.forward, command.forward, max_acceleration_);
  goal.turn = towards(goal.turn, command.turn, max_turn_acceleration_);
  goal.rate = max_acceleration_ == HUGE_VAL ? 0.0 : (goal.forward - before) / dt;
}

VehicleControls Vehicle::controls_for(const VehicleBody& body, const Goal& goal) const {
  const CarModel& car = model_.car;
  const auto& [a, x, y, z] = body.q;
  const glm::dvec3 ahead{1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + a * z), 2.0 * (x * z - a * y)};
  const double r = car.wheel_radius, speed = glm::dot(body.v, ahead);
  VehicleControls controls{.steer = body.steer};
  const bool rests = goal.forward == 0.0 && std::abs(speed) < kHoldSpeed;
  if (model_.skid) {
    const double half = 0.5 * model_.turn_factor * car.front_track * goal.turn;
    for (std::size_t k = 0; k < kWheels; ++k) controls.spin[k] = (goal.forward + (k % 2 == 0 ? -half : half)) / r;
    if (rests && goal.turn == 0.0) controls.brake = car.brake_limit;
    return controls;
  }
  if (goal.forward != 0.0) controls.steer = base::atan(car.wheelbase() * goal.turn / goal.forward);
  if (rests) {
    controls.brake = car.brake_limit;
    return controls;
  }
  const double way = std::abs(speed) > kHoldSpeed ? speed : goal.forward;
  const double inertia = car.mass + 4.0 * car.wheel_inertia / (r * r), weight = car.mass * kGravity;
  const double force = inertia * (goal.rate + (goal.forward - speed) / kResponse) + car.drag * speed * std::abs(speed) +
                       weight * (ahead.z + std::copysign(car.rolling, way));
  if (force * way < 0.0) {
    controls.brake = std::min(std::abs(force) * r, car.brake_limit);
  } else if (fastest_rim(body) <= kMostSpin * std::abs(goal.forward) + kSpinMargin) {
    const double most = std::min(car.drive_limit, model_.power * r / std::max(std::abs(speed), kHoldSpeed));
    controls.drive = std::clamp(force * r, -most, most);
  }
  return controls;
}

double Vehicle::load(const VehicleBody& body, std::size_t wheel, const world::Ground& ground) const {
  return contact_of(body, base::rotation_of(body.q), wheel, ground).load;
}

double Vehicle::energy(const VehicleBody& body, const world::Ground& ground) const {
  const CarModel& car = model_.car;
  const glm::dmat3 R = base::rotation_of(body.q);
  const glm::dvec3 w = glm::transpose(R) * body.w, inertia{model_.roll_inertia, model_.pitch_inertia, car.inertia};
  double sum = car.mass * (kGravity * body.p.z + 0.5 * glm::dot(body.v, body.v)) + 0.5 * glm::dot(w, inertia * w);
  for (std::size_t k = 0; k < kWheels; ++k) {
    const Contact wheel = contact_of(body, R, k, ground);
    const double x = std::max(0.0, wheel.compression), most = most_load_ * glm::dot(R[2], wheel.normal);
    const double bump = std::max(0.0, x - rest_[k].compression - model_.travel);
    const double strut = std::min(most, model_.spring * (x - bump));
    sum += 0.5 * car.wheel_inertia * body.spin[k] * body.spin[k] + stored(model_.spring, x - bump, most) +
           strut * bump + stored((1.0 + kBumpStiffness) * model_.spring, bump, most - strut) +
           0.5 * hold_ * glm::dot(body.hold[k], body.hold[k]);
  }
  for (unsigned k = 0; k < kCorners; ++k) {
    const double depth = std::max(0.0, corner_of(body, R, k, ground).compression);
    sum += stored(kBumpStiffness * model_.spring, depth, most_load_);
  }
  return sum;
}

}  // namespace sf::robots
