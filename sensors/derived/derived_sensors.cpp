#include "sensors/derived/derived_sensors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "base/error.h"
#include "base/plugin_calls.h"
#include "base/printable.h"
#include "base/time.h"
#include "sensors/derived/public_types.h"
#include "sensors/own_sensors.h"
#include "sensors/settings.h"

namespace sf::sensors {

namespace {

constexpr std::size_t kPiece = 16;  // sensors per piece of a parallel loop

constexpr sensorfarm::Pose kUnknownPose{NAN, NAN, NAN, NAN};

bool is_own_type(const SensorType& type) { return type.id >= kFirstOwnId && type.id <= kLastOwnId; }

sensorfarm::DerivedSite public_site(const world::World& world, const SensorSet& sensor_set, const DerivedNode& node,
                                    const sensorfarm::Pose& start) {
  const SensorSpec& spec = node.spec;
  const world::CopyIndex copies(world);
  sensorfarm::DerivedSite site{
      {spec.name, copies.row_of(spec.mover), spec.sensor, public_pose(spec.X_MS), node.settings->height}, start, {}};
  for (const WiredInput& input : node.inputs) {
    const SensorType& type = input_type(input.type);
    const SensorSpec received{.name = std::string(type.name)};
    const SensorSpec& of = is_received(input.type) ? received : sensor_set.of(input.type, input.mover)[input.sensor];
    site.inputs.push_back({input.port, copies.row_of(input.mover), public_info(type, of)});
  }
  return site;
}

/// @throws base::InputError for invalid settings
std::unique_ptr<sensorfarm::DerivedSensor> make_derived_sensor(const world::World& world, const SensorSet& sensor_set,
                                                               const DerivedNode& node, const sensorfarm::Pose& start) {
  const sensorfarm::DerivedSite site = public_site(world, sensor_set, node, start);
  std::vector<double> sigmas;
  for (const WiredInput& input : node.inputs) {
    const bool measures = !is_received(input.type) && find_sensor_type(input.type)->derived == nullptr;
    const double sigma = measures ? sensor_set.of(input.type, input.mover)[input.sensor].sigma : 0.0;
    sigmas.push_back(std::isfinite(sigma) ? sigma : 0.0);
  }
  const base::PluginCall under_way(derived_name(world, node));
  try {
    auto sensor = node.type->derived->make({world, *node.settings, node.spec, node.inputs, site, sigmas});
    if (sensor != nullptr) return sensor;
  } catch (const base::InputError&) {
    throw;  // an invalid setting
  } catch (const std::exception& error) {
    refuse(*node.settings, "", base::one_line(error.what()));
  }
  refuse(*node.settings, "", fmt::format("derived sensor type '{}' returned none", node.type->name));
}

}  // namespace

void check_derived_sensors(const world::World& world, const SensorSet& sensor_set) {
  for (const DerivedNode& node : wire(world, sensor_set)) make_derived_sensor(world, sensor_set, node, kUnknownPose);
}

DerivedSensors::DerivedSensors(const world::World& world, const SensorSet& sensor_set, base::ThreadPool& thread_pool,
                               const raycast::Episodes& episodes)
    : world_(world),
      sensor_set_(sensor_set),
      thread_pool_(thread_pool),
      episodes_(episodes),
      wired_(wire(world, sensor_set)),
      nodes_(wired_.size()),
      group_of_(64, -1),
      input_types_(64, nullptr) {
  for (const std::uint8_t type : {kCommandInput, kCameraInput, kV2vInput}) input_types_[type] = &input_type(type);
  const auto groups = sensor_set.groups();
  for (std::size_t g = 0; g < groups.size(); ++g) {
    group_of_[groups[g].type->id] = static_cast<int>(g);
    input_types_[groups[g].type->id] = groups[g].type;
    needed_.emplace_back();
    listeners_.emplace_back(wired_.empty() ? 0 : groups[g].rows.size());
  }
  blocks_.resize(nodes_.size());
  out_.reserve(nodes_.size());
  for (std::uint32_t i = 0; i < wired_.size(); ++i) {
    const DerivedNode& node = wired_[i];
    if (levels_.size() <= node.level) levels_.resize(node.level + 1), active_.resize(node.level + 1);
    levels_[node.level].push_back(i);
    for (std::uint32_t k = 0; k < node.inputs.size(); ++k) {
      const WiredInput& input = node.inputs[k];
      if (is_received(input.type)) received_listeners_.push_back({input.type, input.mover, {i, k}});
      if (is_received(input.type)) continue;
      const auto g = static_cast<std::size_t>(group_of_[input.type]);
      listeners_[g][groups[g].first[input.mover] + input.sensor].push_back({i, k});
    }
    const DerivedForm& form = *node.type->derived;
    const std::size_t rows = node.spec.elements;
    nodes_[i].name = derived_name(world, node);
    nodes_[i].quantities.resize(rows * (form.quantities + form.extra));
    nodes_[i].covariance.resize(form.covariance ? rows * triangle(form.quantities) : 0);
    nodes_[i].valid.resize(rows);
    nodes_[i].values.resize(rows * element_width(*node.type));
  }
  for (std::vector<std::size_t>& level : active_) level.reserve(nodes_.size());
}

template <class Wanted>
void DerivedSensors::want_if(const Wanted& wanted, std::span<const std::uint8_t> gone) {
  const auto groups = sensor_set_.groups();
  for (std::size_t g = 0; g < groups.size(); ++g) needed_[g].assign(nodes_.empty() ? 0 : groups[g].rows.size(), 0);
  for (std::size_t level = levels_.size(); level-- > 0;)
    for (const std::size_t i : levels_[level]) {
      const DerivedNode& node = wired_[i];
      const auto own = static_cast<std::size_t>(group_of_[node.type->id]);
      nodes_[i].wanted = wanted(node) || needed_[own][node.row] != 0;
      if (!nodes_[i].wanted) continue;
      for (const WiredInput& input : node.inputs) {
        if (is_received(input.type) || (!gone.empty() && gone[input.mover] != 0)) continue;
        const auto g = static_cast<std::size_t>(group_of_[input.type]);
        needed_[g][groups[g].first[input.mover] + input.sensor] = 1;
      }
    }
  for (Node& node : nodes_)
    if (!node.wanted) node.sensor.reset();
  demand_changed_ = true;
}

void DerivedSensors::want(std::span<const base::SensorTypes> subscribed, std::span<const std::uint8_t> gone) {
  want_if([&](const DerivedNode& node) { return (subscribed[node.spec.mover] & base::only(node.type->id)) != 0; },
          gone);
}

void DerivedSensors::want_only(std::uint32_t mover, std::uint8_t type, std::uint32_t sensor) {
  want_if([&](const DerivedNode& node) {
    return node.type->id == type && node.spec.mover == mover && node.spec.sensor == sensor;
  });
}

void DerivedSensors::create_wanted(std::span<const base::Report> states) {
  if (!std::exchange(demand_changed_, false)) return;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (!nodes_[i].wanted || nodes_[i].sensor != nullptr) continue;
    const base::Pose& X_WM = states[wired_[i].spec.mover].X_WM;
    const bool known = nodes_[i].starts && !base::is_absent(X_WM);
    nodes_[i].sensor = make_derived_sensor(world_, sensor_set_, wired_[i], known ? public_pose(X_WM) : kUnknownPose);
  }
}

