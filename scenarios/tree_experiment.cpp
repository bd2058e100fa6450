// Five unlike sensors of one car, of which each choice is switched on: tracks of objects and grids against
// the truth.

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "scenarios/experiment.h"
#include "scenarios/tree_grid_report.h"
#include "viz/map_figure.h"
#include "viz/series_figure.h"

namespace sf::scenarios {

namespace {

// Orders in which the sensors are switched off: rows of kTreeSensors.
constexpr std::array<std::size_t, 5> kFinestFirst{0, 1, 4, 2, 3}, kCoarsestFirst{3, 2, 4, 1, 0};

double missed(const TreeTracks& t) { return 1.0 - share_of(static_cast<double>(t.found), t.targets); }

std::string tree_csv(const std::vector<TreeTracks>& all) {
  std::string text =
      "sensors,count,readings,targets,missed,position_rms_m,speed_rms_m_s,nees,motion_right,switches,objects,false,"
      "moving_walls\n";
  for (const TreeTracks& t : all)
    text += fmt::format("\"{}\",{},{},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{},{},{},{}\n",
                        tree_sensor_names(t.sensors), std::popcount(t.sensors), t.readings, t.targets, missed(t),
                        rms_of(t.position_squares, t.found), rms_of(t.velocity_squares, t.found),
                        t.nees / static_cast<double>(t.found), share_of(static_cast<double>(t.right_motion), t.found),
                        t.switches, t.tracks, t.false_tracks, t.moving_walls);
  return text;
}

std::string tree_row(const TreeTracks& t, const std::string& name) {
  return fmt::format("| {} | {:.1f} | {:.3f} | {:.3f} | {:.2f} | {:.1f} | {:.2f} | {:.2f} | {:.3f} |\n", name,
                     100.0 * missed(t), rms_of(t.position_squares, t.found), rms_of(t.velocity_squares, t.found),
                     t.nees / static_cast<double>(t.found),
                     100.0 * share_of(static_cast<double>(t.right_motion), t.found),
                     100.0 * static_cast<double>(t.switches) / static_cast<double>(t.targets),
                     share_of(static_cast<double>(t.false_tracks), t.readings),
                     share_of(static_cast<double>(t.moving_walls), t.readings));
}

std::string tree_report(const ExperimentContext& context, const TreeRun& all) {
  const auto row = [&](unsigned sensors, const std::string& name) { return tree_row(all.tracks[sensors - 1], name); };
  std::string text = fmt::format(
      "# Five sensors of one car\n\nSeeds {} to {}, {:g} s each, the first 10 s left out. Targets: robots within 3 m "
      "that no wall hides. Missed [%], RMS errors of position [m] and velocity [m/s] of the others, position NEES, "
      "decisions at rest or moving that are right [%], changes of identity per 100 targets, objects per reading where "
      "nothing is, surfaces per reading that are taken for moving.\n\n"
      "| sensors | missed | position | velocity | NEES | motion | switches | false | moving walls |\n"
      "|---|---|---|---|---|---|---|---|---|\n",
      context.options.seed, context.options.seed + context.options.trials - 1, context.scenario.duration);
  text += row(kAllTreeSensors, "all");
  for (std::size_t k = 0; k < kTreeSensors.size(); ++k)
    text += row(kAllTreeSensors & ~(1u << k), fmt::format("without {}", kTreeSensors[k]));
  unsigned on = kAllTreeSensors;
  for (std::size_t k = 0; k + 1 < kFinestFirst.size(); ++k)
    if (on &= ~(1u << kFinestFirst[k]); k > 0 && std::popcount(on) > 1) text += row(on, tree_sensor_names(on));
  for (std::size_t k = 0; k < kTreeSensors.size(); ++k) text += row(1u << k, fmt::format("{} alone", kTreeSensors[k]));
  return text + "\n" + std::string(context.type.reasons) + "\n\n" + tree_grid_report(all.grids);
}

viz::Series switched_off(const std::vector<TreeTracks>& all, const std::array<std::size_t, 5>& order,
                         const std::string& name, double (*value)(const TreeTracks&)) {
  viz::Series series{name, {}, {}};
  unsigned on = kAllTreeSensors;
  for (std::size_t k = 0; k < order.size(); ++k) {
    series.times.push_back(static_cast<double>(k));
    series.values.push_back(value(all[on - 1]));
    on &= ~(1u << order[k]);
  }
  return series;
}

void draw_tree(const std::vector<TreeTracks>& all, const std::string& path) {
  const auto panel = [&](const std::string& y_name, double (*value)(const TreeTracks&)) {
    return viz::Panel{.y_name = y_name,
                      .series = {switched_off(all, kFinestFirst, "front laser first, infrared last", value),
                                 switched_off(all, kCoarsestFirst, "infrared first, front laser last", value)},
                      .from_zero = true};
  };
  viz::draw_series(
      {.title = "Tracks as sensors are switched off one by one",
       .panels = {panel("missed [%]", [](const TreeTracks& t) { return 100.0 * missed(t); }),
                  panel("position RMS [m]", [](const TreeTracks& t) { return rms_of(t.position_squares, t.found); }),
                  panel("velocity RMS [m/s]", [](const TreeTracks& t) { return rms_of(t.velocity_squares, t.found); }),
                  panel("false objects per reading",
                        [](const TreeTracks& t) { return share_of(static_cast<double>(t.false_tracks), t.readings); })},
       .x_name = "sensors switched off"},
      path);
}

std::vector<std::string> run_tree_experiment(const ExperimentContext& context) {
  if (!reports(context)) return {};
  TreeRun all;
  for (std::uint32_t k = 0; k < context.options.trials; ++k) {
    if (context.progress)
      context.progress(k / static_cast<double>(context.options.trials), fmt::format("trial {}", k + 1));
    TreeRun run = run_tree(context, context.options.seed + k);
    if (k == 0)
      all = std::move(run);
    else
      all.add(run);
  }
  const std::vector<std::string> files{in_folder(context, "results.csv"),  in_folder(context, "grids.csv"),
                                       in_folder(context, "report.md"),    in_folder(context, "tracks.png"),
                                       in_folder(context, "grids.png"),    in_folder(context, "map.png"),
                                       in_folder(context, "map-sonar.png")};
  write_text(files[0], tree_csv(all.tracks));
  write_text(files[1], tree_grid_csv(all.grids));
  write_text(files[2], tree_report(context, all));
  draw_tree(all.tracks, files[3]);
  draw_tree_grids(all.grids, files[4]);
  const std::string seed = fmt::format("seed {}, by the car's own poses", context.options.seed);
  viz::draw_map(all.own_grids[0], {"Grid from two lasers, sonar and infrared", seed, {}}, files[5]);
  viz::draw_map(all.own_grids[1], {"Grid from sonar alone", seed, {}}, files[6]);
  return files;
}

constexpr std::string_view kTreeReasons =
    "A choice without lasers has no lines, so echoes of walls become objects. Errors of the position include the "
    "distance from the middle of what is seen of a car to its own middle, and the error of the car's pose.";

}  // namespace

extern const ExperimentType tree_experiment;

constinit const ExperimentType tree_experiment{
    .name = "tree",
    .summary = "five unlike sensors of a car, switched off one by one: tracks and a grid against the truth",
    .reasons = kTreeReasons,
    .run = run_tree_experiment,
};

}  // namespace sf::scenarios
