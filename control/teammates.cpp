#include "control/teammates.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

namespace sf::control {

namespace {

constexpr double kPassing = 0.1;                // [m] planned between two bodies
constexpr double kTooClose = 0.05;              // [m] between two bodies: stops
constexpr double kBodyError = 0.1;              // [m] a body may have moved since the scan
constexpr std::int64_t kEvery = 1'000'000'000;  // [ns] between publications of measurements

glm::dvec2 place_of(const base::Report& state) { return {state.X_WM.x, state.X_WM.y}; }

}  // namespace

bool Teammates::merge(const TeammateMap& teammate, ExplorationMap& map) {
  const SharedMap& shared = *teammate.map;
  if (!(shared.geometry == map.grid().geometry))
    throw base::InputError(
        fmt::format("controller 'explore': the maps of the robots with ids {} and {} cover different areas; expected "
                    "the same `cell`, `map_left`, `map_top`, `map_width` and `map_height` for all robots of a team",
                    settings_.id, teammate.id));
  Merged& merged = merged_[teammate.id];
  if (merged.count > shared.changes.size() || (merged.count > 0 && shared.changes[merged.count - 1] != merged.last))
    merged = {};
  bool news = false;
  for (; merged.count < shared.changes.size(); ++merged.count) {
    merged.last = shared.changes[merged.count];
    news = map.merge(*merged.last) || news;
  }
  return news;
}

bool Teammates::update(const ControllerInput& input, ExplorationMap& map) {
  here_ = place_of(input.state);
  places_.clear();
  claimants_.clear();
  bool news = false;
  for (const Neighbour& other : input.others) {
    places_.push_back(place_of(other.state));
    const auto has_id = [&](const TeammateMap& teammate) { return teammate.id == other.id; };
    const auto teammate = std::find_if(maps_.begin(), maps_.end(), has_id);
    if (teammate == maps_.end()) continue;
    claimants_.push_back({other.id, places_.back(), teammate->map});
    news = merge(*teammate, map) || news;
  }
  return news;
}

bool Teammates::claimed(maps::CellAt cell, const ExplorationMap& map) const {
  const maps::GridGeometry& geometry = map.grid().geometry;
  const glm::dvec2 p = maps::middle(geometry, cell);
  const double own = glm::length(p - here_);
  return std::any_of(claimants_.begin(), claimants_.end(), [&](const Claimant& other) {
    const double far = glm::length(p - other.p);
    if (far > own || (far == own && other.id > settings_.id)) return false;
    return std::binary_search(other.map->claim.begin(), other.map->claim.end(), map.key(cell));
  });
}

bool Teammates::is_body(glm::dvec2 p) const {
  return std::any_of(places_.begin(), places_.end(),
                     [&](glm::dvec2 other) { return glm::length(other - p) < settings_.others + kBodyError; });
}

bool Teammates::blocks(glm::dvec2 p) const {
  return std::any_of(places_.begin(), places_.end(), [&](glm::dvec2 other) {
    const double then = glm::length(other - p);
    return then < settings_.radius + settings_.others + kTooClose && then < glm::length(other - here_);
  });
}

void Teammates::add_bodies(ExplorationMap& map) const {
  std::vector<double> distances;
  for (const glm::dvec2& other : places_)  // a robot within the distance may leave
    distances.push_back(std::max(
        0.0, std::min(settings_.radius + settings_.others + kPassing, glm::length(other - here_) - map.cell())));
  map.set_bodies(places_, distances);
}

void Teammates::publish(std::int64_t time, std::vector<std::int64_t> claim, ExplorationMap& map) {
  const bool due = !published_ || time - published_at_ >= kEvery, same = published_ && claim == published_->claim;
  MapChanges changes = due ? map.take_changes() : MapChanges{};
  if (same && changes.empty()) return;
  auto next = published_ ? std::make_shared<SharedMap>(*published_) : std::make_shared<SharedMap>();
  next->geometry = map.grid().geometry;
  next->claim = std::move(claim);
  if (due) published_at_ = time;
  if (!changes.empty()) next->changes.push_back(std::make_shared<const MapChanges>(std::move(changes)));
  published_ = std::move(next);
}

}  // namespace sf::control
