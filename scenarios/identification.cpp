#include "scenarios/identification.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "base/error.h"
#include "base/suggest.h"
#include "base/time.h"
#include "scenarios/recorded_states.h"
#include "sensors/derived/public_types.h"
#include "sensors/derived/wiring.h"
#include "sensors/sensor_set.h"

namespace sf::scenarios {

namespace {

constexpr double kMostSteps = 2e6;  // of a recording
constexpr double kUnknownValue = std::numeric_limits<double>::quiet_NaN();

/// A sensor of the robot, and the place of its newest values.
struct Signal {
  std::uint8_t type;
  std::uint32_t sensor;
  std::size_t first, count;  ///< in the row of a step
  bool seen = false;
};

std::uint32_t robot_row(const record::Recording& recording, const world::World& world, const std::string& robot) {
  std::vector<std::string_view> names;
  for (std::uint32_t m = 0; m < world.movers.size(); ++m) {
    if (world.movers[m].name == robot) return m;
    names.push_back(world.movers[m].name);
  }
  throw base::InputError(recording.file, 0,
                         fmt::format("has no robot '{}'{}", robot, base::expected_one_of(robot, names)));
}

/// Finds a sensor written as "type" or "type:number".
const sensors::SensorSpec& spec_of(const record::Recording& recording, const sensors::SensorSet& sensor_set,
                                   std::uint32_t mover, const std::string& text, const sensors::SensorType*& type) {
  const sensors::InputText input = sensors::read_input(text);
  const bool own_sensor = input.port.empty() && input.robot.empty() && input.number;
  std::vector<std::string_view> names;
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    const auto own = sensor_set.of(group.type->id, mover);
    if (own.empty()) continue;
    names.push_back(group.type->name);
    if (!own_sensor || !sensors::is_called(*group.type, input.type) || *input.number >= own.size()) continue;
    type = group.type;
    return own[*input.number];
  }
  throw base::InputError(recording.file, 0,
                         fmt::format("the robot has no sensor '{}'; expected TYPE or TYPE:NUMBER, of: {}{}", text,
                                     fmt::join(names, ", "), base::suggest(input.type, names)));
}

class Sampler {
 public:
  Sampler(const record::Recording& recording, const IdentificationSignals& wanted)
      : recording_(recording),
        wanted_(wanted),
        world_(recorded_world(recording)),
        sensor_set_(world_),
        mover_(robot_row(recording, world_, wanted.robot)) {
    for (const std::string& input : wanted.inputs) add(input, model_.inputs);
    if (model_.inputs.empty() || model_.inputs.size() > estimation::kMostRegressors)
      throw base::InputError(recording.file, 0,
                             fmt::format("the inputs have {} numbers; expected 1 to {}", model_.inputs.size(),
                                         estimation::kMostRegressors));
    std::vector<std::string> output;
    add(wanted.output, output);
    model_.output = output[0];
    model_.rate = wanted.rate;
    signals_.back().count = 1;
    for (const InputBounds& each : wanted.where) bounds_.emplace_back(place_of(each.name), each);
    row_.assign(model_.inputs.size() + 1, kUnknownValue);
  }

  void append(IdentificationData& data) {
    if (data.signals.values.empty()) {
      data.model = model_;
      data.signals.inputs = static_cast<std::uint32_t>(model_.inputs.size());
    }
    if (data.model.inputs != model_.inputs || data.model.output != model_.output)
      throw base::InputError(recording_.file, 0, "its sensors differ from those of the recordings before");
    const double end = 1e-9 * static_cast<double>(recording_.end_time);
    if (!(end * wanted_.rate <= kMostSteps))
      throw base::InputError(
          recording_.file, 0,
          fmt::format("has {:.0f} s, more than {:.0f} steps at {:g} Hz", end, kMostSteps, wanted_.rate));
    data.signals.starts.push_back(data.signals.size());
    std::size_t next = 0;
    for (std::uint64_t step = 0;; ++step) {
      const std::int64_t now = base::nanoseconds(static_cast<double>(step) / wanted_.rate);
      if (now > recording_.end_time) break;
      for (; next < recording_.readings.size() && recording_.readings[next].delivered <= now; ++next)
        take(recording_.readings[next]);
      data.signals.values.insert(data.signals.values.end(), row_.begin(), row_.end());
      leave_out(std::span(data.signals.values).last(row_.size()));
      double& output = data.signals.values.back();
      if (!(output >= wanted_.least && output <= wanted_.most)) output = kUnknownValue;
    }
    for (std::size_t i = 0; i < signals_.size(); ++i)
      if (!signals_[i].seen)
        throw base::InputError(
            recording_.file, 0,
            fmt::format("has no readings of '{}' of '{}': record the run with --record-readings",
                        i < wanted_.inputs.size() ? wanted_.inputs[i] : wanted_.output, wanted_.robot));
  }

