#include "robots/estimation/team_state.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/elementary.h"

namespace sf::estimation {

namespace {

constexpr double kRestRate = 1e-8;        // [m^2/s], [rad^2/s] noise of a robot at rest
constexpr double kUnknownPlace = 0.1;     // [m^2/s] noise of a robot whose speeds are unknown
constexpr double kUnknownYaw = 1.0;       // [rad^2/s]
constexpr double kUnmapped = 100.0;       // [m^2] variance of a landmark before its first sighting
constexpr double kShortestRepeat = 0.05;  // [s]
constexpr double kNearest = 0.05;         // [m] sightings from nearer have no direction
constexpr double kLeastYawVariance = 1e-8;

using RobotVector = Eigen::Matrix<double, kTeamComponents, 1>;
using RobotMatrix = Eigen::Matrix<double, kTeamComponents, kTeamComponents>;

Eigen::Map<Eigen::VectorXd> mean_of(TeamState& state) {
  return {state.mean.data(), static_cast<Eigen::Index>(state.mean.size())};
}
Eigen::Map<const Eigen::VectorXd> mean_of(const TeamState& state) {
  return {state.mean.data(), static_cast<Eigen::Index>(state.mean.size())};
}
Eigen::Map<Eigen::MatrixXd> covariance_of(TeamState& state) {
  const auto size = static_cast<Eigen::Index>(state.mean.size());
  return {state.covariance.data(), size, size};
}
Eigen::Index first_of(std::uint32_t robot) { return kTeamComponents * static_cast<Eigen::Index>(robot); }

double squared_number(double v) { return v * v; }
double seconds(std::int64_t from, std::int64_t to) { return 1e-9 * static_cast<double>(to - from); }

/// Applies a motion to one robot's components.
void carry(const TeamMotion& moved, Eigen::Index first, TeamState& state) {
  auto P = covariance_of(state);
  const Eigen::Map<const RobotMatrix> F(moved.derivative.data()), Q(moved.noise.data());
  P.middleRows<kTeamComponents>(first) = F * P.middleRows<kTeamComponents>(first).eval();
  P.middleCols<kTeamComponents>(first) = P.middleCols<kTeamComponents>(first).eval() * F.transpose();
  P.block<kTeamComponents, kTeamComponents>(first, first) += Q;
  std::copy(moved.mean.begin(), moved.mean.end(), state.mean.begin() + first);
}

/// Adds a stretch of constant speeds, driven along its chord.
void drive_evenly(const TeamModel& model, const Speeds& speeds, double dt, TeamMotion& all) {
  Eigen::Map<RobotVector> m(all.mean.data());
  const double v = speeds.forward, w = speeds.turn, distance = std::abs(v) * dt, angle = std::abs(w) * dt;
  const bool moves = v != 0.0 || w != 0.0;
  const double kept = moves ? base::exp(-dt / model.turn_drift[1]) : 1.0;
  const double step = m(kSpeedScale) * v * dt, turned = (m(kTurnScale) * w + (moves ? m(kTurnDrift) : 0.0)) * dt;
  const auto [s, c] = base::sin_cos(m(kTeamYaw) + 0.5 * turned);

  RobotMatrix F = RobotMatrix::Identity();
  const Eigen::Vector2d along(c, s), across(-s, c);
  F.block<2, 1>(kTeamX, kTeamYaw) = step * across;
  F.block<2, 1>(kTeamX, kSpeedScale) = v * dt * along;
  F.block<2, 1>(kTeamX, kTurnScale) = 0.5 * w * dt * step * across;
  F(kTeamYaw, kTurnScale) = w * dt;
  if (moves) F(kTeamYaw, kTurnDrift) = dt;
  F(kTurnDrift, kTurnDrift) = kept;
  m.head<2>() += step * along;
  m(kTeamYaw) += turned;
  m(kTurnDrift) *= kept;

  const double pivot = squared_number(model.pivot) * angle + kRestRate * dt;
  Eigen::Map<RobotMatrix> Q(all.noise.data()), derivative(all.derivative.data());
  Q = (F * Q * F.transpose()).eval();
  Q.topLeftCorner<2, 2>() += (squared_number(model.along) * distance + pivot) * along * along.transpose() +
                             (squared_number(model.across) * distance + pivot) * across * across.transpose();
  Q(kTeamYaw, kTeamYaw) +=
      squared_number(model.yaw_per_metre) * distance + squared_number(model.yaw_per_radian) * angle + kRestRate * dt;
  for (const int k : {kSpeedScale, kTurnScale})
    if (moves) Q(k, k) += squared_number(model.scale_drift) * dt;
  Q(kTurnDrift, kTurnDrift) += squared_number(model.turn_drift[0]) * (1.0 - squared_number(kept));
  derivative = (F * derivative).eval();
}

/// Adds the error of the time at which the speeds changed.
void change(const TeamModel& model, const Speeds& from, const Speeds& to, TeamMotion& all) {
  const auto [s, c] = base::sin_cos(all.mean[kTeamYaw]);
  Eigen::Map<RobotMatrix> Q(all.noise.data());
  const Eigen::Vector2d along(c, s);
  Q.topLeftCorner<2, 2>() += squared_number(model.jitter * (to.forward - from.forward)) * along * along.transpose();
  Q(kTeamYaw, kTeamYaw) += squared_number(model.jitter * (to.turn - from.turn));
}

/// Adds a stretch with the speeds held since `speeds.time`, or with unknown ones if that is too long ago.
void hold(const TeamModel& model, const Speeds& speeds, std::int64_t begin, std::int64_t end, TeamMotion& all) {
  const std::int64_t until = speeds.time + static_cast<std::int64_t>(1e9 * model.hold);
  const std::int64_t known = std::clamp(until, begin, end);
  if (known > begin) drive_evenly(model, speeds, seconds(begin, known), all);
  const double dt = seconds(known, end);
  if (dt <= 0.0) return;
  drive_evenly(model, {}, dt, all);
  Eigen::Map<RobotMatrix> Q(all.noise.data());
  Q.diagonal().head<2>().array() += kUnknownPlace * dt;
  Q(kTeamYaw, kTeamYaw) += kUnknownYaw * dt;
}

Eigen::Index landmark_component(const Team& team, std::size_t landmark) {
  const auto unknown =
      std::count(team.landmarks.begin(), team.landmarks.begin() + static_cast<std::ptrdiff_t>(landmark),
                 std::optional<glm::dvec2>());
  return first_of(team.robots) + 2 * unknown;
}

/// Position of a target: fixed, or two components of the state.
struct Target {
  Eigen::Vector2d p;
  Eigen::Index component = -1;  ///< -1: fixed
};

Target target_of(const Team& team, const TeamEvent& event, const TeamState& state) {
  if (event.target < team.robots) {
    const Eigen::Index at = first_of(event.target);
    return {mean_of(state).segment<2>(at), at};
  }
  const std::size_t landmark = event.target - team.robots;
  if (const auto& p = team.landmarks[landmark]) return {{p->x, p->y}, -1};
  const Eigen::Index at = landmark_component(team, landmark);
  return {mean_of(state).segment<2>(at), at};
}

/// Places an unmapped landmark where it is seen; its variance remains that of an unknown position.
void map_landmark(const Team& team, const TeamEvent& event, TeamState& state) {
  if (event.target < team.robots || state.mapped[event.target - team.robots] != 0) return;
  const auto robot = mean_of(state).segment<kTeamComponents>(first_of(event.robot));
  const double direction = robot(kTeamYaw) + event.values[1] - robot(kBearingOffset);
  mean_of(state).segment<2>(landmark_component(team, event.target - team.robots)) =
      robot.head<2>() + event.values[0] * Eigen::Vector2d(base::cos(direction), base::sin(direction));
  state.mapped[event.target - team.robots] = 1;
}

const Speeds& speeds_at(std::span<const Speeds> speeds, std::int64_t time) {
  static constexpr Speeds kRest{};
  const auto after = std::upper_bound(speeds.begin(), speeds.end(), time,
                                      [](std::int64_t t, const Speeds& each) { return t < each.time; });
  return after == speeds.begin() ? kRest : *(after - 1);
}

/// Variances of range and bearing.
Eigen::Vector2d noise_of(const TeamModel& model, double range, double turn, double since_last) {
  const Eigen::Vector2d noise(squared_number(model.range_noise) + squared_number(model.range_noise_share * range),
                              squared_number(model.bearing_noise) + squared_number(model.target_size / range) +
                                  squared_number(model.turn_blur * turn));
  if (since_last < 0.0 || model.repeat <= 0.0) return noise;
  const double gap = std::max(since_last, kShortestRepeat);
  return noise * (1.0 + model.repeat / gap * base::exp(-gap / model.repeat));
}

TeamResult sight(const Team& team, const TeamEvent& event, double turn, TeamState& state) {
  map_landmark(team, event, state);
  const TeamModel& model = team.model;
  const Eigen::Index at = first_of(event.robot);
  const Target target = target_of(team, event, state);
  const Eigen::Vector2d d = target.p - mean_of(state).segment<2>(at);
  const double range = d.norm();
  if (!(range >= kNearest)) return {};

  const Eigen::Vector2d z(event.values[0] - (1.0 + model.range_scale) * range,
                          base::wrap_angle(event.values[1] - base::atan2(d.y(), d.x()) + mean_of(state)(at + kTeamYaw) -
                                           mean_of(state)(at + kBearingOffset)));
  Eigen::Matrix2d slope;  // of range and bearing by the target's position
  slope.row(0) = (1.0 + model.range_scale) / range * d.transpose();
  slope.row(1) = Eigen::RowVector2d(-d.y(), d.x()) / squared_number(range);
  Eigen::Matrix<double, 2, kTeamComponents> H = Eigen::Matrix<double, 2, kTeamComponents>::Zero();
  H.leftCols<2>() = -slope;
  H(1, kTeamYaw) = -1.0;
  H(1, kBearingOffset) = 1.0;

  auto P = covariance_of(state);
  Eigen::MatrixX2d PH = P.middleCols<kTeamComponents>(at) * H.transpose();
  if (target.component >= 0) PH += P.middleCols<2>(target.component) * slope.transpose();
  Eigen::Matrix2d S = H * PH.middleRows<kTeamComponents>(at);
  if (target.component >= 0) S += slope * PH.middleRows<2>(target.component);

  std::int64_t& last = state.robots[event.robot].last_seen[event.target];
  const Eigen::Vector2d noise = noise_of(model, range, turn, last < 0 ? -1.0 : seconds(last, event.time));
  Eigen::Matrix2d all = S;
  all.diagonal() += noise;
  const double squared = z.dot(all.inverse() * z);
  if (!(squared <= model.outlier)) return {TeamUse::outlier, squared};
  last = event.time;
  const double weight = std::min(1.0, (model.freedom + 2.0) / (model.freedom + squared));
  all = S;
  all.diagonal() += noise / weight;
  const Eigen::MatrixX2d K = PH * all.inverse();
  mean_of(state) += K * z;
  P -= K * PH.transpose();
  P = (0.5 * (P + P.transpose())).eval();
  return {TeamUse::used, squared};
}

void place(const Team& team, const TeamEvent& event, TeamState& state) {
  TeamState::Robot& robot = state.robots[event.robot];
  const Eigen::Index at = first_of(event.robot);
  const TeamModel& model = team.model;
  auto P = covariance_of(state);
  const auto set = [&](Eigen::Index k, double mean, double variance) {
    P.row(k).setZero();
    P.col(k).setZero();
    P(k, k) = variance;
    mean_of(state)(k) = mean;
  };
  for (int k = 0; k < 3; ++k) set(at + k, event.values[static_cast<std::size_t>(k)], 0.0);
  const auto& c = event.covariance;
  P.block<3, 3>(at, at) << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  if (robot.time < 0) {
    set(at + kSpeedScale, model.speed_scale[0], squared_number(model.speed_scale[1]));
    set(at + kTurnScale, model.turn_scale[0], squared_number(model.turn_scale[1]));
    set(at + kBearingOffset, 0.0, squared_number(model.bearing_offset));
    set(at + kTurnDrift, 0.0, squared_number(model.turn_drift[0]));
  }
  robot.time = event.time;
}

}  // namespace

TeamState first_state(const Team& team) {
  const auto unknown = std::count(team.landmarks.begin(), team.landmarks.end(), std::optional<glm::dvec2>());
  const Eigen::Index size = first_of(team.robots) + 2 * unknown;
  TeamState state;
  state.robots.assign(team.robots, {-1, std::vector<std::int64_t>(team.robots + team.landmarks.size(), -1)});
  for (const auto& landmark : team.landmarks) state.mapped.push_back(landmark ? 1 : 0);
  state.mean.assign(static_cast<std::size_t>(size), 0.0);
  state.covariance.assign(static_cast<std::size_t>(size * size), 0.0);
  covariance_of(state).diagonal().tail(2 * unknown).setConstant(kUnmapped);
  return state;
}

TeamMotion TeamMotion::from(const TeamState& state, std::uint32_t robot) {
  TeamMotion all;
  std::copy_n(state.mean.begin() + first_of(robot), kSize, all.mean.begin());
  for (std::size_t k = 0; k < kSize; ++k) all.derivative[k * (kSize + 1)] = 1.0;
  return all;
}

void drive(const TeamModel& model, std::int64_t begin, std::int64_t end, std::span<const Speeds> speeds,
           TeamMotion& all) {
  const auto later = [](std::int64_t t, const Speeds& each) { return t < each.time; };
  auto next = std::upper_bound(speeds.begin(), speeds.end(), begin, later);
  Speeds held{.time = end};  // before the first speeds: at rest
  if (next != speeds.begin()) held = *(next - 1);
  for (std::int64_t at = begin; at < end;) {
    const std::int64_t until = next == speeds.end() ? end : std::min(end, next->time);
    hold(model, held, at, until, all);
    at = until;
    for (; next != speeds.end() && next->time <= at; ++next) {
      change(model, held, *next, all);
      held = *next;
    }
  }
}

void advance(const Team& team, std::uint32_t robot, std::int64_t time, std::span<const Speeds> speeds,
             TeamState& state) {
  std::int64_t& own = state.robots[robot].time;
  if (own < 0 || time <= own) return;
  const Eigen::Index at = first_of(robot);
  TeamMotion moved = TeamMotion::from(state, robot);
  drive(team.model, own, time, speeds, moved);
  carry(moved, at, state);
  own = time;
}

TeamResult apply(const Team& team, const TeamEvent& event, std::span<const std::vector<Speeds>> speeds,
                 TeamState& state) {
  const bool is_start = event.kind == TeamEvent::Kind::pose;
  const auto started = [&](std::uint32_t robot) { return state.robots[robot].time >= 0; };
  if (event.robot >= team.robots || (!is_start && !started(event.robot))) return {};
  advance(team, event.robot, event.time, speeds[event.robot], state);
  TeamResult result{TeamUse::used};
  if (is_start) place(team, event, state);
  if (event.kind == TeamEvent::Kind::sighting) {
    if (event.target >= team.robots + team.landmarks.size() || event.target == event.robot) return {};
    if (event.target < team.robots && !started(event.target)) return {};
    if (event.target < team.robots) advance(team, event.target, event.time, speeds[event.target], state);
    result = sight(team, event, speeds_at(speeds[event.robot], event.time).turn, state);
  }
  state.event = event.time;
  return result;
}

Estimate estimate_after(const Team& team, const TeamState& state, std::uint32_t robot, const TeamMotion& moved,
                        std::int64_t time) {
  const auto size = static_cast<Eigen::Index>(state.mean.size());
  const Eigen::Map<const Eigen::MatrixXd> all(state.covariance.data(), size, size);
  const Eigen::Map<const RobotMatrix> F(moved.derivative.data()), Q(moved.noise.data());
  const Eigen::Index at = first_of(robot);
  const RobotMatrix P = F * all.block<kTeamComponents, kTeamComponents>(at, at) * F.transpose() + Q;
  const auto& m = moved.mean;
  Estimate estimate{.time = time, .X_WM = {m[kTeamX], m[kTeamY], 0.0, base::wrap_angle(m[kTeamYaw])}};
  Eigen::Map<Eigen::Matrix<double, kComponents, kComponents, Eigen::RowMajor>> full(estimate.covariance.data());
  full.topLeftCorner<3, 3>() = 0.5 * (P.topLeftCorner<3, 3>() + P.topLeftCorner<3, 3>().transpose());
  full.diagonal().head<2>().array() += squared_number(team.model.place_error);
  full(kYaw, kYaw) += squared_number(team.model.yaw_error) + kLeastYawVariance;
  return estimate;
}

TeamEvent start_event(std::uint32_t robot, std::int64_t time, const base::Pose& X_WM,
                      const PoseCovariance& covariance) {
  return {time, TeamEvent::Kind::pose, robot, 0, {X_WM.x, X_WM.y, X_WM.yaw}, covariance};
}

TeamEvent sighting_event(const TeamModel& model, std::uint32_t robot, std::int64_t time, std::uint32_t target,
                         double range, double bearing) {
  const auto exposed = time - std::llround(1e9 * model.exposure);
  return {exposed, TeamEvent::Kind::sighting, robot, target, {range, bearing, 0.0}, {}};
}

Speeds effective_speeds(const TeamModel& model, std::int64_t time, double forward, double turn) {
  return {time + std::llround(1e9 * model.delay), forward, turn};
}

}  // namespace sf::estimation
