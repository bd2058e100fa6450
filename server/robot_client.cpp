#include "server/robot_client.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/elapsed.h"
#include "base/elementary.h"
#include "base/error.h"
#include "base/time.h"
#include "control/own_dynamics.h"
#include "control/stop_reason.h"
#include "world/roads/roads.h"

namespace sf::server {

namespace {

/// [ns] At least two and a half periods of the fastest sensor, so that a single lost reading does not stop a robot.
std::int64_t patience_of(const sensors::SensorSet& sensor_set, std::uint32_t mover, double seconds) {
  double fastest = 0.0;
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : sensor_set.of(group.type->id, mover)) fastest = std::max(fastest, row.rate);
  return seconds > 0.0 && fastest > 0.0 ? base::nanoseconds(std::max(seconds, 2.5 / fastest)) : 0;
}

constexpr std::int64_t kOwnReadingValid = 500'000'000;  ///< [ns] age of the real robot's readings to drive by

std::uint32_t tag_of(const RobotClientOptions& options, const world::Mover& mover) {
  const std::uint32_t tag = options.tag > 0 ? options.tag : mover.id;
  if (tag >= netio::kMinTag && tag <= netio::kMaxId) return tag;
  throw base::InputError(
      fmt::format("{} has the id {}, which no tag has; expected the id of its tag (robot --tag), from {} to {}",
                  mover.name, mover.id, netio::kMinTag, netio::kMaxId));
}

/// Returns the sensors by which the robot localizes itself. A real robot has its wheels, with the constants of the
/// world file, if it states them.
control::PositionSensors position_sensors_of(const world::Mover& mover, const RealRobot* real) {
  control::PositionSensors own = control::position_sensors_of(mover);
  if (real == nullptr) return own;
  if (!own.wheels) own.wheels = sensors::Encoder{.slip = real->type().slip, .track = mover.track};
  own.wheels->per_count = real->type().distance;
  own.wheels->angle_step = real->type().angle;
  return {.wheels = own.wheels, .gyro = {}, .gps = {}};
}

[[noreturn]] void refuse_localize(const world::Mover& mover) {
  throw base::InputError(fmt::format(
      "'localize' estimates a robot's state from its own sensors, and '{}' has none; expected encoder( ... ) in its "
      "definition, --cameras, --serial or --player",
      mover.name));
}

LinkOptions link_options_of(const RobotClientOptions& options, std::span<const Intersection> intersections) {
  LinkOptions link = options.link;
  for (const Intersection& one : intersections) link.lights.push_back(one.id);
  if (link.direct) link.direct->log_descriptor = options.log_descriptor;
  return link;
}

/// [ms] since 1970
std::int64_t utc_now() { return base::unix_time() / 1'000'000; }

}  // namespace

RobotClient::RobotClient(const world::World& world, const sensors::SensorSet& sensor_set, std::uint32_t mover,
                         const StreamLayout& sent, const RobotClientOptions& options)
    : world_(world),
      sensor_set_(sensor_set),
      names_(wire_names(world)),
      mover_(mover),
      body_(world, mover, base::nanoseconds(options.forget)),
      roads_(world::roads_of(world)),
      lights_(world, roads_ ? &*roads_ : nullptr, {.spat = options.spat}),
      lanes_(roads_ ? &*roads_ : nullptr),
      link_(world, sensor_set, mover, sent, link_options_of(options, lights_.intersections()),
            [this](const netio::Packet& packet, std::int64_t now) { on_packet(packet, now); }),
      intents_(world.movers.size()),
      started_(!options.wait_for_start),
      log_(world.movers[mover].name, world.movers[mover].id, options.log_descriptor,
           patience_of(sensor_set, mover, options.stop_after)),
      controller_(options.controller.name),
      utc_(options.utc ? options.utc : utc_now),
      shares_readings_(options.shares_readings) {
  if (auto dynamics = control::make_own_dynamics(world, mover)) body_.set_dynamics(std::move(dynamics));
  if (options.truth) truth_.emplace(*options.truth, tag_of(options, world.movers[mover]));
  if (options.map) map_.emplace(world, sensor_set, mover, *options.map);
  if (options.real) real_ = make_real_robot(*options.real, world.movers[mover].X_WM, world.movers[mover].track);
  control::ControllerConfig controller = options.controller;
  controller.localized_outside = true;
  made_ = control::make_controller({world, mover, options.seed, roads_ ? &*roads_ : nullptr, nullptr, &sensor_set},
                                   controller);
  needs_ = options.stop_without_farm ? control::Controller::kNeedsFarm : made_.controller->needs();
  remote_ = control::remote_of(*made_.controller);
  link_.set_follows_drive(remote_ != nullptr);
  add_own_state(options);
  add_team();
}

