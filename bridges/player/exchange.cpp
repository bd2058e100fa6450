#include "bridges/player/exchange.h"

#include <utility>

#include "sensors/encoder.h"

namespace sf::bridges::player {

Exchange::Exchange(const Scene& scene, const Devices& devices)
    : scene_(scene), devices_(devices), readings_(devices.slots()), users_(devices.slots()) {
  begin();
  for (std::uint32_t mover = 0; mover < scene.world.movers.size(); ++mover)
    reports_.push_back({.mover = mover, .X_WM = scene.world.movers[mover].X_WM});
  contacts_.resize(reports_.size());
}

/// Resets to the start of a run: odometry at 0, no requests.
void Exchange::begin() {
  robots_.assign(scene_.world.movers.size(), {});
  for (std::uint32_t mover = 0; mover < robots_.size(); ++mover) {
    const auto encoders = scene_.sensor_set.settings_of<sensors::Encoder>(sensors::kEncoder, mover);
    if (encoders.empty()) continue;
    robots_[mover].odometry = Odometry(encoders.front().track);
    robots_[mover].encoder = devices_.slot_of(sensors::kEncoder, mover, 0);
  }
}

void Exchange::publish(const base::TickRecord& tick, const RunState& state) {
  const std::lock_guard lock(mutex_);
  set_state(state);
  time_ = tick.time;
  is_new_ = true;
  reports_.assign(tick.reports.begin(), tick.reports.end());
  contacts_.assign(tick.contacts.begin(), tick.contacts.end());
  contacts_.resize(reports_.size());  // a service has no contacts
  for (const base::ReadingBlock& reading : tick.readings) {
    const std::uint32_t slot = devices_.slot_of(reading.type, reading.mover, reading.sensor);
    if (slot == robots_[reading.mover].encoder) robots_[reading.mover].odometry.roll(reading);
    if (users_[slot] == 0) continue;
    LastReading& last = readings_[slot];
    last.time = reading.time, last.sequence = reading.sequence, last.height = reading.X_WS.z;
    last.values.assign(reading.values.begin(), reading.values.end());
    if (!std::exchange(last.is_new, true)) new_.push_back(slot);
  }
  for (std::uint32_t mover = 0; mover < robots_.size(); ++mover) update(robots_[mover], mover);
}

void Exchange::update(Robot& robot, std::uint32_t mover) {
  const base::Pose& X_WM = reports_[mover].X_WM;
  if (base::is_absent(X_WM)) return;
  robot.odometry.move(X_WM);
  if (robot.placed) robot.placement.reset();
  if (robot.goal) robot.command = steer(scene_.world.movers[mover], robot.odometry.pose(), *robot.goal);
}

void Exchange::publish(const RunState& state) {
  const std::lock_guard lock(mutex_);
  set_state(state);
}

void Exchange::set_state(const RunState& state) {
  if (state.runs != state_.runs) begin();
  state_ = state;
}

void Exchange::take(Requests& requests) {
  const std::lock_guard lock(mutex_);
  for (std::uint32_t mover = 0; mover < robots_.size(); ++mover) {
    Robot& robot = robots_[mover];
    if (robot.placement && !std::exchange(robot.placed, true))
      requests.placements.push_back({mover, *robot.placement, reports_[mover].tilt});
    if (robot.command) requests.commands.push_back({mover, *robot.command});
    robot.command.reset();
  }
  if (pause_) requests.paused = std::exchange(pause_, std::nullopt);
  requests.reset = std::exchange(reset_, false) || requests.reset;
}

void Exchange::use(std::uint32_t slot, bool used) {
  const std::lock_guard lock(mutex_);
  users_[slot] += used ? 1 : -1;
}

void Exchange::look(Snapshot& snapshot) {
  const std::lock_guard lock(mutex_);
  snapshot.is_new = std::exchange(is_new_, false);
  for (LastReading& reading : snapshot.readings) reading.is_new = false;
  if (!snapshot.is_new) return;
  snapshot.time = time_;
  snapshot.reports = reports_;
  snapshot.contacts = contacts_;
  snapshot.odometry.clear();
  for (const Robot& robot : robots_) snapshot.odometry.push_back(robot.odometry.pose());
  snapshot.readings.resize(readings_.size());
  for (const std::uint32_t slot : new_) {
    std::swap(snapshot.readings[slot], readings_[slot]);
    readings_[slot].is_new = false;
  }
  new_.clear();
}

base::Pose Exchange::pose_of(std::uint32_t mover) {
  const std::lock_guard lock(mutex_);
  return robots_[mover].placement.value_or(reports_[mover].X_WM);
}

double Exchange::seconds() {
  const std::lock_guard lock(mutex_);
  return 1e-9 * static_cast<double>(time_);
}

void Exchange::drive(std::uint32_t mover, const base::Twist& twist) {
  const std::lock_guard lock(mutex_);
  Robot& robot = robots_[mover];
  robot.goal.reset();
  if (!robot.motors) return;
  robot.driven = true;
  robot.command = twist;
}

void Exchange::drive(std::uint32_t mover, const Goal& goal) {
  const std::lock_guard lock(mutex_);
  Robot& robot = robots_[mover];
  if (!robot.motors) return;
  robot.driven = true;
  robot.goal = goal;
}

void Exchange::stop(std::uint32_t mover) {
  const std::lock_guard lock(mutex_);
  Robot& robot = robots_[mover];
  robot.goal.reset();
  if (std::exchange(robot.driven, false)) robot.command = base::Twist{};
}

void Exchange::set_motors(std::uint32_t mover, bool on) {
  const std::lock_guard lock(mutex_);
  Robot& robot = robots_[mover];
  if (std::exchange(robot.motors, on) == on || on) return;
  robot.goal.reset();
  robot.command = base::Twist{};
}

void Exchange::set_odometry(std::uint32_t mover, const base::Pose& X_OM) {
  const std::lock_guard lock(mutex_);
  robots_[mover].odometry.set(X_OM);
}

void Exchange::place(std::uint32_t mover, const base::Pose& X_WM) {
  const std::lock_guard lock(mutex_);
  robots_[mover].placement = X_WM;
  robots_[mover].placed = false;
}

void Exchange::toggle_pause() {
  const std::lock_guard lock(mutex_);
  pause_ = !pause_.value_or(state_.paused);
}

void Exchange::reset() {
  const std::lock_guard lock(mutex_);
  reset_ = true;
}

}  // namespace sf::bridges::player