void DerivedSensors::route(const base::ReadingBlock& reading) {
  const int g = group_of_[reading.type];
  if (g < 0) return;
  const std::uint32_t row = sensor_set_.groups()[static_cast<std::size_t>(g)].first[reading.mover] + reading.sensor;
  for (const Listener& listener : listeners_[static_cast<std::size_t>(g)][row])
    add_pending(listener.node, {reading.time, listener.input, reading.sequence, &reading});
}

void DerivedSensors::call(std::size_t i, std::int64_t now) {
  Node& node = nodes_[i];
  const DerivedNode& wired = wired_[i];
  for (const Pending& pending : node.pending) {
    sensorfarm::Reading reading = public_reading(*pending.reading, *input_types_[pending.reading->type]);
    reading.X_WS = kUnknownPose;
    node.sensor->take(pending.input, reading);
  }
  if (!node.is_due) return;
  std::ranges::fill(node.quantities, 0.0);
  std::ranges::fill(node.covariance, std::numeric_limits<double>::quiet_NaN());
  std::ranges::fill(node.valid, std::uint8_t{1});
  node.sensor->read(1e-9 * static_cast<double>(now), {node.quantities, node.covariance, node.valid});
  ++node.readings;
  node.was_valid |= std::ranges::any_of(node.valid, [](std::uint8_t valid) { return valid != 0; });
  const DerivedForm& form = *wired.type->derived;
  const std::size_t quantities = form.quantities;
  const std::size_t covariances = form.covariance ? triangle(form.quantities) : 0;
  double* out = node.values.data();
  for (std::size_t row = 0; row < node.valid.size(); ++row) {
    const bool valid = node.valid[row] != 0;
    const double* const from = node.quantities.data() + row * (quantities + form.extra);
    for (std::size_t k = 0; k < quantities; ++k) *out++ = valid ? from[k] : std::numeric_limits<double>::quiet_NaN();
    *out++ = valid ? 1.0 : 0.0;
    out = std::copy_n(node.covariance.data() + row * covariances, covariances, out);
    out = std::copy_n(from + quantities, form.extra, out);
  }
}

