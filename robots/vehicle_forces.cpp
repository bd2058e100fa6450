// Forces on a car, and its step.

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "robots/vehicle.h"

namespace sf::robots {

namespace {

constexpr double kHoldFade = 0.05;   // [s] in which the hold of a rolling tyre vanishes
constexpr double kMotorSlack = 0.2;  // [rad/s] by which a skid drive's motor at full torque lags
constexpr double kSill = 0.3;        // [-] height of the body's lower corners, in that of the box
constexpr double kUpright = 0.99;    // [-] cosine of a tilt
constexpr double kCornerFriction = 0.6;
constexpr int kRounds = 5;
constexpr double kSameGap = 1e-6;  // [m]
constexpr double kOutward = 1.0;   // [m/s] at which deep contacts push out of the ground at most

glm::dvec3 normal_of(const world::GroundPoint& ground) {
  if (ground.slope == glm::dvec2{}) return {0.0, 0.0, 1.0};
  return glm::normalize(glm::dvec3{-ground.slope.x, -ground.slope.y, 1.0});
}

}  // namespace

/// Limits the load of a contact [N], so that an overlap with an edge of the ground, or with the ground where a car is
/// placed, does not throw it. Each contact bears at least the weight of the car at rest. Takes energy only.
/// @param closing [m/s] along the normal
double Vehicle::bounded(double load, double closing) const {
  return std::min(load, most_load_ * std::max(0.0, 1.0 + closing / kOutward));
}

Vehicle::Contact Vehicle::contact_of(const VehicleBody& body, const glm::dmat3& R, std::size_t wheel,
                                     const world::Ground& ground, double dt) const {
  const Rest& rest = rest_[wheel];
  const glm::dvec3 arm = R * rest.p, up = R[2], at = body.p + arm;
  const double radius = model_.car.wheel_radius;
  Contact contact{.p = arm, .normal = up};
  // Where the strut meets the plane of the ground below its end, and then that below this point, within its reach: what
  // is beyond may be the ground of another place.
  double gap = 0.0, before = HUGE_VAL;
  world::GroundPoint below;
  for (int round = 0; round < (ground.is_flat() ? 1 : kRounds) && std::abs(gap - before) > kSameGap; ++round) {
    before = gap;
    gap = std::clamp(gap, -rest.compression - model_.travel - radius, rest.compression);
    const glm::dvec3 end = at - gap * up;
    below = ground.contact(end, {body.p.x, body.p.y}, std::max(at.z - end.z, 0.0) + 0.5 * radius, radius);
    const double rise = up.z - up.x * below.slope.x - up.y * below.slope.y;
    if (rise <= 0.0 || rise * rise < kLeastSlant * kLeastSlant * (1.0 + glm::dot(below.slope, below.slope)))
      return contact;
    gap += (end.z - below.z) / rise;
  }
  contact.normal = normal_of(below);
  const double slant = glm::dot(up, contact.normal);
  contact.p = arm - gap * up;
  contact.compression = rest.compression - gap;
  contact.rate = -glm::dot(body.v + glm::cross(body.w, contact.p), contact.normal) / slant;
  const double next = contact.compression + dt * contact.rate;
  if (next <= 0.0) return contact;
  const double bump = std::max(0.0, next - rest.compression - model_.travel);
  const double closing = contact.rate * slant;
  const double stop = bounded((1.0 + kBumpStiffness) * model_.spring * bump / slant, closing);
  const double strut = (model_.spring * (next - bump) + model_.damper * contact.rate) / slant;
  contact.load = bounded(std::max(0.0, strut + stop), std::max(0.0, closing));
  return contact;
}

/// Returns the rate of a tyre's deflection [m/s]. @param slip [m/s] of the tyre on the ground
glm::dvec2 Vehicle::hold_rate(const Tyre& t, glm::dvec2 hold, glm::dvec2 slip) {
  return t.hold * slip - (1.0 - t.hold) / kHoldFade * hold;
}

/// Returns the direction of a wheel in the plane of the body.
glm::dvec2 Vehicle::heading_of(std::size_t wheel, const base::SinCos& steer) const {
  if (wheel >= kRearLeft) return {1.0, 0.0};
  const double length = model_.car.wheelbase();
  return glm::normalize(glm::dvec2{length * steer.cos - rest_[wheel].p.y * steer.sin, length * steer.sin});
}

Vehicle::Tyre Vehicle::tyre_of(const VehicleBody& body, const glm::dmat3& R, std::size_t wheel,
                               const glm::dvec2& heading, const Contact& contact, double dt) const {
  const CarModel& car = model_.car;
  const Rest& rest = rest_[wheel];
  const glm::dvec3 ahead = heading.x * R[0] + heading.y * R[1], n = contact.normal;
  Tyre t;
  t.x = glm::normalize(ahead - glm::dot(ahead, n) * n), t.y = glm::cross(n, t.x);
  const glm::dvec3 v = body.v + glm::cross(body.w, contact.p);
  // The wheel's middle, not the body's point on the ground, moves it forward.
  t.pitching = glm::dot(body.w, t.y);
  t.forward = glm::dot(v, t.x) + car.wheel_radius * t.pitching, t.left = glm::dot(v, t.y);
  t.rim = car.wheel_radius * body.spin[wheel];

  // Viscosities that are stable in a step.
  const double grip = contact.load * std::max(0.1, 1.0 - car.load_loss * (contact.load / rest.load - 1.0));
  const double reference = std::max({std::abs(t.rim), std::abs(t.forward), kLeastSlipSpeed});
  const double slip = glm::length(glm::dvec2{t.rim - t.forward, rest.lateral * t.left}) / reference;
  const double viscosity = grip * (slip < 1e-9 ? car.friction.slope() : car.friction.at(slip) / slip) / reference;
  const double most = 0.5 * contact_mass_ / dt;
  t.along = std::min(viscosity, most), t.across = std::min(rest.lateral * viscosity, most);
  t.most = peak_ * grip;
  t.hold = std::max(0.0, 1.0 - std::max({std::abs(t.rim), std::abs(t.forward), std::abs(t.left)}) / kHoldSpeed);
  return t;
}

/// Returns the force of the hold after a step [N]. Where it exceeds what friction leaves, the tyre slips.
glm::dvec2 Vehicle::hold_of(const Tyre& t, glm::dvec2& deflection, double dt) const {
  glm::dvec2 held = deflection + dt * hold_rate(t, deflection, {t.rim - t.forward, -t.left});
  const double left = t.most - glm::length(glm::dvec2{t.along * (t.rim - t.forward), t.across * t.left});
  if (const double force = hold_ * glm::length(held); force > left) {
    const double part = std::max(0.0, left) / force;
    held *= part, deflection *= part;
  }
  return t.hold * hold_ * held;
}

/// Returns the spin of a wheel after a step, with friction and motors implicit. @param hold [N] along
double Vehicle::spin_after(const Tyre& t, std::size_t wheel, const VehicleControls& controls, double spin, double load,
                           double hold, double dt) const {
  const CarModel& car = model_.car;
  const double r = car.wheel_radius, inertia = car.wheel_inertia / dt;
  const double motor = 0.25 * car.drive_limit, gain = model_.skid ? motor / kMotorSlack : 0.0;
  const double push = inertia * spin + r * (t.along * t.forward - hold) + controls.drive * rest_[wheel].drive;
  const double wanted = controls.spin[wheel] + t.pitching;  // motors turn with the body
  double drag = inertia + r * r * t.along, next = (push + gain * wanted) / (drag + gain);
  if (const double torque = gain * (wanted - next); std::abs(torque) > motor) {
    next = (push + std::copysign(motor, torque)) / drag;
  } else {
    drag += gain;
  }
  const double friction = controls.brake * rest_[wheel].brake + car.rolling * load * r, turns = next - t.pitching;
  return t.pitching + std::copysign(std::max(0.0, std::abs(turns) - friction / drag), turns);
}

/// Adds the forces of a wheel, and changes its spin.
Vehicle::Tyre Vehicle::add_wheel(VehicleBody& body, const glm::dmat3& R, std::size_t wheel,
                                 const VehicleControls& controls, const glm::dvec2& heading, const Contact& contact,
                                 double dt, Wrench& sum) const {
  const CarModel& car = model_.car;
  const Tyre t = tyre_of(body, R, wheel, heading, contact, dt);
  const glm::dvec2 hold = hold_of(t, body.hold[wheel], dt);
  const double spin = spin_after(t, wheel, controls, body.spin[wheel], contact.load, hold.x, dt);
  glm::dvec2 grip{t.along * (car.wheel_radius * spin - t.forward) + hold.x, hold.y - t.across * t.left};
  if (const double size = glm::length(grip); size > t.most) grip *= t.most / size;
  const glm::dvec3 force = contact.load * contact.normal + grip.x * t.x + grip.y * t.y;
  sum.force += force;
  sum.torque += glm::cross(contact.p, force) - car.wheel_inertia / dt * (spin - body.spin[wheel]) * t.y;
  body.spin[wheel] = spin;
  return t;
}

/// Returns whether corners of the body may be on the ground: any height may be next to the wheels but on the floor.
bool Vehicle::lies(const VehicleBody& body, const glm::dmat3& R, const world::Ground& ground) const {
  if (!ground.is_flat()) return true;
  const glm::dvec3& box = model_.box;
  const glm::dvec3 sill = R * (glm::dvec3{0.0, 0.0, kSill * box.z} - centre_);
  const double height = std::min(0.0, (1.0 - kSill) * box.z * R[2].z);
  const double lowest = body.p.z + sill.z + height - std::abs(R[0].z) * box.x - std::abs(R[1].z) * box.y;
  return lowest < 0.5 * kSill * box.z;
}

Vehicle::Contact Vehicle::corner_of(const VehicleBody& body, const glm::dmat3& R, unsigned corner,
                                    const world::Ground& ground, double dt) const {
  const glm::dvec3& box = model_.box;
  const glm::dvec3 place{(corner & 1) != 0 ? box.x : -box.x, (corner & 2) != 0 ? box.y : -box.y,
                         (corner & 4) != 0 ? box.z : kSill * box.z};
  Contact contact{.p = R * (place - centre_)};
  const glm::dvec3 at = body.p + contact.p;
  const world::GroundPoint below = ground.contact(at, {body.p.x, body.p.y}, 0.5 * model_.car.wheel_radius);
  const glm::dvec3 v = body.v + glm::cross(body.w, contact.p), up{-below.slope.x, -below.slope.y, 1.0};
  if (below.z - at.z <= dt * glm::dot(v, up)) return contact;
  contact.normal = normal_of(below);
  contact.compression = (below.z - at.z) * contact.normal.z;
  contact.rate = -glm::dot(v, contact.normal);
  const double next = contact.compression + dt * contact.rate;
  const double push = kBumpStiffness * model_.spring * next + 4.0 * model_.damper * contact.rate;
  contact.load = bounded(std::max(0.0, push), contact.rate);
  return contact;
}

void Vehicle::add_corners(const VehicleBody& body, const glm::dmat3& R, const world::Ground& ground, double dt,
                          Wrench& sum) const {
  // In an upright car, the corners of the roof touch nothing but cliffs.
  for (unsigned k = 0; k < (R[2].z > kUpright ? kCorners / 2 : kCorners); ++k) {
    const Contact corner = corner_of(body, R, k, ground, dt);
    if (corner.load == 0.0) continue;
    const glm::dvec3 v = body.v + glm::cross(body.w, corner.p);
    const glm::dvec3 across = v - glm::dot(v, corner.normal) * corner.normal;
    const double viscosity =
        std::min(0.5 * contact_mass_ / dt, kCornerFriction * corner.load / (glm::length(across) + 1e-9));
    const glm::dvec3 force = corner.load * corner.normal - viscosity * across;
    sum.force += force;
    sum.torque += glm::cross(corner.p, force);
  }
}

void Vehicle::step(VehicleBody& body, const VehicleControls& controls, double dt, const world::Ground& ground) const {
  const CarModel& car = model_.car;
  const double steer = std::clamp(controls.steer, -car.steer_limit, car.steer_limit);
  body.steer += dt * std::clamp((steer - body.steer) / std::max(car.steer_lag, dt), -car.steer_rate, car.steer_rate);
  const base::SinCos steered = base::sin_cos(body.steer);

  const glm::dmat3 R = base::rotation_of(body.q);
  Wrench sum{glm::dvec3{0.0, 0.0, -car.mass * kGravity} - car.drag * glm::length(body.v) * body.v, {}};
  std::array<Contact, kWheels> contacts;
  for (std::size_t k = 0; k < kWheels; ++k) contacts[k] = contact_of(body, R, k, ground, dt);
  std::array<Tyre, kWheels> tyres;
  for (std::size_t k = 0; k < kWheels; ++k)
    tyres[k] = add_wheel(body, R, k, controls, heading_of(k, steered), contacts[k], dt, sum);
  if (lies(body, R, ground)) add_corners(body, R, ground, dt, sum);

  const glm::dvec3 inertia{model_.roll_inertia, model_.pitch_inertia, car.inertia};
  const glm::dvec3 w = glm::transpose(R) * body.w, torque = glm::transpose(R) * sum.torque;
  // Gyroscopic torques do no work.
  glm::dvec3 turned = w - dt * (glm::cross(w, inertia * w) / inertia);
  if (const double now = glm::dot(turned, inertia * turned); now > 0.0)
    turned *= std::sqrt(glm::dot(w, inertia * w) / now);
  body.w = R * (turned + dt * (torque / inertia));
  body.v += dt / car.mass * sum.force;
  body.p += dt * body.v;
  for (std::size_t k = 0; k < kWheels; ++k) {
    const glm::dvec3 &x = tyres[k].x, &y = tyres[k].y;
    const glm::dvec3 v = body.v + glm::cross(body.w, contacts[k].p);
    const double rim = car.wheel_radius * (body.spin[k] - glm::dot(body.w, y));
    body.hold[k] += dt * hold_rate(tyres[k], body.hold[k], {rim - glm::dot(v, x), -glm::dot(v, y)});
  }
  const glm::dvec3 h = 0.5 * dt * body.w;
  const auto [a, x, y, z] = body.q;
  body.q = {a - h.x * x - h.y * y - h.z * z, x + h.x * a + h.y * z - h.z * y, y + h.y * a + h.z * x - h.x * z,
            z + h.z * a + h.x * y - h.y * x};
  const auto& q = body.q;
  const double norm = 1.0 / std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  body.q = {norm * q.w, norm * q.x, norm * q.y, norm * q.z};
}

}  // namespace sf::robots