/// A robot with cameras or encoders of its own does not know its true state, unless the setting `localize` is false.
void RobotClient::add_own_state(const RobotClientOptions& options) {
  const world::Mover& mover = world_.movers[mover_];
  OwnStateOptions own{.stop_after = base::nanoseconds(options.stop_after),
                      .most_sigma = options.most_sigma.value_or(options.cameras ? 0.5 : HUGE_VAL)};
  if (options.cameras) {
    own.cameras = options.cameras;
    own.cameras->tag = tag_of(options, mover);
  } else {
    own.start = mover.X_WM;
  }
  if (made_.localize.value_or(true)) own.sensors = position_sensors_of(mover, real_.get());
  const bool wheels = own.sensors.wheels.has_value();
  if (made_.localize.value_or(false) && !wheels && !own.cameras) refuse_localize(mover);
  if (!wheels && !own.cameras) return;
  if (wheels) track_ = own.sensors.wheels->track;
  if (!real_) simulated_sensors_.emplace(world_, sensor_set_, mover_, own.sensors, options.seed);
  own_.emplace(mover, mover_, own);
}

void RobotClient::add_team() {
  sharing_ = dynamic_cast<control::SharesMap*>(made_.controller.get());
  if (sharing_ == nullptr || !sharing_->shares_map()) return;
  const netio::DirectV2v* const direct = link_.direct();
  if (direct == nullptr) return log_.note_no_team(0);
  exchange_.emplace(MapExchangeOptions{world_.movers[mover_].id, direct->options().session});
}

void RobotClient::receive(std::int64_t now) {
  link_.run(now);
  if (own_) own_->receive(now);
}

void RobotClient::move(std::int64_t now) {
  if (real_) {
    follow_real(now);
  } else {
    const base::Pose before = body_.state().X_WM;
    body_.move(command_, now);
    if (simulated_sensors_) simulated_sensors_->measure(before, body_.state(), now, *own_);
  }
  contacts_ += contact_.begins(body_.contact());
  if (truth_) truth_->send(body_.state(), now, epoch_);
}

void RobotClient::update_real(std::int64_t now) {
  const std::uint64_t odometry = real_->odometry();
  real_->update(now);
  touched_ = touched_ || real_->contact();
  if (shares_readings_) send_own_readings(now);
  if (own_ && own_->has_wheels() && real_->odometry() > odometry) own_->add_wheels(now, real_->rolled(track_));
}

/// Sends those to which the world file gives a virtual sensor, once the farm has answered.
void RobotClient::send_own_readings(std::int64_t now) {
  if (!link_.last_answer()) return;
  for (const OwnReading& own : real_->readings()) {
    const auto rows = sensor_set_.of(own.type, mover_);
    const bool fits = own.type == netio::kOwnLaser || own.type == netio::kOwnSonar || own.type == netio::kOwnInfrared ||
                      own.type == netio::kOwnBumper;
    if (!fits || own.sensor >= rows.size()) continue;
    std::uint32_t& next = shared_[{own.type, own.sensor}];
    if (std::exchange(next, own.sequence + 1) == own.sequence + 1) continue;
    const sensors::SensorType& type = *sensors::find_sensor_type(own.type);
    const std::size_t elements = own.values.size() / sensors::element_width(type);
    if (elements == rows[own.sensor].elements)
      link_.send_own_reading(own, now);
    else
      log_.note_unshared(type.name, elements, rows[own.sensor], now);
  }
}

