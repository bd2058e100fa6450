#include "apps/reports/rate_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "apps/reports/text.h"
#include "base/time.h"
#include "farm/schedule.h"

namespace sf::apps {

namespace {

constexpr double kManyTimes = 1000.0;  // [1/s]

bool due_between(const sensors::SensorSpec& sensor, std::int64_t interval) {
  const auto between = [&](std::uint64_t k) { return farm::due_time(k, sensor.rate, sensor.phase) % interval != 0; };
  return between(0) || between(1) || between(1000);
}

}  // namespace

std::pair<double, double> rates_of(const sensors::SensorSet::Group& group) {
  const auto by_rate = [](const sensors::SensorSpec& p, const sensors::SensorSpec& q) { return p.rate < q.rate; };
  const auto [least, most] = std::minmax_element(group.rows.begin(), group.rows.end(), by_rate);
  return {least->rate, most->rate};
}

std::string rate_text(const sensors::SensorSet::Group& group) {
  const auto [least, most] = rates_of(group);
  return least == most ? fmt::format("{} {:g} Hz", group.type->name, most)
                       : fmt::format("{} {:g} to {:g} Hz", group.type->name, least, most);
}

std::vector<std::string> types_between_ticks(const sensors::SensorSet& sensor_set, double interval) {
  std::vector<std::string> types;
  const auto ticks = std::max<std::int64_t>(1, base::nanoseconds(interval));
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    if (std::any_of(group.rows.begin(), group.rows.end(), [&](const auto& row) { return due_between(row, ticks); }))
      types.emplace_back(group.type->name);
  return types;
}

void warn_of_fast_sensors(const sensors::SensorSet& sensor_set, double rate) {
  std::size_t fast = 0;
  double most = 0.0;
  std::string types;
  for (const sensors::SensorSet::Group& group : sensor_set.groups()) {
    const auto faster = [&](const sensors::SensorSpec& row) { return row.rate > rate * (1.0 + 1e-9); };
    const auto count = std::count_if(group.rows.begin(), group.rows.end(), faster);
    if (count == 0) continue;
    fast += static_cast<std::size_t>(count);
    most = std::max(most, rates_of(group).second);
    types += (types.empty() ? "" : ", ") + rate_text(group);
  }
  if (fast > 0)
    print_message(
        "--rate {:g} is too low for {} ({}): they give one reading per tick; leave out --rate to read them at their "
        "own times, or give at least --rate {:g}",
        rate, counted(fast, "sensor"), types, most);
}

void warn_of_many_times(const sensors::SensorSet& sensor_set) {
  std::set<std::pair<double, std::int64_t>> times;  // rate, and phase within a period
  for (const sensors::SensorSet::Group& group : sensor_set.groups())
    for (const sensors::SensorSpec& row : group.rows)
      times.emplace(row.rate, base::nanoseconds(std::fmod(row.phase, 1.0 / row.rate)));
  double a_second = 0.0;
  for (const auto& [rate, phase] : times) a_second += rate;
  if (a_second > kManyTimes)
    print_message(
        "sensors are due at up to {:.0f} different times per second, each in its own batch, which is slow; lower their "
        "rates, or give them the same rate and phase",
        a_second);
}

}  // namespace sf::apps
