#include "control/route_goals.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "base/random.h"
#include "world/roads/mdf.h"

namespace sf::control {

namespace {

using world::PointRef;

std::string ids_of(const world::RoadNetwork& roads) {
  std::string ids;
  for (const world::RoadCheckpoint& checkpoint : roads.checkpoints) {
    if (ids.size() > 120) return ids + ", ...";
    ids += (ids.empty() ? "" : ", ") + std::to_string(checkpoint.id);
  }
  return ids.empty() ? "it has none" : ids;
}

/// Returns the path as given, or relative to the world file's folder if the file exists only there.
std::string find_file(const world::World& world, const std::string& file) {
  if (std::filesystem::exists(file)) return file;
  const auto beside = std::filesystem::path(world.file).parent_path() / file;
  return std::filesystem::exists(beside) ? beside.string() : file;
}

}  // namespace

RouteGoals::RouteGoals(const ControllerContext& context)
    : tour_(true), seed_(context.seed), robot_(context.row_in_copy()) {
  draw_from(*context.roads);
}

void RouteGoals::draw_from(const world::RoadNetwork& roads) {
  for (const auto& checkpoint : roads.checkpoints)
    if (checkpoint.at.kind == PointRef::Kind::lane) lots_.push_back(checkpoint);
}

RouteGoals::RouteGoals(const ControllerContext& context, Settings& settings)
    : seed_(context.seed), robot_(context.row_in_copy()) {
  const world::RoadNetwork& roads = *context.roads;
  for (const double number : settings.numbers("checkpoints", {})) {
    const auto* checkpoint = find_checkpoint(roads, static_cast<int>(number));
    if (checkpoint == nullptr || checkpoint->id != number)
      settings.refuse("checkpoints",
                      fmt::format("'checkpoints' names {:g}, which '{}' does not have; expected some of {}", number,
                                  roads.file, ids_of(roads)));
    goals_.push_back(*checkpoint);
  }
  const std::string mission = settings.text("mission", "");
  if (!mission.empty()) read_mission(context, mission);
  read_park(context, settings);
  loop_ = settings.flag("loop", false);
  tour_ = settings.flag("tour", false);
  if (tour_) draw_from(roads);
  if (tour_ && !goals_.empty())
    settings.refuse("tour", "'tour' draws random checkpoints; expected no list of checkpoints");
  if (goals_.empty() && lots_.empty())
    settings.refuse("checkpoints",
                    fmt::format("no destination; expected 'checkpoints' (some of {}), 'mission', 'park' or 'tour true'",
                                ids_of(roads)));
}

void RouteGoals::read_mission(const ControllerContext& context, const std::string& file) {
  const world::RoadNetwork& roads = *context.roads;
  const world::Mdf mdf = world::read_mdf(find_file(context.world, file));
  if (context.warnings != nullptr)
    context.warnings->insert(context.warnings->end(), mdf.warnings.begin(), mdf.warnings.end());
  for (const world::MdfCheckpoint& row : mdf.checkpoints) {
    const auto* checkpoint = find_checkpoint(roads, row.id);
    if (checkpoint == nullptr)
      throw base::InputError(
          mdf.file, row.line,
          fmt::format("checkpoint {} is not in '{}'; expected one of {}", row.id, roads.file, ids_of(roads)));
    goals_.push_back(*checkpoint);
  }
  limits_.assign(roads.segments.size(), HUGE_VAL);
  for (const world::SpeedLimit& limit : mdf.speed_limits)
    for (std::size_t i = 0; i < roads.segments.size(); ++i)
      if (roads.segments[i].id == limit.id && limit.most_mph > 0.0)
        limits_[i] = limit.most_mph * world::kMilePerHour * roads.scale;
}

void RouteGoals::read_park(const ControllerContext& context, Settings& settings) {
  const std::string name = settings.text("park", "");
  if (name.empty()) return;
  const world::RoadNetwork& roads = *context.roads;
  for (std::uint32_t row = 0; row < roads.spots.size(); ++row) {
    const world::RoadSpot& spot = roads.spots[row];
    if (fmt::format("{}.{}", roads.zones[spot.zone].id, spot.number) != name) continue;
    // The checkpoint of the spot, if it has one.
    world::RoadCheckpoint goal{-1, {PointRef::Kind::spot, row, 1}, spot.end};
    for (const auto& checkpoint : roads.checkpoints)
      if (checkpoint.at.kind == PointRef::Kind::spot && checkpoint.at.row == row) goal.id = checkpoint.id;
    goals_.push_back(goal);
    return;
  }
  settings.refuse("park", fmt::format("there is no parking spot '{}' in '{}'; expected zone.spot", name, roads.file));
}

const world::RoadCheckpoint* RouteGoals::at(std::uint64_t k) const {
  if (tour_) {
    if (lots_.empty()) return nullptr;
    const base::RandomKey draw{
        .seed = seed_, .stream = base::RandomStream::decision, .a = robot_, .b = 0x746F7572u, .c = k};
    const double u = base::random_uniform(draw, 0)[0];
    const auto i = static_cast<std::size_t>(u * static_cast<double>(lots_.size()));
    return &lots_[std::min(i, lots_.size() - 1)];
  }
  if (k >= goals_.size() && !loop_) return nullptr;
  return &goals_[k % goals_.size()];
}

}  // namespace sf::control
