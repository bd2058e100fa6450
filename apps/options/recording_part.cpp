#include "apps/options/recording_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/options/robot_names.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "scenarios/recording_merge.h"

namespace sf::apps {

namespace {

std::vector<std::uint8_t> chosen_of(const record::Recording& recording, const std::vector<std::string>& robots) {
  const auto& movers = recording.info.movers;
  std::vector<std::uint8_t> chosen(movers.size(), robots.empty());
  std::vector<std::string_view> names;
  for (const auto& mover : movers) names.push_back(mover.name);
  for (const std::string& name : robot_names(robots, names)) {
    const auto found =
        std::find_if(movers.begin(), movers.end(), [&](const auto& mover) { return mover.name == name; });
    if (found != movers.end()) {
      chosen[static_cast<std::size_t>(found - movers.begin())] = 1;
      continue;
    }
    throw base::InputError(recording.file, 0, fmt::format("has no robot '{}'; it has {}", name, list_names(names)));
  }
  return chosen;
}

}  // namespace

RecordingPart open_part(const std::string& directory, const PartOption& wanted) {
  RecordingPart part{scenarios::open_run(directory), {}, 0.0, {}};
  record::Recording& recording = part.recording;
  print_damage(recording);
  part.chosen = chosen_of(recording, wanted.robots);
  const auto outside = [&](const auto& sample) {
    const double time = 1e-9 * static_cast<double>(sample.time);
    return time < wanted.from - 1e-9 || time > wanted.to + 1e-9;
  };
  std::int64_t first = INT64_MAX, last = INT64_MIN;
  for (auto& states : recording.states) {
    const auto begin = std::ranges::find_if_not(
        states, [&](const auto& sample) { return 1e-9 * static_cast<double>(sample.time) < wanted.from - 1e-9; });
    part.before.emplace_back(states.begin(), begin);
    std::erase_if(states, outside);
    if (states.empty()) continue;
    first = std::min(first, states.front().time);
    last = std::max(last, states.back().time);
  }
  const std::string until = std::isfinite(wanted.to) ? fmt::format(" to {:g} s", wanted.to) : " on";
  if (last < first && recording.ticks > 0)
    throw base::InputError(recording.file, 0,
                           fmt::format("has no tick from {:g} s{}; it covers 0 to {:g} s{}", wanted.from, until,
                                       1e-9 * static_cast<double>(recording.end_time),
                                       wanted.from > wanted.to ? ", and --from must be below --to" : ""));
  std::erase_if(recording.lights, outside);
  std::erase_if(recording.readings,
                [&](const auto& reading) { return outside(reading) || part.chosen[reading.mover] == 0; });
  part.seconds = last < first ? 0.0 : 1e-9 * static_cast<double>(last - first);
  return part;
}

}  // namespace sf::apps
