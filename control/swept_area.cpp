#include "control/swept_area.h"

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/time.h"
#include "robots/kinematics.h"
#include "robots/motion_limits.h"
#include "sensors/laser.h"
#include "sensors/sonar.h"
#include "world/wall_tree.h"

namespace sf::control {

namespace {

constexpr double kMargin = 0.03;                               // [m] from the outline
constexpr double kStep = 0.05;                                 // [s] of the predicted motion
constexpr double kHold = 0.15;                                 // [s] until the next command takes effect
constexpr double kLongest = 2.0;                               // [s] of the predicted motion
constexpr double kApart = 0.03;                                // [m] between kept echoes
constexpr std::int64_t kScanKept = 8 * base::kSecond;          // laser echoes
constexpr std::int64_t kSonarKept = base::kSecond * 35 / 100;  // a little longer than a firing cycle
constexpr int kPointsOfCone = 3, kDiscsOfRobot = 3;

}  // namespace

SweptArea::SweptArea(const ControllerContext& context)
    : mover_(context.world.movers[context.mover]),
      outline_(robots::footprint_of(mover_)),
      lasers_(context.sensors_of(sensors::kLaser)),
      sonars_(context),
      reach_(0.3 + mover_.max_forward * (kHold + 0.5 * mover_.max_forward / mover_.max_acceleration)) {}

void SweptArea::update(const ControllerInput& input) {
  X_WM_ = input.state.X_WM;
  const double far = outline_.radius + reach_;
  std::erase_if(echoes_, [&](const Echo& o) {
    return o.kept < input.time || glm::length(o.p - glm::dvec2{X_WM_.x, X_WM_.y}) > far;
  });
  add_robots(input);
  for (const base::ReadingBlock& reading : input.readings) {
    if (reading.type == sensors::kLaser && reading.sensor < lasers_.size()) add_scan(reading);
    if (const auto source = sonars_.source_of(reading)) add_echoes(*source, reading);
  }
}

// Replaces the older echoes that the beams have passed, so that an obstacle that moved leaves nothing behind.
void SweptArea::add_scan(const base::ReadingBlock& reading) {
  const sensors::SensorSpec& laser = lasers_[reading.sensor];
  if (reading.values.size() != laser.elements || laser.elements < 2) return;
  const double between = laser.fov / (laser.elements - 1);
  std::erase_if(echoes_, [&](const Echo& o) {
    const glm::dvec2 d = o.p - glm::dvec2{reading.X_WS.x, reading.X_WS.y};
    const double beam = (base::wrap_angle(base::atan2(d.y, d.x) - reading.X_WS.yaw) + 0.5 * laser.fov) / between;
    if (!(beam >= 0.0) || beam > laser.elements - 1 || o.time >= reading.time) return false;
    return reading.values[static_cast<std::size_t>(std::lround(beam))] > glm::length(d) + kApart;
  });
  for (std::uint32_t i = 0; i < laser.elements; ++i) {
    const double range = reading.values[i];
    if (!(range < laser.limit)) continue;
    const glm::dvec2 p = base::transform(reading.X_WS, range * base::rotate(sensors::bearing_of(laser, i), {1.0, 0.0}));
    add(p, reading.time, reading.time + kScanKept);
  }
}

// An echo may come from anywhere on its arc.
void SweptArea::add_echoes(const Sonars::Source& source, const base::ReadingBlock& reading) {
  const sensors::ConeArray& sonar = source.sonar;
  for (std::size_t i = 0; i < std::min(sonar.X_SC.size(), reading.values.size()); ++i) {
    if (!(reading.values[i] < sonar.range_max)) continue;
    const base::Pose X_WC = base::compose(source.X_WS, sonar.X_SC[i]);
    for (int k = 0; k < kPointsOfCone; ++k) {
      const double bearing = sonar.fov * (static_cast<double>(k) / (kPointsOfCone - 1) - 0.5);
      add(base::transform(X_WC, reading.values[i] * base::rotate(bearing, {1.0, 0.0})), reading.time,
          reading.time + kSonarKept);
    }
  }
}

// Another robot drives on until its next command, and then brakes.
void SweptArea::add_robots(const ControllerInput& input) {
  robots_.clear();
  for (const Neighbour& other : input.others) {
    const double v = other.state.velocity.forward;
    const double way = v * (kHold + 0.5 * std::abs(v) / mover_.max_acceleration);
    for (int k = 0; k < kDiscsOfRobot; ++k)
      robots_.push_back(base::transform(other.state.X_WM, {way * k / (kDiscsOfRobot - 1), 0.0}));
  }
}

// Other robots are known by V2V: their echoes are left out, since they move.
void SweptArea::add(glm::dvec2 p, std::int64_t time, std::int64_t kept) {
  if (!(glm::length(p - glm::dvec2{X_WM_.x, X_WM_.y}) <= outline_.radius + reach_)) return;
  for (const glm::dvec2& robot : robots_)
    if (glm::length(p - robot) < outline_.radius) return;
  for (Echo& echo : echoes_) {
    if (glm::length(echo.p - p) > 0.5 * kApart) continue;
    if (kept >= echo.kept) echo = {p, time, kept};
    return;
  }
  echoes_.push_back({p, time, kept});
}

// Negative within another robot's disc.
double SweptArea::clearance(const base::Pose& X_WM, double most) const {
  const base::Pose X_MW = base::inverse(X_WM);
  double least = most;
  const auto add_disc = [&](glm::dvec2 middle, double radius) {
    const glm::dvec2 p = base::transform(X_MW, middle);
    if (glm::length(p) - outline_.radius - radius >= least) return;
    for (const robots::FootprintEdge& edge : outline_.edges)
      least = std::min(least, world::distance(p, edge.a, edge.b) - radius);
  };
  for (const Echo& echo : echoes_) add_disc(echo.p, 0.0);
  for (const glm::dvec2& robot : robots_) add_disc(robot, outline_.radius);
  return least;
}

bool SweptArea::free(const base::Report& state, const base::Twist& command) const {
  base::Twist v = state.velocity;
  base::Pose X_WM = state.X_WM;
  double last = clearance(state.X_WM, reach_);
  for (double t = 0.0; t < kLongest; t += kStep) {
    const base::Twist wanted = t < kHold ? robots::limit_kinematics(mover_, command) : base::Twist{};
    v = robots::limit_acceleration(mover_, v, wanted, kStep);
    if (t >= kHold && v.forward == 0.0 && v.turn == 0.0) return true;
    X_WM = robots::advance(X_WM, v, kStep);
    const double margin = kMargin + kFastest * t;
    const double now = clearance(X_WM, reach_);
    if (now < std::min(margin, last - 1e-6)) return false;
    last = std::min(last, now);
  }
  return true;
}

base::Twist SweptArea::limit(const base::Report& state, const base::Twist& wanted, double turn, double creep) const {
  const base::Twist choices[] = {wanted,
                                 {0.5 * wanted.forward, 0.0, 0.5 * wanted.turn},
                                 {0.25 * wanted.forward, 0.0, 0.25 * wanted.turn},
                                 {0.0, 0.0, turn},
                                 {0.0, 0.0, -turn},
                                 {-creep, 0.0, 0.0},
                                 {creep, 0.0, 0.0}};
  for (const base::Twist& choice : choices)
    if (free(state, choice)) return choice;
  return {};
}

std::optional<SweptArea> read_swept_area(const ControllerContext& context, Settings& settings) {
  const bool sees_behind = !context.sensors_of(sensors::kSonar).empty();
  return settings.flag("check_sweep", sees_behind) ? std::make_optional<SweptArea>(context) : std::nullopt;
}

}  // namespace sf::control
