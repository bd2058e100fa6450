#include "sensors/road_links.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.h"
#include "base/suggest.h"
#include "sensors/settings.h"
#include "world/roads/roads.h"
#include "world/wall_tree.h"

namespace sf::sensors {

namespace {

constexpr double kLeastCosine = 0.5;                   // between a link and a vehicle on it
constexpr double kPolylineReach = 1.0;                 // [m]
constexpr double kLeastLink = 1e-3, kMostReach = 1e3;  // [m]

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

RoadLink read_polyline(const world::Sensor& sensor, std::uint32_t i) {
  constexpr const char* kMeaning = "[x y x y ...], at least two points that differ, in driving direction";
  const std::string key = fmt::format("link[{}]", i);
  const auto numbers = tuple(sensor, key, 4, kMeaning);
  if (!numbers) refuse(sensor, "links", fmt::format("'{}' is missing", key));
  RoadLink link{std::to_string(i), {}, kPolylineReach};
  for (std::size_t k = 0; k + 1 < numbers->size(); k += 2) {
    const glm::dvec2 p = sensor.metres_per_unit * glm::dvec2((*numbers)[k], (*numbers)[k + 1]);
    if (link.points.empty() || p != link.points.back()) link.points.push_back(p);
  }
  if (numbers->size() % 2 != 0 || link.points.size() < 2)
    refuse(sensor, key, fmt::format("'{}' expects {}", key, kMeaning));
  return link;
}

std::vector<RoadLink> read_lanes(const world::World& world, const world::Sensor& sensor, const std::string& text) {
  const auto network = world::roads_of(world);
  if (text.empty() || !network)
    refuse(sensor, "lanes",
           network ? "'lanes' expects [\"segment.lane\" ...], or \"all\""
                   : "'lanes' are those of the world's road( rndf FILE ), which it does not have");
  std::vector<RoadLink> links;
  std::vector<std::string> names;
  for (const world::RoadLane& lane : network->lanes) names.push_back(lane_name(*network, lane));
  const auto add = [&](std::size_t row) {
    const world::RoadLane& lane = network->lanes[row];
    if (length_of(lane) >= kLeastLink) links.push_back({names[row], lane.centre.points, 0.5 * lane.width});
  };
  if (text == "all") {
    for (std::size_t row = 0; row < names.size(); ++row) add(row);
    return links;
  }
  const std::vector<std::string_view> known(names.begin(), names.end());
  for (const std::string_view name : lines_of(text)) {
    const auto found = std::ranges::find(names, name);
    if (found == names.end())
      refuse(sensor, "lanes", fmt::format("the road network has no lane '{}'{}", name, base::suggest(name, known)));
    const std::size_t before = links.size();
    add(static_cast<std::size_t>(found - names.begin()));
    if (links.size() == before) refuse(sensor, "lanes", fmt::format("lane '{}' has no length", name));
  }
  return links;
}

}  // namespace

RoadLinks::RoadLinks(std::vector<RoadLink> links) : links_(std::move(links)) {
  std::vector<base::Box> boxes;
  for (std::uint32_t row = 0; row < links_.size(); ++row) {
    RoadLink& link = links_[row];
    link.s.assign(1, 0.0);
    for (std::uint32_t k = 0; k + 1 < link.points.size(); ++k) {
      const glm::dvec2 a = link.points[k], b = link.points[k + 1], wide(link.reach);
      link.s.push_back(link.s.back() + glm::distance(a, b));
      pieces_.push_back({row, k});
      boxes.push_back(base::box_of(glm::min(a, b) - wide, glm::max(a, b) + wide));
    }
  }
  tree_ = base::BoxTree(boxes);
}

std::optional<LinkPlace> RoadLinks::find(glm::dvec2 p, std::optional<double> yaw) const {
  std::optional<LinkPlace> found;
  double nearest = HUGE_VAL;
  std::uint32_t best = 0;
  tree_.any(base::box_of(p, p), [&](std::uint32_t i) {
    const auto [row, k] = pieces_[i];
    const RoadLink& link = links_[row];
    const glm::dvec2 a = link.points[k], along = link.points[k + 1] - a;
    const double length = glm::length(along);
    if (yaw && dot(along, base::direction(*yaw)) < kLeastCosine * length) return false;
    const double t = std::clamp(dot(p - a, along) / (length * length), 0.0, 1.0);
    const double distance = glm::distance(p, a + t * along);
    // Pieces come in the tree's order: ties go to the first.
    if (distance > link.reach || distance > nearest || (distance == nearest && i > best)) return false;
    nearest = distance, best = i;
    found = LinkPlace{row, link.s[k] + t * length};
    return false;
  });
  return found;
}

double RoadLinks::driven(std::uint32_t row, double from, double to) const {
  const RoadLink& link = links_[row];
  const double length = link.length(), metres = to - from;
  if (std::abs(metres) <= 0.5 * length || glm::distance(link.points.front(), link.points.back()) > link.reach)
    return metres;
  return metres - std::copysign(length, metres);
}

RoadLinks read_road_links(const world::World& world, const world::Sensor& sensor) {
  const world::Setting* const lanes = find(sensor, "lanes");
  const std::uint32_t count = whole(sensor, "links", 0, 1, kMostLinks);
  refuse_beyond(sensor, "link[", "links", count, kMostLinks);
  if ((lanes != nullptr) == (count > 0))
    refuse(sensor, lanes == nullptr ? "" : "lanes",
           "expected either 'lanes' of the world's road network, or 'links' with link[0], link[1], ...");
  std::vector<RoadLink> links;
  if (lanes != nullptr) links = read_lanes(world, sensor, lanes->text);
  for (std::uint32_t i = 0; i < count; ++i) links.push_back(read_polyline(sensor, i));
  if (links.empty() || links.size() > kMostLinks)
    refuse(sensor, "lanes", fmt::format("there are {} lanes; expected 1 to {}", links.size(), kMostLinks));
  for (RoadLink& link : links) link.reach = length(sensor, "reach", link.reach, kLeastLink, kMostReach);
  return RoadLinks(std::move(links));
}

std::vector<std::uint32_t> read_link_route(const world::Sensor& sensor, const RoadLinks& links) {
  const world::Setting* const setting = find(sensor, "route");
  if (setting == nullptr) return {};
  const auto expected = [&] {
    refuse(
        sensor, "route",
        fmt::format("'route' expects [0 1 ...], numbers of links below {}, or names of lanes", links.links().size()));
  };
  std::vector<std::uint32_t> rows;
  for (const double number : setting->numbers) {
    if (!(number >= 0.0 && number < static_cast<double>(links.links().size()) && number == std::floor(number)))
      expected();
    rows.push_back(static_cast<std::uint32_t>(number));
  }
  for (const std::string_view name : lines_of(setting->text)) {
    const auto found = std::ranges::find(links.links(), name, &RoadLink::name);
    if (found == links.links().end()) refuse(sensor, "route", fmt::format("'route': there is no link '{}'", name));
    rows.push_back(static_cast<std::uint32_t>(found - links.links().begin()));
  }
  if (rows.empty()) expected();
  return rows;
}

}  // namespace sf::sensors
