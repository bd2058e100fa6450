#include "scenarios/recorded_states.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "scenarios/foreign_sensors.h"
#include "world/append_robot.h"
#include "world/shapes.h"

namespace sf::scenarios {

world::World recorded_world(const record::Recording& recording) {
  if (!record::option_of(recording.info, kTimeZero).empty()) add_foreign_types(recording.info);
  world::World world = world::from_snapshot(recording.info.snapshot);
  for (const record::JoinedMover& joined : recording.info.joined) {
    if (joined.original >= world.movers.size())
      throw base::InputError(recording.file, 0,
                             fmt::format("'{}' joined as a copy of row {}, which does not exist in its world",
                                         joined.name, joined.original));
    world::append_robot(world, joined.original, joined.name, joined.X_WM);
  }
  if (world.movers.size() != recording.states.size())
    throw base::InputError(
        recording.file, 0,
        fmt::format("has the states of {} movers, but its world has {}: the two do not belong together",
                    recording.states.size(), world.movers.size()));
  return world;
}

bool has_all_states(const record::Recording& recording) {
  const auto& all = recording.states;
  return std::all_of(all.begin(), all.end(), [&](const auto& s) { return s.size() == all[0].size(); });
}

void recorded_reports(const record::Recording& recording, std::size_t tick, std::vector<base::Report>& reports) {
  reports.clear();
  for (std::uint32_t m = 0; m < recording.states.size(); ++m)
    reports.push_back(record::report_of(recording.states[m][tick], m));
}

bool RecordedShapes::go_to(std::int64_t time) {
  bool outlines = false;
  changed_.clear();
  if (next_ > 0 && time < shapes_[next_ - 1].time) {
    next_ = 0;
    changed_ = world::restore_originals(world_);
    outlines = !changed_.empty();
  }
  for (; next_ < shapes_.size() && shapes_[next_].time <= time; ++next_)
    for (const base::ShapeState& state : shapes_[next_].shapes) {
      outlines |= world::restore_shape(world_, state);
      changed_.push_back(state);
    }
  return outlines;
}

void set_absent(std::span<const base::Report> reports, farm::Farm& farm) {
  for (const base::Report& report : reports) {
    const bool gone = base::is_absent(report.X_WM);
    farm.set_absent(report.mover, gone);
    if (!gone) farm.subscribe(report.mover, farm::kAllSensorTypes);
  }
}

}  // namespace sf::scenarios