/// The body is where the robot estimates itself.
void RobotClient::follow_real(std::int64_t now) {
  update_real(now);
  const base::Report* state = &real_->state();
  if (own_) {
    own_->predict(now, body_.state().X_WM.z);
    state = &own_->state();
  }
  body_.follow(state->X_WM, state->velocity, touched_, now);
}

void RobotClient::step(std::int64_t now) {
  move(now);
  scans_ = link_.scans();
  next_ = next_step(now);
  if (own_) own_->predict(now, body_.state().X_WM.z);
  if (own_ && !real_ && !is_lost()) position_errors_.add(own_state().X_WM, body_.state().X_WM);
  command_ = {};
  if (started_ && !is_lost() && !is_blind(now) && (!real_ || real_->ready(now))) decide(now);
  if (real_) real_->drive(command_, now);
  touched_ = false;
  send_state(now);
  if (exchange_) send_maps(now);
  log_.note_link(link_, needs_farm(now), now);
  if (own_) log_.note_position(is_lost(), own_->port() > 0, now);
  if (real_) log_.note_real(real_->type().title, real_->problem(now), real_->counts().frames > 0, now);
}

/// Returns whether the readings that its controller drives by are missing.
bool RobotClient::is_blind(std::int64_t now) const { return log_.readings_timed_out(link_, now) && needs_farm(now); }

/// Returns whether its controller does not drive by the readings of the real robot's own sensors alone.
bool RobotClient::needs_farm(std::int64_t now) const {
  if (needs_ == 0 || needs_ == control::Controller::kNeedsFarm) return needs_ != 0;
  if (!real_) return true;
  const auto own = real_->readings();
  return std::none_of(own.begin(), own.end(), [&](const OwnReading& reading) {
    return (needs_ >> reading.type & 1u) != 0 && now - reading.time < kOwnReadingValid;
  });
}

void RobotClient::leave(std::int64_t now) {
  if (real_) real_->stop();
  link_.leave(now);
}

/// A robot with an unknown pose sends no state. The farm's state of it then becomes stale, and so do its readings.
void RobotClient::send_state(std::int64_t now) {
  if (is_lost()) return link_.send_request(now);
  link_.send_state(v2v_of(own_state(), made_.controller->intent()), now,
                   own_ ? own_->quality() : netio::StateQuality{});
}

/// Also while it does not drive: others need its acknowledgements.
void RobotClient::send_maps(std::int64_t now) {
  exchange_->publish(sharing_->shared_map());
  exchange_->send(now, [&](const netio::TeamMap& map) { link_.send_map(map, now); });
  log_.note_team(exchange_->counts(), now);
  owes_map_ = !exchange_->is_complete(now);
}

void RobotClient::wait_until(std::int64_t until, const std::atomic<bool>& stop, const Clock& clock) {
  receive(clock());
  for (std::int64_t time = clock(); time < until && !stop && !is_due(time); time = clock()) {
    if (truth_ && truth_->is_due(time)) move(time);
    if (real_ && real_->due() <= time) update_real(time);
    const std::int64_t next = std::min(truth_ ? truth_->due() : INT64_MAX, real_ ? real_->due() : INT64_MAX);
    link_.wait(time, std::min(until, next));
    receive(clock());
  }
}

/// [ns] The farm drops a robot that sends no states, so without scans it steps at half the rate.
std::int64_t RobotClient::next_step(std::int64_t now) const {
  const std::int64_t period = std::llround(1e9 / rate());
  return made_.on_scans ? now + 2 * period : std::max(next_ + period, now - period);
}

