#include "viz/trajectory_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/error.h"
#include "viz/axes.h"
#include "viz/color.h"
#include "viz/road_layer.h"
#include "viz/theme.h"
#include "viz/wall_layer.h"

namespace sf::viz {
namespace {

using base::Pose;
using world::World;

constexpr std::size_t kNamedTracks = 7;

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

FigureOptions plan_of(const World& world, std::span<const Track> tracks, std::string_view what) {
  FigureOptions options;
  options.title = "Trajectories";
  options.subtitle = subtitle_of(world, tracks, what);
  options.extent = extent_of(world, tracks);
  options.legend = wall_legend(world, WallColors::quiet);
  for (const LegendItem& item : road_legend(world)) options.legend.push_back(item);
  const std::uint32_t sample = tracks.size() <= kNamedTracks ? theme::kFrame : ramp(0.3);
  options.legend.push_back({LegendMark::ring, sample, "start"});
  options.legend.push_back({LegendMark::dot, sample, "end"});
  options.legend.push_back({LegendMark::cross, theme::kContact, "contact"});
  if (tracks.size() <= kNamedTracks) {
    for (std::size_t i = 0; i < tracks.size(); ++i)
      options.legend.push_back({LegendMark::line, color_of(tracks, i), tracks[i].name});
    return options;
  }
  ColorBar bar{std::string(what), tracks.front().name, tracks.back().name, {}};
  const std::size_t steps = std::min<std::size_t>(tracks.size(), 512);
  for (std::size_t k = 0; k < steps; ++k) bar.colors.push_back(color_of(tracks, k * (tracks.size() - 1) / (steps - 1)));
  options.bar = std::move(bar);
  return options;
}

}  // namespace

void draw_trajectories(const World& world, std::span<const Track> tracks, const std::string& png_path,
                       std::string_view what) {
  for (const Track& track : tracks)
    SF_CHECK(track.contacts.empty() || track.contacts.size() == track.poses.size(),
             "track " + track.name + " has " + std::to_string(track.contacts.size()) + " contacts for " +
                 std::to_string(track.poses.size()) + " poses");
  const Weight weight = weight_for(tracks.size());
  Axes axes(plan_of(world, tracks, what));
  draw_lane_markings(axes, world);
  draw_magnets(axes, world);
  draw_walls(axes, world, WallColors::quiet);
  for (std::size_t i = 0; i < tracks.size(); ++i)
    draw_path(axes, tracks[i], weight.line, with_opacity(color_of(tracks, i), weight.opacity));
  for (std::size_t i = 0; i < tracks.size(); ++i) draw_ends(axes, tracks[i], weight.mark, color_of(tracks, i));
  for (const Track& track : tracks) draw_contacts(axes, track, weight.cross, weight.cross_line);
  axes.save(png_path);
}

}  // namespace sf::viz
