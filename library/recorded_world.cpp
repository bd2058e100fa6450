#include "library/recorded_world.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace sf::library {

namespace {

world::World alone(const world::World& worlds, std::uint32_t copy) {
  if (copy >= worlds.copies)
    throw base::InputError(fmt::format("there is no world {} to record; expected less than {}", copy, worlds.copies));
  const std::size_t movers = worlds.movers.size() / worlds.copies;
  world::World world = worlds;
  world.copies = 1;
  const auto keep = [&](auto& rows) {
    rows.erase(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(copy * movers));
    rows.resize(movers);
  };
  keep(world.movers);
  if (!world.variations.empty()) keep(world.variations);
  world::update_extent_and_hash(world);
  return world;
}

}  // namespace

RecordedWorld::RecordedWorld(const world::World& worlds, std::uint32_t copy)
    : copy_(copy),
      first_(copy * static_cast<std::uint32_t>(worlds.movers.size() / worlds.copies)),
      world_(alone(worlds, copy)),
      sensor_set_(world_) {}

base::TickRecord RecordedWorld::part_of(const base::TickRecord& all) {
  const std::size_t movers = world_.movers.size();
  base::TickRecord part = all;
  reports_.assign(all.reports.begin() + first_, all.reports.begin() + static_cast<std::ptrdiff_t>(first_ + movers));
  for (base::Report& report : reports_) report.mover -= first_;
  readings_.clear();
  for (const base::ReadingBlock& reading : all.readings)
    if (reading.mover >= first_ && reading.mover < first_ + movers) readings_.emplace_back(reading).mover -= first_;
  part.reports = reports_, part.readings = readings_;
  part.commands = all.commands.subspan(first_, movers);
  part.contacts = all.contacts.subspan(first_, movers);
  return part;
}

}  // namespace sf::library