void DerivedSensors::take_commands(std::int64_t now, std::span<const base::Twist> commands) {
  commands_.resize(received_listeners_.size());
  for (std::size_t k = 0; k < received_listeners_.size(); ++k) {
    const auto& [type, mover, listener] = received_listeners_[k];
    if (type != kCommandInput || std::isnan(commands[mover].forward)) continue;
    Command& command = commands_[k];
    command.values = {commands[mover].forward, commands[mover].left, commands[mover].turn};
    const std::int64_t time = now - episodes_.start_of(mover);
    command.reading = {.mover = mover, .type = kCommandInput, .time = time, .values = command.values};
    add_pending(listener.node, {time, listener.input, 0, &command.reading});
  }
}

void DerivedSensors::take_received(const base::ReadingBlock& reading) {
  for (const auto& [type, mover, listener] : received_listeners_)
    if (type == reading.type && mover == reading.mover &&
        (type != kV2vInput || wired_[listener.node].spec.mover == reading.sensor))
      add_pending(listener.node, {reading.time, listener.input, reading.sequence, &reading});
}

void DerivedSensors::add_pending(std::size_t i, const Pending& pending) {
  Node& node = nodes_[i];
  if (node.sensor == nullptr) return;
  node.pending.push_back(pending);
  if (!std::exchange(node.active, true)) active_[wired_[i].level].push_back(i);
}

void DerivedSensors::process(std::size_t i, std::int64_t farm_time) {
  Node& node = nodes_[i];
  const std::int64_t now = farm_time - episodes_.start_of(wired_[i].spec.mover);
  std::ranges::sort(node.pending, {}, &Pending::key);
  std::optional<base::PluginCall> under_way;
  if (is_own_type(*wired_[i].type)) under_way.emplace(node.name, 1e-9 * static_cast<double>(now));
  try {
    call(i, now);
  } catch (const std::exception& error) {
    node.failure = *error.what() != '\0' ? error.what() : "it threw an exception without a message";
  } catch (...) {
    node.failure = "it threw something that is not a std::exception";
  }
}

/// Readings without latency reach the levels above at once.
void DerivedSensors::run_level(std::size_t level, std::int64_t now, std::span<const base::Report> states,
                               const Stage& stage) {
  std::vector<std::size_t>& active = active_[level];
  thread_pool_.parallel_for_each(active.size(), kPiece, [&](std::size_t k, unsigned) { process(active[k], now); });
  for (const std::size_t i : active) {
    Node& node = nodes_[i];
    if (!node.failure.empty())
      throw base::InputError(fmt::format("{} failed at {:.3f} s: {}", node.name, 1e-9 * static_cast<double>(now),
                                         base::one_line(node.failure)));
    node.pending.clear();
    node.active = false;
    if (!std::exchange(node.is_due, false)) continue;
    const SensorSpec& spec = wired_[i].spec;
    const base::Pose& X_WM = states[spec.mover].X_WM;
    blocks_[i] = {.mover = spec.mover,
                  .sensor = spec.sensor,
                  .type = wired_[i].type->id,
                  .sequence = node.sequence,
                  .time = now - episodes_.start_of(spec.mover),
                  .X_WM = X_WM,
                  .X_WS = base::compose(X_WM, spec.X_MS),
                  .values = node.values,
                  .sigma = HUGE_VAL};
    const Fate prompt = base::nanoseconds(spec.latency) == 0 ? Fate::delivered : Fate::late;
    const Fate fate = stage ? stage(blocks_[i]) : prompt;
    node.is_lost = fate == Fate::lost;
    if (fate == Fate::delivered) route(blocks_[i]);
  }
  active.clear();
}

