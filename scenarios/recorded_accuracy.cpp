#include "scenarios/recorded_accuracy.h"

#include <algorithm>

#include "base/error.h"
#include "farm/farm.h"
#include "scenarios/recorded_states.h"
#include "sensors/accuracy.h"

namespace sf::scenarios {

namespace {

world::World world_in(const record::Recording& recording, const std::string& words) {
  world::World world = recorded_world(recording);
  sensors::set_accuracy(world, words);
  return world;
}

/// Two farms with the same sensors.
class Pair {
 public:
  Pair(const record::Recording& recording, gpu::Device& device, const std::string& words, const VerifyOptions& options)
      : recording_(recording),
        world_(world_in(recording, words)),
        exact_world_(world_in(recording, "exact")),
        shapes_(recording, world_),
        exact_shapes_(recording, exact_world_),
        farm_(world_, device, options_of(recording, options)),
        exact_(exact_world_, device, options_of(recording, options)) {
    for (const sensors::SensorSet::Group& group : farm_.sensor_set().groups()) {
      if (group.type->modes.empty()) continue;
      types_ |= base::only(group.type->id);
      result_.types.push_back({.sensor = std::string(group.type->name),
                               .mode = std::string(sensors::word_of(*group.type, group.rows.front().mode)),
                               .unit = std::string(sensors::unit_of(*group.type)),
                               .errors = {}});
      for (const sensors::SensorSpec& row : group.rows) result_.types.back().noisy |= row.sigma > 0.0;
      rows_.push_back(group.type);
    }
    for (std::uint32_t m = 0; m < world_.movers.size(); ++m)
      for (farm::Farm* farm : {&farm_, &exact_}) farm->subscribe(m, types_);
    result_.words = words;
  }

  RecordedAccuracy run(const VerifyOptions& options) {
    const std::size_t ticks = recording_.states.empty() ? 0 : recording_.states[0].size();
    for (std::size_t t = 0; t < ticks; ++t) {
      step(t);
      ++result_.ticks;
      if (options.progress && !options.progress(static_cast<double>(t + 1) / static_cast<double>(ticks))) break;
    }
    result_.interrupted = result_.ticks < ticks;
    return std::move(result_);
  }

 private:
  static farm::FarmOptions options_of(const record::Recording& recording, const VerifyOptions& options) {
    return {.seed = recording.info.seed, .noise = false, .threads = options.threads};
  }

  void step(std::size_t tick) {
    recorded_reports(recording_, tick, reports_);
    for (farm::Farm* farm : {&farm_, &exact_}) set_absent(reports_, *farm);
    const std::int64_t time = reports_[0].time;
    if (shapes_.go_to(time)) farm_.update_outlines();
    if (exact_shapes_.go_to(time)) exact_.update_outlines();
    for (std::int64_t due = farm_.next_due(); tick > 0 && due < time; due = farm_.next_due())
      compare(farm_.sample_between(due, reports_), exact_.sample_between(due, reports_));
    compare(farm_.tick(time, reports_), exact_.tick(time, reports_));
  }

  void compare(std::span<const base::ReadingBlock> readings, std::span<const base::ReadingBlock> exact) {
    SF_CHECK(readings.size() == exact.size(), "the same sensors are due in every mode");
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const auto row = std::ranges::find(rows_, readings[i].type, &sensors::SensorType::id);
      if (row == rows_.end() || readings[i].values.size() != exact[i].values.size()) continue;
      ErrorDistribution& errors = result_.types[static_cast<std::size_t>(row - rows_.begin())].errors;
      const std::size_t width = sensors::element_width(**row, farm_.sensor_set().row(readings[i]));
      for (std::size_t k = 0; k < readings[i].values.size(); k += width) {
        const double value = readings[i].values[k];
        errors.add(value, exact[i].values[k], covering_bound(readings[i], k / width, value));
      }
    }
  }

  const record::Recording& recording_;
  world::World world_, exact_world_;
  RecordedShapes shapes_, exact_shapes_;
  farm::Farm farm_, exact_;
  base::SensorTypes types_ = 0;                   ///< types that have modes
  std::vector<const sensors::SensorType*> rows_;  ///< of `result_.types`
  std::vector<base::Report> reports_;
  RecordedAccuracy result_;
};

}  // namespace

bool RecordedAccuracy::within_bounds() const {
  return std::all_of(types.begin(), types.end(),
                     [](const ModeErrors& t) { return t.errors.covered_max() <= t.errors.bound(); });
}

RecordedAccuracy recorded_accuracy(const record::Recording& recording, gpu::Device& device, const std::string& words,
                                   const VerifyOptions& options) {
  Pair pair(recording, device, words, options);
  if (has_all_states(recording)) return pair.run(options);
  return {.words = words, .types = {}, .notes = {"ticks without the states of all movers: nothing was recomputed"}};
}

}  // namespace sf::scenarios
