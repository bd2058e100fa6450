#include "farm/faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/number_name.h"
#include "base/random.h"
#include "base/suggest.h"
#include "base/time.h"
#include "sensors/camera.h"
#include "sensors/sensor_set.h"

namespace sf::farm {

namespace {

using base::FaultKind;
using Group = sensors::SensorSet::Group;

constexpr std::uint32_t kWholeReading = 0xFFFFFFFFu;  // index of the draw for a reading as a whole
constexpr std::size_t kMostRules = 1'000'000;
constexpr std::size_t kReadingsPerPiece = 64;

[[noreturn]] void refuse_fault(const Fault& fault, const std::string& why) {
  throw base::InputError(fault.file, fault.line, why);
}

bool is_of_type(const Fault& fault, const sensors::SensorType& type) {
  return fault.type == type.name || fault.type == type.word.type || fault.type == type.other_word.type;
}

bool is_of_robot(const Fault& fault, const world::World& world, std::uint32_t mover) {
  return fault.robot == "*" || fault.robot == world.movers[mover].name;
}

bool alters_columns(FaultKind kind) {
  return kind < FaultKind::stuck || (kind > FaultKind::stuck && kind < FaultKind::swap);
}

/// A column, or one number of a vector.
struct ColumnPlace {
  std::string name;
  std::uint32_t offset, width;
  bool whole;
  bool is_range(const sensors::SensorSpec& row) const {
    return (name == "range_m" || name == "second_range_m" || name == "depth_m") && row.limit > row.range_min;
  }
};

/// @param name empty: the first column. Numbers of vectors are named as in CSV files
ColumnPlace column_of(const Fault& fault, const sensors::SensorType& type, const sensors::SensorSpec& row,
                      std::string_view name) {
  std::vector<ColumnPlace> places;
  std::uint32_t offset = 0;
  for (const sensors::Column& column : type.columns) {
    if (offset + column.width > sensors::element_width(type, row)) break;
    places.push_back({std::string(column.name), offset, column.width, column.whole});
    for (std::uint32_t k = 0; column.width > 1 && k < column.width; ++k)
      places.push_back({base::number_name(column, k), offset + k, 1, column.whole});
    offset += column.width;
  }
  std::vector<std::string_view> names;
  for (const ColumnPlace& place : places) {
    if (name.empty() || place.name == name) return place;
    names.push_back(place.name);
  }
  refuse_fault(fault, fmt::format("{} has no column '{}'{}", type.name, name, base::expected_one_of(name, names)));
}

void check_element(const Fault& fault, const sensors::SensorSpec& row, std::uint32_t element) {
  if (element >= row.elements)
    refuse_fault(fault, fmt::format("'{}' has no element {}; expected a number from 0 to {}", row.name, element,
                                    row.elements - 1));
}

/// @param row of cameras
bool is_grey(const Group& group, const sensors::SensorSpec& row) {
  return group.settings_as<sensors::CameraSettings>()[static_cast<std::size_t>(&row - group.rows.data())].mono;
}

std::int64_t nanoseconds_until(double seconds) {
  return seconds < 9e9 ? base::nanoseconds(seconds) : std::numeric_limits<std::int64_t>::max();
}

const Group& group_of(const Fault& fault, const sensors::SensorSet& sensor_set) {
  std::vector<std::string_view> names;
  for (const Group& group : sensor_set.groups()) {
    if (is_of_type(fault, *group.type)) return group;
    names.push_back(group.type->name);
  }
  refuse_fault(fault, fmt::format("no robot of the world has a sensor '{}'{}", fault.type,
                                  base::expected_one_of(fault.type, names)));
}

void check_robot(const Fault& fault, const world::World& world) {
  std::vector<std::string_view> names;
  for (std::uint32_t mover = 0; mover < world.movers.size(); ++mover) {
    if (is_of_robot(fault, world, mover)) return;
    names.push_back(world.movers[mover].name);
  }
  refuse_fault(fault, fmt::format("no robot is called '{}'{}", fault.robot,
                                  base::suggest(fault.robot, names, "expected a robot's name, or \"*\" for all")));
}

}  // namespace

void check_faults(std::span<const Fault> faults, const world::World& world, const sensors::SensorSet& sensor_set) {
  double held = 0.0;  // [byte]
  for (const Fault& fault : faults) {
    check_robot(fault, world);
    const Group& group = group_of(fault, sensor_set);
    std::size_t found = 0;
    for (const sensors::SensorSpec& row : group.rows) {
      if (row.sensor != fault.sensor || !is_of_robot(fault, world, row.mover)) continue;
      ++found;
      const double bytes = 256.0 + 16.0 * row.elements * static_cast<double>(sensors::element_width(*group.type, row));
      if (fault.kind == FaultKind::delay) held += bytes * (1.0 + row.rate * fault.amount);
    }
    if (found == 0)
      refuse_fault(fault, fmt::format("'{}' has no sensor {}:{}: sensors of one type are numbered per robot, from 0",
                                      fault.robot, fault.type, fault.sensor));
    if (held > kMostDelayed)
      refuse_fault(fault, fmt::format("delays up to here hold back {:.2g} GB of readings, more than {:g} GB; expected "
                                      "shorter delays, or fewer sensors",
                                      1e-9 * held, 1e-9 * kMostDelayed));
  }
  base::ThreadPool none(1);
  Faults(world, sensor_set, {faults.begin(), faults.end()}, 0, true, none);
}

Faults::Faults(const world::World& world, const sensors::SensorSet& sensor_set, std::vector<Fault> faults,
               std::uint64_t seed, bool noise, base::ThreadPool& thread_pool)
    : faults_(std::move(faults)), seed_(seed), noise_(noise), thread_pool_(thread_pool) {
  add_sensors(world, sensor_set);
}

/// Rows of earlier movers come first and keep their targets.
void Faults::add_sensors(const world::World& world, const sensors::SensorSet& sensor_set) {
  if (faults_.empty()) return;
  std::size_t rules = 0;
  types_.resize(64);
  for (const Group& group : sensor_set.groups()) {
    Type& type = types_[group.type->id];
    type.first = group.first;
    const std::size_t known = type.targets.size();
    type.targets.resize(group.rows.size(), 0);
    for (std::size_t i = known; i < group.rows.size(); ++i) {
      const sensors::SensorSpec& row = group.rows[i];
      Target target{.width = sensors::element_width(*group.type, row), .limits = sensors::limits_of(row)};
      for (std::uint32_t k = 0; k < faults_.size(); ++k) {
        const Fault& fault = faults_[k];
        if (row.sensor != fault.sensor || !is_of_type(fault, *group.type) || !is_of_robot(fault, world, row.mover))
          continue;
        if (++rules > kMostRules)
          refuse_fault(fault, fmt::format("faults up to here affect sensors more than {} times; expected fewer faults, "
                                          "or fewer robots",
                                          kMostRules));
        target.rules.push_back(rule_of(k, group, row));
        delays_ = delays_ || fault.kind == FaultKind::delay;
      }
      if (target.rules.empty()) continue;
      targets_.push_back(std::move(target));
      type.targets[i] = static_cast<std::uint32_t>(targets_.size());
    }
  }
}

Faults::Rule Faults::rule_of(std::uint32_t k, const Group& group, const sensors::SensorSpec& row) const {
  const Fault& fault = faults_[k];
  const sensors::SensorType& type = *group.type;
  Rule rule{k, nanoseconds_until(fault.from), nanoseconds_until(fault.until)};
  if (type.derived_from != 0 && (alters_columns(fault.kind) || fault.kind == FaultKind::swap))
    refuse_fault(fault,
                 fmt::format("'{}' cannot apply to {}, whose values are packed cells; expected stuck, dropout or "
                             "delay, or a fault of the sensor that it is computed from",
                             base::kFaultNames[static_cast<std::size_t>(fault.kind)], type.name));
  if (fault.element) check_element(fault, row, *fault.element);
  for (const std::uint32_t element : fault.swapped_elements) check_element(fault, row, element);
  if (!fault.swapped_columns.empty()) {
    const ColumnPlace one = column_of(fault, type, row, fault.swapped_columns[0]);
    const ColumnPlace other = column_of(fault, type, row, fault.swapped_columns[1]);
    if (one.width != other.width)
      refuse_fault(fault,
                   fmt::format("columns '{}' and '{}' of {} have different widths; expected columns of one width",
                               one.name, other.name, type.name));
    if (one.whole != other.whole || one.is_range(row) != other.is_range(row))
      refuse_fault(fault, fmt::format("columns '{}' and '{}' of {} are of different kinds; expected two ranges, two "
                                      "counts, or two other columns",
                                      one.name, other.name, type.name));
    rule.offset = one.offset, rule.other = other.offset, rule.width = one.width;
  }
  if (!alters_columns(fault.kind)) return rule;
  const ColumnPlace column = column_of(fault, type, row, fault.column);
  rule.offset = column.offset, rule.width = column.width, rule.whole = column.whole;
  rule.is_range = column.is_range(row);
  if (type.id == sensors::kCamera && column.name == "rgb") rule.channels = is_grey(group, row) ? 1 : 3;
  // Colours do not depend on an echo; all else of a beam does.
  const bool second = column.name.starts_with("second_");
  const ColumnPlace range = column_of(fault, type, row, second ? "second_range_m" : "");
  if (range.is_range(row) && !column.whole) rule.range = range.offset;
  if (fault.kind != FaultKind::noise) return rule;
  const double sigma = own_noise(group, row, column.offset);
  if (fault.multiplies && !(sigma > 0.0 && std::isfinite(sigma)))
    refuse_fault(fault,
                 fmt::format("the noise of column '{}' of '{}' cannot be multiplied: its standard deviation is {}; "
                             "expected sigma, the standard deviation to add",
                             column.name, row.name, sigma == 0.0 ? "0" : "not stated"));
  rule.sigma = fault.multiplies ? (noise_ ? sigma * std::sqrt(fault.amount * fault.amount - 1.0) : 0.0) : fault.amount;
  return rule;
}

const Faults::Target* Faults::target_of(const base::ReadingBlock& reading) const {
  const Type& type = types_[reading.type];
  if (type.targets.empty()) return nullptr;
  const std::uint32_t target = type.targets[type.first[reading.mover] + reading.sensor];
  return target == 0 ? nullptr : &targets_[target - 1];
}

Faults::Target* Faults::target_of(const base::ReadingBlock& reading) {
  return const_cast<Target*>(std::as_const(*this).target_of(reading));
}

base::RandomKey Faults::key(const Rule& rule, const base::ReadingBlock& reading) const {
  return {seed_, base::RandomStream::faults, reading.mover, rule.fault, reading.sequence};
}

/// Spikes are drawn per value instead.
bool Faults::strikes(const Rule& rule, const base::ReadingBlock& reading) const {
  if (reading.time < rule.from || reading.time >= rule.until) return false;
  const Fault& fault = faults_[rule.fault];
  return fault.kind == FaultKind::spikes || fault.probability >= 1.0 ||
         base::random_uniform(key(rule, reading), kWholeReading)[0] < fault.probability;
}

double Faults::altered(const Rule& rule, double value, const base::ReadingBlock& reading, std::uint32_t index) const {
  const Fault& fault = faults_[rule.fault];
  switch (fault.kind) {
    case FaultKind::bias:
      return value + fault.amount;
    case FaultKind::drift:
      return value + fault.amount * (1e-9 * static_cast<double>(reading.time - rule.from));
    case FaultKind::scale:
      return value * fault.amount;
    case FaultKind::quantization:
      return fault.amount * std::round(value / fault.amount);
    case FaultKind::noise:
      return value + rule.sigma * base::random_normal(key(rule, reading), index)[0];
    case FaultKind::spikes: {
      const auto [chance, sign] = base::random_uniform(key(rule, reading), index);
      return chance < fault.probability ? value + (sign < 0.5 ? -fault.amount : fault.amount) : value;
    }
    default:
      return value;
  }
}

double Faults::altered_color(const Rule& rule, double color, const base::ReadingBlock& reading,
                             std::uint32_t index) const {
  const auto before = static_cast<std::uint32_t>(color);
  std::uint32_t after = 0;
  for (std::uint32_t channel = 0; channel < rule.channels; ++channel) {
    const double value = altered(rule, before >> (16 - 8 * channel) & 255u, reading, 3 * index + channel);
    after = after << 8 | static_cast<std::uint32_t>(std::clamp(std::round(value), 0.0, 255.0));
  }
  return rule.channels == 1 ? 0x010101u * after : after;
}

/// @return whether a value was altered
bool Faults::alter_column(const Rule& rule, const base::ReadingBlock& reading, Target& target) const {
  const Fault& fault = faults_[rule.fault];
  bool any = fault.kind != FaultKind::spikes;
  for (std::size_t row = fault.element.value_or(0); row * target.width < target.values.size(); ++row) {
    const bool near = row < reading.quality.size() && reading.quality[row] == base::QualityFlag::too_near;
    const bool echo = !rule.range || (!near && target.values[row * target.width + *rule.range] < target.limits.max);
    for (std::size_t k = row * target.width + rule.offset, end = k + rule.width; k < end; ++k) {
      double& value = target.values[k];
      if (std::isnan(value) || !echo) continue;
      const double before = value;
      const auto index = static_cast<std::uint32_t>(k);
      value = rule.channels > 0 ? altered_color(rule, value, reading, index) : altered(rule, value, reading, index);
      if (rule.is_range) value = std::clamp(value, target.limits.min, target.limits.max);
      if (rule.whole) value = std::clamp(std::round(value), 0.0, 4294967295.0);
      any = any || value != before;
    }
    if (fault.element) break;
  }
  return any;
}

void Faults::swap(const Rule& rule, base::ReadingBlock& reading, Target& target) const {
  const auto& rows = faults_[rule.fault].swapped_elements;
  double* const values = target.values.data();
  const std::size_t width = target.width, count = target.values.size() / width;
  if (rows.empty()) {
    for (std::size_t row = 0; row < count; ++row)
      std::swap_ranges(values + row * width + rule.offset, values + row * width + rule.offset + rule.width,
                       values + row * width + rule.other);
    return;
  }
  if (std::max(rows[0], rows[1]) >= count) return;
  std::swap_ranges(values + rows[0] * width, values + (rows[0] + 1) * width, values + rows[1] * width);
  if (reading.hits.size() == count) {
    if (reading.hits.data() != target.hits.data()) target.hits.assign(reading.hits.begin(), reading.hits.end());
    std::swap(target.hits[rows[0]], target.hits[rows[1]]);
    reading.hits = target.hits;
  }
  if (reading.quality.size() == count) {
    if (reading.quality.data() != target.quality.data())
      target.quality.assign(reading.quality.begin(), reading.quality.end());
    std::swap(target.quality[rows[0]], target.quality[rows[1]]);
    reading.quality = target.quality;
  }
}

/// Repeats the last reading that this fault did not affect. @return whether there was one
bool Faults::hold(Rule& rule, base::ReadingBlock& reading, Target& target) const {
  if (strikes(rule, reading) && rule.holds) {
    target.values = rule.values, target.hits = rule.hits, target.quality = rule.quality;
    reading.values = target.values, reading.hits = target.hits, reading.quality = target.quality;
    return true;
  }
  if (reading.time >= rule.until) return false;
  rule.values.assign(reading.values.begin(), reading.values.end());
  rule.hits.assign(reading.hits.begin(), reading.hits.end());
  rule.quality.assign(reading.quality.begin(), reading.quality.end());
  rule.holds = true;
  return false;
}

/// @return the kinds of faults that affect the reading
std::uint16_t Faults::alter(base::ReadingBlock& reading, Target& target) const {
  std::uint16_t kinds = 0;
  bool owned = false;  // whether the reading's values are the target's
  for (Rule& rule : target.rules) {
    const FaultKind kind = faults_[rule.fault].kind;
    if (kind == FaultKind::stuck) {
      if (!hold(rule, reading, target)) continue;
      owned = true;
    } else {
      if (!strikes(rule, reading)) continue;
      if (kind == FaultKind::dropout) return base::fault_bit(kind);
      if (kind != FaultKind::delay && !std::exchange(owned, true)) {
        target.values.assign(reading.values.begin(), reading.values.end());
        reading.values = target.values;
      }
      if (kind == FaultKind::swap) swap(rule, reading, target);
      if (alters_columns(kind) && !alter_column(rule, reading, target)) continue;
    }
    kinds |= base::fault_bit(kind);
  }
  if ((kinds & ~base::fault_bit(FaultKind::delay)) != 0)
    reading.bound = reading.bound_without_noise = reading.sigma = HUGE_VAL;
  return kinds;
}

/// @return false if the reading is lost
bool Faults::note(const base::ReadingBlock& reading, std::uint16_t kinds) {
  if (kinds == 0) return true;
  marks_.push_back({reading.mover, reading.sensor, reading.type, reading.sequence, reading.time, kinds});
  for (std::size_t kind = 0; kind < counts_.size(); ++kind) counts_[kind] += kinds >> kind & 1u;
  return (kinds & base::fault_bit(FaultKind::dropout)) == 0;
}

bool Faults::apply(base::ReadingBlock& reading) {
  Target* const target = target_of(reading);
  return target == nullptr || note(reading, alter(reading, *target));
}

void Faults::apply(std::vector<base::ReadingBlock>& readings, std::size_t first) {
  kinds_.assign(readings.size(), 0);
  thread_pool_.parallel_for_each(readings.size() - first, kReadingsPerPiece, [&](std::size_t i, unsigned) {
    base::ReadingBlock& reading = readings[first + i];
    if (Target* const target = target_of(reading); target != nullptr) kinds_[first + i] = alter(reading, *target);
  });
  std::size_t kept = first;
  for (std::size_t i = first; i < readings.size(); ++i)
    if (note(readings[i], kinds_[i])) readings[kept++] = readings[i];
  readings.resize(kept);
}

std::int64_t Faults::delay_of(const base::ReadingBlock& reading) const {
  const Target* const target = delays_ ? target_of(reading) : nullptr;
  std::int64_t delay = 0;
  for (std::size_t k = 0; target != nullptr && k < target->rules.size(); ++k) {
    const Rule& rule = target->rules[k];
    const Fault& fault = faults_[rule.fault];
    if (fault.kind == FaultKind::delay && strikes(rule, reading)) delay += base::nanoseconds(fault.amount);
  }
  return delay;
}

}  // namespace sf::farm
