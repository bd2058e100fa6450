#include "scenarios/tree_grid_report.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>

#include "viz/series_figure.h"

namespace sf::scenarios {

namespace {

constexpr std::array<std::string_view, 2> kPoseNames{"exact", "own"};

double part_of(double part, std::size_t whole) { return whole == 0 ? NAN : part / static_cast<double>(whole); }
double percent(std::size_t part, std::size_t whole) { return 100.0 * part_of(static_cast<double>(part), whole); }
double explored(const TreeGrid& g) { return percent(g.explored, g.cells); }
double precision(const TreeGrid& g) { return percent(g.right, g.occupied); }
double recall(const TreeGrid& g) { return percent(g.found, g.surfaces); }
double wrong(const TreeGrid& g) { return percent(g.wrong, g.free); }
double log_loss(const TreeGrid& g) { return part_of(g.log_loss, g.cells); }

const TreeGrid& grid_of(const std::vector<TreeGrid>& all, unsigned sensors, GridPose pose) {
  return all[static_cast<std::size_t>(pose) * kAllGridSensors + sensors - 1];
}

viz::Series grids_switched_off(const std::vector<TreeGrid>& all, bool finest_first, GridPose pose,
                               double (*value)(const TreeGrid&)) {
  viz::Series series{fmt::format("{}, {} poses",
                                 finest_first ? "front laser first, infrared last" : "infrared first, front laser last",
                                 kPoseNames[static_cast<std::size_t>(pose)]),
                     {},
                     {}};
  unsigned on = kAllGridSensors;
  for (std::size_t k = 0; k < kGridSensors; ++k) {
    series.times.push_back(static_cast<double>(k));
    series.values.push_back(value(grid_of(all, on, pose)));
    on &= ~(1u << (finest_first ? k : kGridSensors - 1 - k));
  }
  return series;
}

}  // namespace

std::string tree_sensor_names(unsigned sensors) {
  std::string text;
  for (std::size_t k = 0; k < kTreeSensors.size(); ++k)
    if ((sensors >> k & 1u) != 0) text += (text.empty() ? "" : ", ") + std::string(kTreeSensors[k]);
  return text;
}

std::string tree_grid_csv(const std::vector<TreeGrid>& all) {
  std::string text =
      "sensors,count,poses,cells,explored,surfaces,recall,occupied,precision,precision_exact,free,free_wrong,log_loss,"
      "brier\n";
  for (const TreeGrid& g : all)
    text += fmt::format("\"{}\",{},{},{},{:.4g},{},{:.4g},{},{:.4g},{:.4g},{},{:.4g},{:.4g},{:.4g}\n",
                        tree_sensor_names(g.sensors), std::popcount(g.sensors),
                        kPoseNames[static_cast<std::size_t>(g.pose)], g.cells, 0.01 * explored(g), g.surfaces,
                        0.01 * recall(g), g.occupied, 0.01 * precision(g), 0.01 * percent(g.exact, g.occupied), g.free,
                        0.01 * wrong(g), log_loss(g), part_of(g.squares, g.cells));
  return text;
}

std::string tree_grid_report(const std::vector<TreeGrid>& all) {
  std::string text =
      "## Grids\n\nAgainst what an exact scan of 4 m sees from the car once a second, at the end of each run, without "
      "cells near robots. Explored cells [%]; occupied cells within one cell of a surface [%]; surfaces with an "
      "occupied cell within one cell [%]; free cells that are surfaces [%]; logarithmic loss and Brier score per cell "
      "(nothing known: 0.693, 0.25). By exact poses / by the car's own. Tags say nothing about cells.\n\n"
      "| sensors | explored | precision | recall | free wrong | log loss | Brier |\n|---|---|---|---|---|---|---|\n";
  const auto row = [&](unsigned sensors, const std::string& name) {
    const TreeGrid &exact = grid_of(all, sensors, GridPose::exact), &own = grid_of(all, sensors, GridPose::own);
    text += fmt::format(
        "| {} | {:.1f} / {:.1f} | {:.1f} / {:.1f} | {:.1f} / {:.1f} | {:.2f} / {:.2f} | {:.3f} / {:.3f} | {:.3f} / "
        "{:.3f} |\n",
        name, explored(exact), explored(own), precision(exact), precision(own), recall(exact), recall(own),
        wrong(exact), wrong(own), log_loss(exact), log_loss(own), part_of(exact.squares, exact.cells),
        part_of(own.squares, own.cells));
  };
  row(kAllGridSensors, "all");
  for (std::size_t k = 0; k < kGridSensors; ++k)
    row(kAllGridSensors & ~(1u << k), fmt::format("without {}", kTreeSensors[k]));
  row(3, "front laser, back laser"), row(12, "sonar, infrared");
  for (std::size_t k = 0; k < kGridSensors; ++k) row(1u << k, fmt::format("{} alone", kTreeSensors[k]));
  return text;
}

void draw_tree_grids(const std::vector<TreeGrid>& all, const std::string& path) {
  const auto panel = [&](const std::string& y_name, double (*value)(const TreeGrid&)) {
    viz::Panel made{.y_name = y_name, .from_zero = true};
    for (const GridPose pose : {GridPose::exact, GridPose::own})
      for (const bool finest_first : {true, false})
        made.series.push_back(grids_switched_off(all, finest_first, pose, value));
    return made;
  };
  viz::draw_series({.title = "Grids as sensors are switched off one by one",
                    .panels = {panel("occupied cells right [%]", precision), panel("surfaces found [%]", recall),
                               panel("free cells wrong [%]", wrong), panel("log loss", log_loss)},
                    .x_name = "sensors switched off"},
                   path);
}

}  // namespace sf::scenarios
