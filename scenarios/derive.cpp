#include "scenarios/derive.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string_view>
#include <tuple>

#include "base/error.h"
#include "base/files.h"
#include "base/suggest.h"
#include "base/thread_pool.h"
#include "base/time.h"
#include "farm/derivation.h"
#include "farm/schedule.h"
#include "farm/stored_reading.h"
#include "scenarios/recorded_states.h"
#include "sensors/sensor_set.h"
#include "world/toml_reader.h"

namespace sf::scenarios {

namespace {

using world::TomlNode;

/// Values of one or more elements, as in world files.
world::Setting setting_of(const world::TomlReader& reader, const TomlNode& node) {
  world::Setting setting{node.key, {}, "", node.line, reader.file()};
  const auto add = [&](const TomlNode& value) {
    if (value.kind == TomlNode::Kind::number)
      setting.numbers.push_back(value.number);
    else if (value.kind == TomlNode::Kind::text)
      setting.text += (setting.text.empty() ? "" : "\n") + value.text;
    else
      reader.fail(node, fmt::format("'{}' is {}; expected a number, a text, or a list of them", node.key,
                                    world::shown_toml(value)));
  };
  if (node.kind == TomlNode::Kind::list)
    for (const TomlNode& item : node.items) add(item);
  else
    add(node);
  return setting;
}

const sensors::SensorType& derived_type_of(const world::TomlReader& reader, const TomlNode& table) {
  const TomlNode* const node = find(table, "type");
  const std::string name = reader.text(table, "type", "");
  std::vector<std::string_view> names;
  for (const sensors::SensorType* type : sensors::sensor_types()) {
    if (type->derived == nullptr) continue;
    if (type->name == name) return *type;
    names.push_back(type->name);
  }
  reader.fail(node != nullptr ? *node : table,
              fmt::format("derived sensor type '{}' is unknown{}", name, base::expected_one_of(name, names)));
}

std::uint32_t mover_of(const world::TomlReader& reader, const TomlNode& table, const world::World& world) {
  const TomlNode* const node = find(table, "robot");
  const std::string name = reader.text(table, "robot", "");
  std::vector<std::string_view> names;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    if (world.movers[m].name == name) return m;
    names.push_back(world.movers[m].name);
  }
  reader.fail(node != nullptr ? *node : table,
              fmt::format("no recorded robot is called '{}'{}", name, base::expected_one_of(name, names)));
}

void check_settings(const world::TomlReader& reader, const TomlNode& table, const sensors::SensorType& type) {
  std::vector<std::string_view> known(type.word.keys.begin(), type.word.keys.end());
  known.insert(known.end(), {"robot", "name", "rate", "phase", "latency", "noise"});
  reader.require_known(table, known);
}

/// Times at which a run with these sensors evaluates: ticks, and due times in between.
class CallTimes {
 public:
  explicit CallTimes(const sensors::SensorSet& sensor_set) {
    for (const sensors::SensorSet::Group& group : sensor_set.groups())
      for (const sensors::SensorSpec& row : group.rows) timings_.insert({row.rate, row.phase});
  }
  /// Returns the first due time of any sensor after `after` [ns]; farm::kNever: none.
  std::int64_t next(std::int64_t after) const {
    std::int64_t soonest = farm::kNever;
    for (const auto& [rate, phase] : timings_) {
      std::uint64_t k = farm::readings_started(after, rate, phase);
      while (k > 0 && farm::due_time(k - 1, rate, phase) > after) --k;
      while (farm::due_time(k, rate, phase) <= after) ++k;
      soonest = std::min(soonest, farm::due_time(k, rate, phase));
    }
    return soonest;
  }

 private:
  std::set<std::pair<double, double>> timings_;
};

class Derive {
 public:
  Derive(const record::Recording& recording, const world::World& world, std::span<const AddedSensor> added,
         unsigned threads, base::Sink& sink)
      : recording_(recording),
        sink_(sink),
        thread_pool_(threads),
        sensor_set_(world),
        derivation_({world, device_, thread_pool_, states_}, sensor_set_),
        delivery_(sensor_set_),
        times_(sensor_set_),
        subscribed_(world.movers.size(), 0) {
    for (const AddedSensor& sensor : added) {
      subscribed_[sensor.mover] |= base::only(sensor.type);
      added_.insert({sensor.type, sensor.mover, sensor.sensor});
    }
    derivation_.update_demand(subscribed_, {});
    require_inputs(world);
    for (std::size_t i = 0; i < recording.readings.size(); ++i) {
      const record::ReadingSample& r = recording.readings[i];
      const sensors::SensorSet::Group* const group = sensor_set_.group(r.type);
      if (group == nullptr || group->type->derived != nullptr) continue;  // derived ones are evaluated again
      const std::int64_t latency = base::nanoseconds(sensor_set_.of(r.type, r.mover)[r.sensor].latency);
      arrivals_.push_back({r.time + latency, i});
    }
    std::ranges::stable_sort(arrivals_, {}, &Arrival::due);
  }

  void tick(std::size_t tick) {
    recorded_reports(recording_, tick, states_);
    const std::int64_t time = states_[0].time;
    out_.clear();
    used_ = 0;
    for (std::int64_t due = times_.next(last_); tick > 0 && due < time; due = times_.next(due)) call(due);
    commands_.clear();
    contacts_.clear();
    for (const auto& states : recording_.states) {
      commands_.push_back(states[tick].command);
      contacts_.push_back(states[tick].contact ? 1 : 0);
    }
    derivation_.set_commands(commands_);
    call(time);
    last_ = time;
    sink_.write({recording_.states[0][tick].tick, time, states_, commands_, contacts_, out_, {}, {}});
  }

