#include "library/observations.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/error.h"

namespace sensorfarm {

using namespace sf;

namespace {

constexpr std::uint32_t kMostStacked = 1'000;
constexpr std::size_t kPieceOfAgents = 64;

/// Returns a number in [-1, 1]; 1 for NaN.
float in_unit(double value) {
  return value >= -1.0 && value <= 1.0 ? static_cast<float>(value) : value < 0.0 ? -1.0f : 1.0f;
}

double speed_limit(double limit) { return std::isfinite(limit) && limit > 1e-9 ? limit : 1.0; }

void check_options(const ObservationOptions& options) {
  if (options.every == 0) throw base::InputError("every is 0; expected at least 1");
  if (options.stack == 0 || options.stack > kMostStacked)
    throw base::InputError(fmt::format("stack is {}; expected from 1 to {}", options.stack, kMostStacked));
  if (!(options.goal_reach >= 0.0 && std::isfinite(options.goal_reach)))
    throw base::InputError(fmt::format("goal_reach is {:g} m; expected a positive length, or 0", options.goal_reach));
}

}  // namespace

Observations::State::State(const ObservationOptions& given, const world::World& world,
                           const sensors::SensorSet::Group& group)
    : options(given), worlds_(world.copies) {
  check_options(options);
  const std::vector<sensors::SensorSpec>& specs = group.rows;
  elements_ = (specs.front().elements + options.every - 1) / options.every;
  for (std::uint32_t i = 0; i < specs.size(); ++i) {
    if (specs[i].elements != specs.front().elements)
      throw base::InputError(fmt::format("sensors of type '{}' have {} and {} elements; expected equal numbers",
                                         group.type->name, specs.front().elements, specs[i].elements));
    limits.push_back(specs[i].limit > 0.0 ? specs[i].limit : 1.0);
    if (!rows.empty() && rows.back() == specs[i].mover) continue;
    const world::Mover& mover = world.movers[specs[i].mover];
    rows.push_back(specs[i].mover);
    agents.push_back({i, speed_limit(mover.max_forward), speed_limit(mover.max_turn), NAN, NAN});
  }
  sensors_ = specs.size() / rows.size();
  for (std::size_t k = 0; k < agents.size(); ++k)
    if (agents[k].sensor != k * sensors_ || specs.size() % rows.size() != 0)
      throw base::InputError(
          fmt::format("robots have different numbers of sensors of type '{}'; expected the same", group.type->name));
  newest = sensors_ * elements_ + (options.speeds ? 2 : 0) + (options.goal_reach > 0.0 ? 3 : 0);
  values.resize(rows.size() * columns());
  goals.assign(2 * rows.size(), NAN);
  distances.assign(rows.size(), NAN);
  progress.resize(rows.size());
  ages.resize(rows.size());
}

/// Writes the newest observation of an agent. Readings of several columns: the first.
void Observations::State::write(std::size_t agent) {
  const Agent& who = agents[agent];
  float* out = values.data() + agent * columns();
  const std::size_t step = options.every * now_.readings.columns;
  for (std::uint32_t sensor = who.sensor; sensor < who.sensor + sensors_; ++sensor) {
    const double* const from = now_.readings.values + sensor * now_.readings.stride;
    const double limit = limits[sensor];
    for (std::size_t i = 0; i < elements_; ++i) *out++ = in_unit(from[i * step] / limit);
  }
  const Twist& velocity = now_.velocities[rows[agent]];
  if (options.speeds) *out++ = in_unit(velocity.forward / who.forward), *out++ = in_unit(velocity.turn / who.turn);
  if (options.goal_reach <= 0.0) return;
  const Pose& X = now_.poses[rows[agent]];
  const double bearing = base::atan2(who.goal_y - X.y, who.goal_x - X.x) - X.yaw;
  const bool known = !std::isnan(distances[agent]);
  *out++ = in_unit(distances[agent] / options.goal_reach);
  *out++ = known ? static_cast<float>(base::cos(bearing)) : 0.0f;
  *out++ = known ? static_cast<float>(base::sin(bearing)) : 0.0f;
  out[-3] = known ? out[-3] : 1.0f;
}

/// Computes the distance of the agent's goal. @param moved whether progress counts since the last call
void Observations::State::measure(std::size_t agent, bool moved) {
  Agent& who = agents[agent];
  const double x = goals[2 * agent], y = goals[2 * agent + 1];
  const bool same = x == who.goal_x && y == who.goal_y;
  const Pose& X = now_.poses[rows[agent]];
  const double before = distances[agent];
  distances[agent] = base::hypot(x - X.x, y - X.y);
  const double nearer = before - distances[agent];
  progress[agent] = moved && same && !std::isnan(nearer) ? nearer : 0.0;
  who.goal_x = x, who.goal_y = y;
}

void Observations::State::shift(std::size_t agent) {
  float* const first = values.data() + agent * columns();
  std::copy_backward(first, first + columns() - newest, first + columns());
}

void Observations::State::fill(std::size_t agent) {
  float* const first = values.data() + agent * columns();
  for (std::uint32_t k = 1; k < options.stack; ++k) std::copy_n(first, newest, first + k * newest);
}

void Observations::State::step(const library::ObservedStep& now, base::ThreadPool& thread_pool) {
  now_ = now;
  thread_pool.parallel_for(rows.size(), kPieceOfAgents, [this](std::size_t first, std::size_t end, unsigned) {
    for (std::size_t agent = first; agent < end; ++agent) {
      ++ages[agent];
      measure(agent, true);
      if (options.stack > 1) shift(agent);
      write(agent);
    }
  });
}

void Observations::State::restart(const library::ObservedStep& now, std::span<const std::uint32_t> worlds) {
  now_ = now;
  const std::size_t of_world = rows.size() / worlds_;
  for (const std::uint32_t world : worlds)
    for (std::size_t agent = world * of_world; agent < (world + 1) * of_world; ++agent) {
      ages[agent] = 0;
      measure(agent, false);
      write(agent);
      fill(agent);
    }
}

void Observations::State::update() {
  for (std::size_t agent = 0; agent < rows.size(); ++agent) {
    measure(agent, false);
    write(agent);
    if (ages[agent] == 0) fill(agent);
  }
}

Observations::Observations(std::shared_ptr<State> state) : state_(std::move(state)) {}
std::size_t Observations::agents() const { return state_->rows.size(); }
std::size_t Observations::columns() const { return state_->columns(); }
std::span<const float> Observations::values() const { return state_->values; }
std::span<const std::uint32_t> Observations::rows() const { return state_->rows; }
std::span<double> Observations::goals() const { return state_->goals; }
std::span<const double> Observations::distances() const { return state_->distances; }
std::span<const double> Observations::progress() const { return state_->progress; }
std::span<const std::uint32_t> Observations::ages() const { return state_->ages; }
void Observations::update() { state_->update(); }

}  // namespace sensorfarm