void RobotClient::run(const std::atomic<bool>& stop, double duration) {
  const auto start = std::chrono::steady_clock::now();
  const Clock clock = [start] {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now() - start).count();
  };
  epoch_ = base::unix_time();
  if (own_) own_->set_epoch(epoch_);
  const std::int64_t end = duration > 0.0 ? base::nanoseconds(duration) : INT64_MAX;
  while (!stop && !done()) {
    wait_until(std::min(next_, end), stop, clock);
    if (stop || clock() >= end) break;
    step(clock());
  }
  leave(clock());
  wall_s_ = 1e-9 * static_cast<double>(clock());
}

RobotClientStats RobotClient::stats() const {
  RobotClientStats stats;
  stats.robot = world_.movers[mover_].name;
  stats.id = world_.movers[mover_].id;
  stats.controller = controller_;
  stats.farm = netio::endpoint_text(link_.farm());
  stats.wall_s = wall_s_;
  stats.steps = steps_;
  stats.started = started_;
  stats.done = done();
  if (!stats.done && command_.forward == 0.0 && command_.left == 0.0 && command_.turn == 0.0)
    stats.stop_reason = control::stop_reason_of(*made_.controller);
  stats.answered = link_.last_answer().has_value();
  stats.link = link_.counts();
  const bool meets_others =
      stats.link.direct && stats.link.direct->packets[netio::PacketStatus::accepted] > 0 && needs_ == 0;
  stats.listens = link_.listens() && !meets_others;
  stats.contacts = contacts_;
  stats.distance_m = body_.distance();
  stats.pose = body_.state().X_WM;
  stats.error = error_;
  if (map_) stats.map = map_->counts();
  if (exchange_) stats.team = exchange_->counts();
  if (real_) {
    stats.real = {std::string(real_->type().word), real_->counts(), real_->facts(), {}};
    for (const OwnReading& own : real_->readings())
      stats.real->readings[std::string(sensors::find_sensor_type(own.type)->name)] += own.sequence + 1;
  }
  if (own_)
    stats.own = {own_->port() > 0,
                 own_->has_wheels(),
                 own_->sensors().gyro.has_value(),
                 own_->sensors().gps.has_value(),
                 own_->counts(),
                 position_errors_,
                 own_->sigma(),
                 own_->calibration()};
  stats.listens_for_spat = lights_.listens();
  stats.lights = lights_.counts();
  stats.drives = drives_;
  stats.drives_ignored = drives_ignored_;
  stats.stops = log_.stops();
  stats.dropped = log_.dropped();
  stats.lines_left_out = log_.left_out() + (stats.link.direct ? stats.link.direct->lines_left_out : 0);
  return stats;
}

void RobotClient::on_packet(const netio::Packet& packet, std::int64_t now) {
  if (const auto* signals = std::get_if<netio::V2i>(&packet.body)) {
    if (!lights_.listens()) lights_.accept(packet.header, *signals, now);
    return;
  }
  if (const auto* drive = std::get_if<netio::Drive>(&packet.body)) return take_drive(*drive, now);
  if (const auto* lane = std::get_if<netio::Lane>(&packet.body)) {
    if (!lanes_.take(*lane)) log_.note_unknown_lane(lane->segment, lane->lane, now);
    return;
  }
  if (const auto* dropped = std::get_if<netio::Dropped>(&packet.body)) {
    const auto type = static_cast<std::uint8_t>(dropped->type);
    if (packet.header.sensor < sensor_set_.of(type, mover_).size())
      log_.note_dropped(packet.header.sensor, *dropped, now);
    return;
  }
  if (const auto* map = std::get_if<netio::TeamMap>(&packet.body)) {
    if (exchange_) exchange_->receive(packet.header, *map, now);
    return;
  }
  const auto* state = std::get_if<netio::V2v>(&packet.body);
  if (state == nullptr) {
    started_ = true;
    return;
  }
  const std::uint32_t row = names_.robots.at(packet.header.robot);
  intents_[row] = {state->follows, state->checkpoint, state->docking};
  body_.update_other(row, state->X_WR, state->velocity, now);
}

void RobotClient::take_drive(const netio::Drive& drive, std::int64_t now) {
  ++(remote_ != nullptr ? drives_ : drives_ignored_);
  if (remote_ != nullptr) return remote_->command(drive.twist, now);
  log_.note_ignored_drive(controller_, now);
}