 private:
  struct Arrival {
    std::int64_t due;
    std::size_t reading;
  };

  void require_inputs(const world::World& world) const {
    std::set<std::tuple<std::uint8_t, std::uint32_t, std::uint32_t>> recorded;
    for (const record::ReadingSample& r : recording_.readings) recorded.insert({r.type, r.mover, r.sensor});
    for (const sensors::DerivedNode& node : derivation_.sensors().nodes())
      for (const sensors::WiredInput& input : node.inputs) {
        const bool computed =
            sensors::input_type(input.type).derived != nullptr || input.type == sensors::kCommandInput;
        if (!added_.contains({node.type->id, node.spec.mover, node.spec.sensor}) || computed ||
            recorded.contains({input.type, input.mover, input.sensor}))
          continue;
        throw base::InputError(
            node.settings->file, node.settings->line,
            fmt::format("{}: {} has no readings of {} {} of '{}': record them with --record-readings",
                        sensors::derived_name(world, node), recording_.file, sensors::input_type(input.type).name,
                        input.sensor, world.movers[input.mover].name));
      }
  }

  void call(std::int64_t now) {
    arrived_.clear();
    for (; next_ < arrivals_.size() && arrivals_[next_].due <= now; ++next_) {
      const record::ReadingSample& r = recording_.readings[arrivals_[next_].reading];
      arrived_.push_back({.mover = r.mover,
                          .sensor = r.sensor,
                          .type = r.type,
                          .sequence = r.sequence,
                          .time = r.time,
                          .values = r.values,
                          .sigma = HUGE_VAL});
    }
    const auto late = delivery_.deliver(now, {});
    arrived_.insert(arrived_.end(), late.begin(), late.end());
    derivation_.find_due(now, subscribed_);
    for (const base::ReadingBlock& block : derivation_.derive(now, arrived_, states_, delivery_, subscribed_))
      if (added_.contains({block.type, block.mover, block.sensor})) keep(block);
  }

  void keep(const base::ReadingBlock& block) {
    if (kept_.size() == used_) kept_.push_back(std::make_unique<farm::StoredReading>());
    kept_[used_]->take(block);
    out_.push_back(kept_[used_++]->block());
  }

  const record::Recording& recording_;
  base::Sink& sink_;
  gpu::Device device_{std::string(gpu::kHostDevice)};
  base::ThreadPool thread_pool_;
  sensors::SensorSet sensor_set_;
  std::vector<base::Report> states_;
  farm::Derivation derivation_;
  farm::Delivery delivery_;
  CallTimes times_;
  std::vector<base::SensorTypes> subscribed_;
  std::set<std::tuple<std::uint8_t, std::uint32_t, std::uint32_t>> added_;
  std::vector<Arrival> arrivals_;  ///< measured readings in order of delivery
  std::size_t next_ = 0;           ///< row of `arrivals_`
  std::int64_t last_ = -1;         ///< [ns] last tick
  std::vector<base::ReadingBlock> arrived_, out_;
  std::vector<std::unique_ptr<farm::StoredReading>> kept_;  ///< behind `out_`
  std::size_t used_ = 0;
  std::vector<base::Twist> commands_;
  std::vector<std::uint8_t> contacts_;
};

}  // namespace

std::vector<AddedSensor> add_derived_sensors(world::World& world, const std::string& file) {
  const world::TomlReader reader(file);
  const TomlNode root = world::parse_toml(file, base::read_text(file));
  constexpr std::string_view kKnown[] = {"derived"};
  reader.require_known(root, kKnown);
  std::vector<AddedSensor> added;
  for (const TomlNode* table : reader.tables(root, "derived")) {
    const sensors::SensorType& type = derived_type_of(reader, *table);
    check_settings(reader, *table, type);
    const std::uint32_t mover = mover_of(reader, *table, world);
    world::Sensor sensor;
    sensor.type = type.word.type;
    sensor.name = reader.text(*table, "name", std::string(type.name));
    sensor.radians_per_unit = M_PI / 180.0;
    sensor.file = file;
    sensor.line = table->line;
    for (const TomlNode& item : table->items)
      if (item.key != "robot" && item.key != "name") sensor.settings.push_back(setting_of(reader, item));
    auto& sensors = world.movers[mover].sensors;
    const auto number = std::ranges::count(sensors, sensor.type, &world::Sensor::type);
    sensors.push_back(std::move(sensor));
    added.push_back({mover, type.id, static_cast<std::uint32_t>(number)});
  }
  if (added.empty()) reader.fail(root, "has no [[derived]] table; see docs/derived.md");
  return added;
}

void derive(const record::Recording& recording, const world::World& world, std::span<const AddedSensor> added,
            unsigned threads, base::Sink& sink, const std::function<bool(double part)>& stop) {
  if (!has_all_states(recording))
    throw base::InputError(recording.file, 0, "has ticks without the states of all movers");
  Derive run(recording, world, added, threads, sink);
  const std::size_t ticks = recording.states.empty() ? 0 : recording.states[0].size();
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    if (stop(static_cast<double>(tick) / static_cast<double>(ticks))) return;
    run.tick(tick);
  }
}

}  // namespace sf::scenarios