 private:
  std::size_t place_of(const std::string& name) const {
    const auto found = std::ranges::find(model_.inputs, name);
    if (found != model_.inputs.end()) return static_cast<std::size_t>(found - model_.inputs.begin());
    throw base::InputError(
        recording_.file, 0,
        fmt::format("the inputs have no '{}'; expected one of: {}", name, fmt::join(model_.inputs, ", ")));
  }

  /// Histories of a model end at such a step.
  void leave_out(std::span<double> step) const {
    for (const auto& [place, bounds] : bounds_)
      if (!(row_[place] >= bounds.least && row_[place] <= bounds.most))
        std::ranges::fill(step.first(model_.inputs.size()), kUnknownValue);
  }

  void add(const std::string& text, std::vector<std::string>& names) {
    const sensors::SensorType* type = nullptr;
    const sensors::SensorSpec& spec = spec_of(recording_, sensor_set_, mover_, text, type);
    const std::vector<std::string> own = sensors::signal_names(sensors::public_info(*type, spec));
    const std::size_t first = signals_.empty() ? 0 : signals_.back().first + signals_.back().count;
    signals_.push_back({type->id, spec.sensor, first, own.size()});
    names.insert(names.end(), own.begin(), own.end());
  }

  void take(const record::ReadingSample& reading) {
    if (reading.mover != mover_) return;
    for (Signal& signal : signals_) {
      if (reading.type != signal.type || reading.sensor != signal.sensor || reading.values.size() < signal.count)
        continue;
      std::copy_n(reading.values.begin(), signal.count, row_.begin() + static_cast<std::ptrdiff_t>(signal.first));
      signal.seen = true;
    }
  }

  const record::Recording& recording_;
  const IdentificationSignals& wanted_;
  world::World world_;
  sensors::SensorSet sensor_set_;
  std::uint32_t mover_;
  sensors::ModelFile model_;
  std::vector<Signal> signals_;
  std::vector<std::pair<std::size_t, InputBounds>> bounds_;  ///< by place in the row
  std::vector<double> row_;
};

}  // namespace

void add_recording(const record::Recording& recording, const IdentificationSignals& signals, IdentificationData& data) {
  Sampler(recording, signals).append(data);
}

std::vector<estimation::Structure> structures_of(std::span<const ModelKind> kinds, std::uint32_t inputs,
                                                 std::span<const std::uint32_t> lags,
                                                 std::span<const std::uint32_t> hidden) {
  std::vector<estimation::Structure> all;
  for (const ModelKind kind : kinds)
    for (const std::uint32_t lag : lags) {
      const std::uint32_t outputs = kind == ModelKind::network ? 0 : lag;
      if (std::size_t{inputs} * lag + outputs > estimation::kMostRegressors) continue;
      if (kind == ModelKind::arx) all.push_back({inputs, lag, outputs, 0});
      if (kind == ModelKind::arx) continue;
      for (const std::uint32_t sigmoids : hidden) all.push_back({inputs, lag, outputs, sigmoids});
    }
  return all;
}

std::string structure_name(const estimation::Structure& structure) {
  const std::string_view kind = structure.output_lags == 0 ? (structure.hidden == 0 ? "linear" : "network")
                                : structure.hidden == 0    ? "ARX"
                                                           : "NARX";
  return fmt::format("{}, {} step{}{}", kind, structure.input_lags, structure.input_lags == 1 ? "" : "s",
                     structure.hidden == 0 ? "" : fmt::format(", {} sigmoids", structure.hidden));
}

}  // namespace sf::scenarios