void RobotClient::decide(std::int64_t now) {
  gather_readings(now);
  gather_others(now);
  gather_signals(now);
  control::ControllerInput input{now,      own_state(), readings_, body_.contact(),
                                 started_, others_,     signals_,  lanes_.network()};
  input.state.time = now;
  if (exchange_) sharing_->receive_maps(exchange_->teammates(now));
  command_ = made_.controller->step(input);
  if (real_) set_outputs(made_.controller->outputs(), now);
  ++steps_;
  control::add(error_, made_.controller->error());
  if (map_) draw_map(now);
}

void RobotClient::set_outputs(std::uint8_t bits, std::int64_t now) {
  if (!real_->set_outputs(bits) && bits != 0) log_.note_ignored_outputs(real_->type().title, now);
}

void RobotClient::draw_map(std::int64_t now) {
  for (const base::ReadingBlock& reading : readings_) map_->add(reading, reading.X_WM);
  map_->send(now, !own_ && !real_);
}

/// Packets do not carry the pose that the farm cast from, so the robot uses its own pose at that time.
void RobotClient::gather_readings(std::int64_t now) {
  readings_.clear();
  const bool farm_is_silent = log_.readings_timed_out(link_, now);
  for (RobotLink::Newest& newest : link_.readings()) {
    if (farm_is_silent) break;  // too old to act on
    base::ReadingBlock& block = readings_.emplace_back(newest.block);
    const base::TiltedPose pose = own_ ? own_->pose_at(block.time) : body_.pose_at(block.time);
    block.X_WM = pose.X, block.tilt = pose.tilt;
    block.X_WS = base::compose(block.X_WM, newest.row->X_MS);
  }
  if (real_) gather_own_readings(now);
}

/// Numbered after the virtual sensors of their types. Where they are mounted is unknown, so their pose is the robot's.
/// Leaves out sensors whose readings the farm has recently fused, since its readings contain them.
void RobotClient::gather_own_readings(std::int64_t now) {
  const std::size_t virtual_ones = readings_.size();
  for (const OwnReading& own : real_->readings()) {
    const auto returns = [&](const base::ReadingBlock& block) {
      return block.fused && block.type == own.type && block.sensor == own.sensor && now - block.time < kOwnReadingValid;
    };
    if (std::any_of(readings_.begin(), readings_.begin() + static_cast<std::ptrdiff_t>(virtual_ones), returns))
      continue;
    base::ReadingBlock& block = readings_.emplace_back();
    block.mover = mover_;
    block.sensor = static_cast<std::uint32_t>(sensor_set_.of(own.type, mover_).size()) + own.sensor;
    block.type = own.type;
    block.sequence = own.sequence;
    block.time = own.time;
    block.values = own.values;
    block.sigma = HUGE_VAL;
    block.X_WM = block.X_WS = (own_ ? own_->pose_at(own.time) : body_.pose_at(own.time)).X;
  }
}

void RobotClient::gather_others(std::int64_t now) {
  others_.clear();
  const double radio = made_.controller->v2v_range();
  if (radio <= 0.0) return;
  const base::Pose& own = own_state().X_WM;
  for (const auto& [id, row] : names_.robots) {
    if (row == mover_ || !link_.is_active(id, now)) continue;
    base::Report state = body_.state(row);
    state.time = now;
    if (base::hypot(state.X_WM.x - own.x, state.X_WM.y - own.y) <= radio) others_.push_back({id, state, intents_[row]});
  }
}

/// Signals follow the farm's clock, and received states override the plans.
void RobotClient::gather_signals(std::int64_t now) {
  const double time = 1e-9 * static_cast<double>(link_.clock().to_farm(now));
  signals_.clear();
  for (const world::Light& light : world_.lights) signals_.push_back(world::signal_at(light, time));
  if (lights_.listens()) lights_.receive(now, utc_());
  lights_.apply(now, signals_);
}

}  // namespace sf::server