std::span<const base::ReadingBlock> DerivedSensors::evaluate(std::int64_t now,
                                                             std::span<const base::ReadingBlock> delivered,
                                                             std::span<const std::span<const DueSample>> due,
                                                             std::span<const base::Report> states, const Stage& stage,
                                                             std::span<const base::Twist> commands,
                                                             std::span<const base::ReadingBlock> received) {
  create_wanted(states);
  if (std::exchange(starting_, false))
    for (Node& node : nodes_) node.starts = false;
  out_.clear();
  if (!commands.empty()) take_commands(now, commands);
  for (const base::ReadingBlock& reading : received) take_received(reading);
  for (const base::ReadingBlock& reading : delivered) route(reading);
  std::size_t first = 0;  // node of the group's first row
  std::size_t group = 0;
  due_nodes_.clear();
  for (const SensorSet::Group& each : sensor_set_.groups()) {
    if (each.type->derived == nullptr) continue;
    for (const DueSample& sample : due[group]) {
      const std::size_t i = first + sample.row;
      if (nodes_[i].sensor == nullptr) continue;
      nodes_[i].is_due = true;
      nodes_[i].sequence = static_cast<std::uint32_t>(sample.sequence);
      due_nodes_.push_back(i);
      if (!std::exchange(nodes_[i].active, true)) active_[wired_[i].level].push_back(i);
    }
    first += each.rows.size();
    ++group;
  }
  for (std::size_t level = 0; level < levels_.size(); ++level) run_level(level, now, states, stage);
  for (const std::size_t i : due_nodes_)
    if (!nodes_[i].is_lost) out_.push_back(blocks_[i]);
  return out_;
}

void DerivedSensors::restart(std::uint32_t first, std::uint32_t end) {
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (wired_[i].spec.mover < first || wired_[i].spec.mover >= end) continue;
    nodes_[i].sensor.reset();
    nodes_[i].starts = starting_ = demand_changed_ = true;
  }
}

std::vector<std::string> DerivedSensors::never_valid() const {
  std::vector<std::string> lines;
  for (const std::vector<std::size_t>& level : levels_)
    for (const std::size_t i : level)
      if (const Node& node = nodes_[i]; node.readings > 0 && !node.was_valid)
        lines.push_back(node.readings == 1
                            ? fmt::format("the only reading of {} was not valid", node.name)
                            : fmt::format("none of the {} readings of {} was valid", node.readings, node.name));
  return lines;
}

void DerivedSensors::take_over(DerivedSensors& before) {
  starting_ = before.starting_;
  std::map<std::tuple<std::uint8_t, std::uint32_t>, std::size_t> old;
  for (std::size_t i = 0; i < before.nodes_.size(); ++i) old[{before.wired_[i].type->id, before.wired_[i].row}] = i;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto found = old.find({wired_[i].type->id, wired_[i].row});
    nodes_[i].starts = before.starting_;
    if (found == old.end() || before.nodes_[found->second].sensor == nullptr) continue;
    nodes_[i].sensor = std::move(before.nodes_[found->second].sensor);
    nodes_[i].readings = before.nodes_[found->second].readings;
    nodes_[i].was_valid = before.nodes_[found->second].was_valid;
    const auto site = public_site(world_, sensor_set_, wired_[i], kUnknownPose);
    for (std::size_t k = before.wired_[found->second].inputs.size(); k < site.inputs.size(); ++k)
      nodes_[i].sensor->add_input(site.inputs[k]);
  }
}

}  // namespace sf::sensors
