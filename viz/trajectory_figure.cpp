#include "viz/trajectory_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "viz/axes.h"
#include "viz/color.h"
#include "viz/labels.h"
#include "viz/road_layer.h"
#include "viz/theme.h"
#include "viz/wall_layer.h"

namespace sf::viz {
namespace {

using base::Pose;
using world::World;

constexpr std::size_t kNamedTracks = 7;
constexpr std::size_t kNamedEnds = 150;

std::uint32_t color_of(std::span<const Track> tracks, std::size_t i) {
  return tracks[i].color.value_or(row_color(i, tracks.size()));
}

/// Widths of lines and marks, thinner for many tracks.
struct Weight {
  double line = 2.4, mark = 6.0, cross = 7.5, cross_line = 2.0;  // a cross is visible on the dot at the end
  double opacity = 1.0;
};
Weight weight_for(std::size_t tracks) {
  if (tracks <= kNamedTracks) return {};
  if (tracks <= 40) return {1.8, 5.0, 3.5, 1.2, 0.95};
  if (tracks <= 250) return {1.4, 4.0, 2.5, 1.0, 0.9};
  return {1.0, 2.6, 1.5, 0.7, 0.8};
}

void draw_ends(Axes& axes, const Track& track, double mark, std::uint32_t color) {
  const auto first = std::find_if(track.poses.begin(), track.poses.end(), is_finite);
  if (first == track.poses.end()) return;
  const Pose& last = *std::find_if(track.poses.rbegin(), track.poses.rend(), is_finite);
  const glm::dvec2 start = axes.pixel({first->x, first->y});
  const glm::dvec2 end = axes.pixel({last.x, last.y});
  axes.canvas().disc(start, mark, theme::kWhite);
  axes.canvas().ring(start, mark - 0.8, 1.6, color);
  axes.canvas().disc(end, mark + 1.4, theme::kWhite);
  axes.canvas().disc(end, mark, color);
}

std::string subtitle_of(const World& world, std::span<const Track> tracks, std::string_view what) {
  double metres = 0.0;
  double seconds = 0.0;
  std::size_t contacts = 0;
  for (const Track& track : tracks) {
    metres += path_length(track);
    seconds = std::max(seconds, track.duration);
    contacts += contact_count(track);
  }
  std::string text = fmt::format("{} {}{}", tracks.size(), what, tracks.size() == 1 ? "" : "s");
  if (seconds > 0.0) text += fmt::format(", {:.4g} s", seconds);
  text += fmt::format(", {:.0f} m driven, {} contact{}", metres, contacts, contacts == 1 ? "" : "s");
  return world.name.empty() ? text : world.name + ": " + text;
}

FigureOptions plan_of(const World& world, std::span<const Track> tracks, std::string_view what, const Page& page) {
  FigureOptions options;
  options.page = page;
  options.title = "Trajectories";
  options.subtitle = subtitle_of(world, tracks, what);
  options.extent = extent_of(world, tracks);
  options.legend = wall_legend(world, WallColors::quiet);
  for (const LegendItem& item : road_legend(world)) options.legend.push_back(item);
  options.legend.push_back({LegendMark::ring, theme::kFrame, "start"});
  options.legend.push_back({LegendMark::dot, theme::kFrame, "end"});
  options.legend.push_back({LegendMark::cross, theme::kContact, "contact"});
  for (std::size_t i = 0; i < tracks.size() && tracks.size() <= kNamedTracks; ++i)
    options.legend.push_back({LegendMark::line, color_of(tracks, i), tracks[i].name});
  return options;
}

/// Names of more tracks than the legend has room for, in their colours beside their ends, as far as there is room.
void draw_end_names(Axes& axes, std::span<const Track> tracks) {
  if (tracks.size() <= kNamedTracks || tracks.size() > kNamedEnds) return;
  Labels labels(axes.layout().plot);
  std::vector<std::optional<glm::dvec2>> ends;
  for (const Track& track : tracks) {
    const auto last = std::find_if(track.poses.rbegin(), track.poses.rend(), is_finite);
    ends.push_back(last == track.poses.rend() ? std::nullopt : std::optional(axes.pixel({last->x, last->y})));
    if (ends.back()) labels.forbid({*ends.back() - glm::dvec2{4.0, 4.0}, *ends.back() + glm::dvec2{4.0, 4.0}});
  }
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!ends[i]) continue;
    TextStyle style = small_text();
    style.size = 14;
    style.color = mix(color_of(tracks, i), theme::kBlack, 0.25);
    style.halo = theme::kWhite;
    labels.place(axes.canvas(), {&*ends[i], 1}, tracks[i].name, style, {6.0, 30.0, 14.0, 0.0});
  }
}

}  // namespace

void draw_trajectories(const World& world, std::span<const Track> tracks, const std::string& path,
                       std::string_view what, const Page& page) {
  for (const Track& track : tracks)
    SF_CHECK(track.contacts.empty() || track.contacts.size() == track.poses.size(),
             "track " + track.name + " has " + std::to_string(track.contacts.size()) + " contacts for " +
                 std::to_string(track.poses.size()) + " poses");
  const Weight weight = weight_for(tracks.size());
  Axes axes(plan_of(world, tracks, what, page));
  draw_lane_markings(axes, world);
  draw_magnets(axes, world);
  draw_walls(axes, world, WallColors::quiet);
  for (std::size_t i = 0; i < tracks.size(); ++i)
    draw_path(axes, tracks[i], weight.line, with_opacity(color_of(tracks, i), weight.opacity));
  for (std::size_t i = 0; i < tracks.size(); ++i) draw_ends(axes, tracks[i], weight.mark, color_of(tracks, i));
  for (const Track& track : tracks) draw_contacts(axes, track, weight.cross, weight.cross_line);
  draw_end_names(axes, tracks);
  axes.save(path);
}

}  // namespace sf::viz
