#include "viz/trajectory_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

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
constexpr std::uint32_t kOtherTrack = 0xFF9AA0A8u;  ///< of tracks without labels if others have labels

bool is_labelled(const Track& track, const TrackLabels& labels) {
  return std::find(labels.names.begin(), labels.names.end(), track.name) != labels.names.end();
}

/// Labelled tracks are coloured as if they were alone in the figure.
std::uint32_t color_of(std::span<const Track> tracks, std::size_t i, const TrackLabels& labels) {
  if (labels.names.empty()) return tracks[i].color.value_or(row_color(i, tracks.size()));
  if (!is_labelled(tracks[i], labels)) return kOtherTrack;
  const auto before = std::count_if(tracks.begin(), tracks.begin() + static_cast<std::ptrdiff_t>(i),
                                    [&](const Track& t) { return is_labelled(t, labels); });
  return tracks[i].color.value_or(row_color(static_cast<std::size_t>(before), labels.names.size()));
}

std::span<const double> dash_of(std::span<const Track> tracks, std::size_t i, const Page& page) {
  return page.line_styles && tracks.size() <= kNamedTracks ? line_style(i) : std::span<const double>();
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

/// @param world the part that the figure shows
std::vector<LegendItem> legend_of(const World& world, const world::Extent& shown, std::span<const Track> tracks,
                                  const TrackLabels& labels, const Page& page) {
  const auto visible = [&](const Pose& pose) {
    const glm::dvec2 p{pose.x, pose.y};
    return is_finite(pose) && is_in_view({&p, 1}, shown);
  };
  const auto drawn = [&](const Track& t) { return std::any_of(t.poses.begin(), t.poses.end(), visible); };
  const auto touched = [&](const Track& t) {
    for (std::size_t i = 0; i < t.contacts.size(); ++i)
      if (t.contacts[i] != 0 && visible(t.poses[i])) return true;
    return false;
  };
  std::vector<LegendItem> items = wall_legend(world, WallColors::quiet);
  for (const LegendItem& item : road_legend(world)) items.push_back(item);
  if (std::any_of(tracks.begin(), tracks.end(), drawn)) {
    items.push_back({LegendMark::ring, theme::kFrame, "start"});
    items.push_back({LegendMark::dot, theme::kFrame, "end"});
  }
  if (std::any_of(tracks.begin(), tracks.end(), touched))
    items.push_back({LegendMark::cross, theme::kContact, "contact"});
  for (std::size_t i = 0; i < tracks.size() && tracks.size() <= kNamedTracks; ++i)
    if (drawn(tracks[i]))
      items.push_back(
          {LegendMark::line, color_of(tracks, i, labels), tracks[i].name, theme::kNone, dash_of(tracks, i, page)});
  return items;
}

FigureOptions plan_of(const World& world, std::span<const Track> tracks, std::string_view what, const Page& page,
                      const TrackLabels& labels) {
  FigureOptions options;
  options.page = page;
  options.title = "Trajectories";
  options.subtitle = subtitle_of(world, tracks, what);
  options.extent = extent_of(world, tracks);
  options.legend = legend_of(in_view(world, options), lay_out(options).shown, tracks, labels, page);
  return options;
}

/// Labels tracks in their colours at their ends, as far as there is room, for more tracks than fit in the legend.
/// @return the number of tracks without a label
std::size_t draw_end_names(Axes& axes, std::span<const Track> tracks, const TrackLabels& wanted) {
  const std::size_t most = wanted.all ? kNamedEnds : kLabelledTracks;
  if (wanted.names.empty() && ((!wanted.all && tracks.size() <= kNamedTracks) || tracks.size() > most))
    return wanted.all ? tracks.size() : 0;
  Labels labels(axes.layout().plot);
  std::vector<std::optional<glm::dvec2>> ends;
  for (const Track& track : tracks) {
    const auto last = std::find_if(track.poses.rbegin(), track.poses.rend(), is_finite);
    ends.push_back(last == track.poses.rend() ? std::nullopt : std::optional(axes.pixel({last->x, last->y})));
    if (ends.back()) labels.forbid({*ends.back() - glm::dvec2{4.0, 4.0}, *ends.back() + glm::dvec2{4.0, 4.0}});
  }
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (!ends[i] || (!wanted.names.empty() && !is_labelled(tracks[i], wanted))) continue;
    TextStyle style = small_text();
    style.size = wanted.names.empty() ? 14 : style.size;
    style.color = mix(color_of(tracks, i, wanted), theme::kBlack, 0.25);
    style.halo = theme::kWhite;
    left_out += !labels.place(axes.canvas(), {&*ends[i], 1}, tracks[i].name, style, {6.0, 30.0, 14.0, 0.0});
  }
  return left_out;
}

}  // namespace

std::size_t draw_trajectories(const World& world, std::span<const Track> tracks, const std::string& path,
                              std::string_view what, const Page& page, const TrackLabels& labels) {
  for (const Track& track : tracks)
    SF_CHECK(track.contacts.empty() || track.contacts.size() == track.poses.size(),
             "track " + track.name + " has " + std::to_string(track.contacts.size()) + " contacts for " +
                 std::to_string(track.poses.size()) + " poses");
  const Weight weight = weight_for(tracks.size());
  Axes axes(plan_of(world, tracks, what, page, labels));
  draw_lane_markings(axes, world);
  draw_magnets(axes, world);
  draw_walls(axes, world, WallColors::quiet);
  // Draw labelled tracks on top.
  std::vector<std::size_t> order(tracks.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_partition(order.begin(), order.end(), [&](std::size_t i) { return !is_labelled(tracks[i], labels); });
  for (const std::size_t i : order)
    draw_path(axes, tracks[i], is_labelled(tracks[i], labels) ? theme::kCurve : weight.line,
              with_opacity(color_of(tracks, i, labels), weight.opacity), dash_of(tracks, i, page));
  for (const std::size_t i : order)
    draw_ends(axes, tracks[i], is_labelled(tracks[i], labels) ? Weight().mark : weight.mark,
              color_of(tracks, i, labels));
  for (const Track& track : tracks) draw_contacts(axes, track, weight.cross, weight.cross_line);
  const std::size_t left_out = draw_end_names(axes, tracks, labels);
  axes.save(path);
  return left_out;
}

}  // namespace sf::viz
