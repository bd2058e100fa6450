#include "viz/town_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/error.h"
#include "viz/axes.h"
#include "viz/color.h"
#include "viz/mover_layer.h"
#include "viz/road_layer.h"
#include "viz/signal_layer.h"
#include "viz/theme.h"
#include "viz/wall_layer.h"
#include "world/roads/roads.h"

namespace sf::viz {
namespace {

using world::World;

/// Up to this number, all tracks are as thick as those of convoys.
constexpr std::size_t kFew = 12;

enum class Group { car, convoy, other };

std::uint32_t color_of(Group group) {
  return group == Group::car ? theme::kCar : group == Group::convoy ? theme::kVermillion : theme::kOtherRobot;
}

/// Groups movers: followers and followed movers form convoys; movers of an uncommon size form a separate group.
std::vector<Group> groups_of(const World& world, const TownFinalState& end) {
  std::map<double, int> sizes;
  for (const std::uint32_t row : end.movers) ++sizes[world.movers[row].radius];
  const auto most =
      std::max_element(sizes.begin(), sizes.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<Group> groups;
  for (const std::uint32_t row : end.movers)
    groups.push_back(world.movers[row].radius == most->first ? Group::car : Group::other);
  for (std::size_t i = 0; i < end.follows.size(); ++i)
    if (end.follows[i] != world::kNone) groups[i] = groups[end.follows[i]] = Group::convoy;
  return groups;
}

std::string subtitle_of(const World& world, std::span<const Track> tracks, const TownFinalState& end) {
  double metres = 0.0;
  std::size_t contacts = 0;
  for (const Track& track : tracks) {
    metres += path_length(track);
    contacts += contact_count(track);
  }
  return fmt::format("{}: {} robots, {:.4g} s, {:.0f} m driven, {} contact{}; robots and lights at the end", world.name,
                     tracks.size(), end.time, metres, contacts, contacts == 1 ? "" : "s");
}

FigureOptions plan_of(const World& world, std::span<const Track> tracks, const TownFinalState& end,
                      const std::vector<Group>& groups) {
  FigureOptions options;
  options.title = "Town traffic";
  options.subtitle = subtitle_of(world, tracks, end);
  options.extent = world.extent;
  options.legend = wall_legend(world, WallColors::of_models);
  options.legend.push_back({LegendMark::block, theme::kAsphaltBand, "street with markings"});
  const auto has = [&](Group group) { return std::find(groups.begin(), groups.end(), group) != groups.end(); };
  const auto add = [&](Group group, const char* body, const char* way) {
    if (!has(group)) return;
    options.legend.push_back({LegendMark::robot, color_of(group), body});
    options.legend.push_back({LegendMark::line, color_of(group), way});
  };
  add(Group::car, "car", "its route");
  add(Group::convoy, "in a convoy", "its route");
  if (has(Group::convoy)) options.legend.push_back({LegendMark::line, theme::kInk, "follows"});
  if (has(Group::other)) options.legend.push_back({LegendMark::dot, theme::kOtherRobot, "pedestrian"});
  for (const LegendItem& item : lights_legend(world, end.time)) options.legend.push_back(item);
  if (std::any_of(tracks.begin(), tracks.end(), [](const Track& t) { return contact_count(t) > 0; }))
    options.legend.push_back({LegendMark::cross, theme::kContact, "contact"});
  return options;
}

/// Draws a line from the centre of the follower to the edge of the robot ahead, with an arrow head at its end.
void draw_tie(Axes& axes, const base::Pose& from, const base::Pose& to, double radius) {
  const glm::dvec2 a = axes.pixel({from.x, from.y});
  const glm::dvec2 d = axes.pixel({to.x, to.y}) - a;
  const double far = length(d);
  if (far < 1.0) return;
  const glm::dvec2 along = (1.0 / far) * d;
  const glm::dvec2 across{-along.y, along.x};
  const glm::dvec2 tip = a + (far - radius * axes.scale()) * along;
  axes.canvas().line(a, tip - 6.0 * along, 3.0, theme::kInk);
  const glm::dvec2 head[] = {tip, tip - 12.0 * along + 7.0 * across, tip - 12.0 * along - 7.0 * across};
  axes.canvas().polygon(head, theme::kInk);
}

void draw_leader(Axes& axes, const base::Pose& X_WM, double radius) {
  TextStyle style = small_text();
  style.bold = true;
  style.halo = theme::kWhite;
  style.across = Anchor::middle;
  style.down = Anchor::end;
  axes.canvas().text(axes.pixel({X_WM.x, X_WM.y}) - glm::dvec2{0.0, radius * axes.scale() + 4.0}, "leads", style);
}

void draw_convoys(Axes& axes, const World& world, std::span<const Track> tracks, const TownFinalState& end) {
  for (std::size_t i = 0; i < end.follows.size(); ++i)
    if (end.follows[i] != world::kNone && !tracks[i].poses.empty() && !tracks[end.follows[i]].poses.empty())
      draw_tie(axes, tracks[i].poses.back(), tracks[end.follows[i]].poses.back(), world.movers[end.movers[i]].radius);
  for (std::size_t i = 0; i < end.follows.size(); ++i) {
    const bool led = std::find(end.follows.begin(), end.follows.end(), i) != end.follows.end();
    if (led && end.follows[i] == world::kNone && !tracks[i].poses.empty())
      draw_leader(axes, tracks[i].poses.back(), world.movers[end.movers[i]].radius);
  }
}

}  // namespace

void draw_town(const World& world, std::span<const Track> tracks, const TownFinalState& end, const std::string& path,
               const Page& page) {
  SF_CHECK(end.movers.size() == tracks.size() && end.follows.size() == tracks.size(),
           "tracks, movers and whom they follow: expected as many of each");
  const std::vector<Group> groups = groups_of(world, end);
  FigureOptions options = plan_of(world, tracks, end, groups);
  options.page = page;
  Axes axes(std::move(options));
  std::vector<world::Warning> heard_at_load;
  for (const std::string& file : world.road_files) draw_streets(axes, world::load_roads(file, heard_at_load));
  draw_lane_markings(axes, world);
  draw_walls(axes, world, WallColors::of_models);
  const bool few = tracks.size() <= kFew;
  for (const Group group : {Group::car, Group::other, Group::convoy})
    for (std::size_t i = 0; i < tracks.size(); ++i)
      if (groups[i] == group)
        draw_path(axes, tracks[i], few || group != Group::car ? 2.0 : 1.0,
                  with_opacity(color_of(group), few || group != Group::car ? 0.9 : 0.55));
  draw_lights(axes, world, end.time);
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (tracks[i].poses.empty()) continue;
    draw_body(axes, world.movers[end.movers[i]], tracks[i].poses.back(), color_of(groups[i]));
  }
  draw_convoys(axes, world, tracks, end);
  for (const Track& track : tracks) draw_contacts(axes, track, 5.0, 1.6);
  axes.save(path);
}

}  // namespace sf::viz
