// Reports and figures of experiments, compared with their CSV files.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <tuple>

#include "gpu/device.h"
#include "scenarios/lane_errors.h"
#include "scenarios/path_report.h"
#include "scenarios/thesis_tables.h"
#include "scenarios/trial.h"
#include "tests/apps/program.h"
#include "tests/instrumented.h"
#include "tests/viz/png.h"
#include "viz/series_figure.h"

namespace sf {
namespace {

using CsvRecord = std::map<std::string, std::string>;

/// Reads the lines of a file by the names in its heading; cells with commas are quoted.
std::vector<CsvRecord> csv_records(const std::string& csv) {
  const auto cells_of = [](const std::string& line) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (const char c : line) {
      if (c == '"')
        quoted = !quoted;
      else if (c == ',' && !quoted)
        cells.emplace_back();
      else
        cells.back() += c;
    }
    return cells;
  };
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> names = cells_of(line);
  std::vector<CsvRecord> records;
  while (std::getline(lines, line)) {
    const std::vector<std::string> cells = cells_of(line);
    EXPECT_EQ(cells.size(), names.size()) << line;
    CsvRecord& record = records.emplace_back();
    for (std::size_t i = 0; i < std::min(cells.size(), names.size()); ++i) record[names[i]] = cells[i];
  }
  return records;
}

/// Returns the cells of all tables of a report, without headings.
std::vector<std::vector<std::string>> table_rows(const std::string& report) {
  std::istringstream lines(report);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("|---")) {
      if (!rows.empty()) rows.pop_back();  // the heading above it
      continue;
    }
    if (!line.starts_with("| ")) continue;
    std::vector<std::string>& cells = rows.emplace_back();
    for (std::size_t at = 2, end = 0; (end = line.find(" |", at)) != std::string::npos; at = end + 3)
      cells.push_back(line.substr(at, end - at));
  }
  return rows;
}

/// Lines of the report's table, each with its record in a CSV file.
std::vector<std::pair<std::vector<std::string>, CsvRecord>> report_lines(const Folder& folder, const std::string& csv) {
  const auto rows = table_rows(read_file(folder.path("out/report.md")));
  const auto records = csv_records(read_file(folder.path("out/" + csv)));
  EXPECT_EQ(rows.size(), records.size());
  std::vector<std::pair<std::vector<std::string>, CsvRecord>> lines;
  for (std::size_t i = 0; i < std::min(rows.size(), records.size()); ++i) lines.emplace_back(rows[i], records[i]);
  return lines;
}

/// A table's cell shows a number from the file, times `scale`, with `places` decimals.
void expect_shown(const std::string& cell, const CsvRecord& record, const std::string& name, double scale, int places) {
  const std::size_t point = cell.find('.');
  const std::size_t end = std::min(cell.find(' '), cell.size());
  EXPECT_EQ(point == std::string::npos ? 0 : static_cast<int>(end - point - 1), places) << name << ": " << cell;
  EXPECT_NEAR(std::stod(cell), scale * std::stod(record.at(name)), 0.51 * std::pow(10.0, -places)) << name;
}

/// Writes a run of that duration on the test path, from which an experiment with one robot starts.
std::string short_path(const std::string& seconds, const std::string& controller, const std::string& more = "") {
  return "world = \"" + our_world("testpath/testpath.world") + "\"\nduration = " + seconds +
         "\nplant = \"thesis\"\n[default]\ncontroller = \"" + controller + "\"\n" + more;
}

/// Returns the errors of one point of `sweeps`, from a separate trial with the settings in its row.
scenarios::ThesisRow swept_errors(const std::string& file, const CsvRecord& record, std::uint64_t seed) {
  const std::string sweep = record.at("sweep"), law = record.at("law");
  const double x = std::stod(record.at("x")), rate = sweep.starts_with("rate") ? x : 10.0;
  scenarios::Scenario scenario = scenarios::read_scenario(file);
  scenario.seed = seed;
  scenario.plant = sweep.ends_with("ideal") ? scenarios::Plant::ideal : scenarios::Plant::thesis;
  scenario.tick = rate > 10.0 ? 1.0 / rate : 0.1;
  scenario.actor.link = {.delay = sweep.starts_with("delay") ? x : 0.0, .loss = sweep.starts_with("loss") ? x : 0.0};
  scenario.actor.controller.rate = rate;
  scenario.actor.controller.settings = {"test",
                                        {{"kp", sweep.starts_with("gain") ? x : 0.5, ""},
                                         {"ki", law.starts_with("PI") ? 0.015 : 0.0, ""},
                                         {"speed", 0.1, ""},
                                         {"hold", 5.0, ""}}};
  world::World world = scenarios::disturbed_world(scenario, {});
  for (world::Sensor& sensor : world.movers.at(0).sensors) {
    if (sensor.type != "laneedge") continue;
    const auto set = [&](const std::string& key, double value) {
      std::erase_if(sensor.settings, [&](const world::Setting& setting) { return setting.key == key; });
      sensor.settings.push_back({key, {value}, "", 0, ""});
    };
    set("rate", rate);
    if (law.ends_with("exact edge")) set("samples", 1.0), set("fov", 0.0);
  }
  world::update_extent_and_hash(world);
  static gpu::Device device;
  return scenarios::row_of(scenarios::run_trial(scenario, world, device, {}).errors.front());
}

/// The report's tables and the figures show the columns of the file that they name.
TEST(ExperimentReport, SweepsMatchTheColumnsOfTheirFile) {
  if (instrumented()) GTEST_SKIP() << "140 runs: 8 s without instruments";
  const Folder folder;
  folder.write("sweeps.toml", short_path("2", "lane-keeping"));
  run_successfully(
      {"experiment", "sweeps", "--trials", "1", "--seed", "3", "-o", folder.path("out"), "--files", folder.path()});
  const std::vector<CsvRecord> records = csv_records(read_file(folder.path("out/sweeps.csv")));
  ASSERT_EQ(records.size(), 4u * (2 * 7 + 2 * 6 + 5 + 4)) << "four laws";
  const auto rows = table_rows(read_file(folder.path("out/report.md")));
  ASSERT_EQ(rows.size(), records.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    SCOPED_TRACE(i);
    const CsvRecord& record = records[i];
    ASSERT_EQ(rows[i].size(), 8u);
    EXPECT_EQ(rows[i][0], record.at("x"));
    EXPECT_EQ(rows[i][1], record.at("law"));
    expect_shown(rows[i][2], record, "mean", 1.0, 4);
    expect_shown(rows[i][3], record, "owed_mean", 1.0, 4);
    expect_shown(rows[i][4], record, "abs_mean", 1.0, 4);
    expect_shown(rows[i][5], record, "abs_max", 1.0, 3);
    expect_shown(rows[i][6], record, "seconds", 1.0, 1);
    EXPECT_EQ(rows[i][7], "no") << "two seconds";
    EXPECT_EQ(record.at("end_reached"), "0");
    EXPECT_NEAR(std::stod(record.at("abs_max")), std::max(-std::stod(record.at("min")), std::stod(record.at("max"))),
                1e-6);
  }

  std::size_t looked_at = 0;
  for (const auto& [sweep, x, law] : {std::tuple{"delay-thesis", "0.3", "PI"},
                                      {"gain-ideal", "1.5", "P, exact edge"},
                                      {"loss-thesis", "0.4", "P"},
                                      {"rate-thesis", "2", "PI, exact edge"},
                                      {"rate-thesis", "20", "PI"}})
    for (const CsvRecord& record : records) {
      if (record.at("sweep") != sweep || record.at("x") != x || record.at("law") != law) continue;
      SCOPED_TRACE(std::string(sweep) + ", " + x + ", " + law);
      const scenarios::ThesisRow errors = swept_errors(folder.path("sweeps.toml"), record, 3);
      for (std::size_t i = 0; i < errors.size(); ++i)
        EXPECT_NEAR(std::stod(record.at(std::string(scenarios::kColumns[i]))), errors[i], 2e-5 * std::abs(errors[i]));
      // The bend's angle by gain and time; the thesis' plant has twice the gain.
      const double kp = std::string(sweep) == "gain-ideal" ? 1.5 : 2 * 0.5;
      EXPECT_NEAR(std::stod(record.at("owed_mean")), 0.5 * M_PI / (kp * 2.0), 1e-5);
      ++looked_at;
    }
  EXPECT_EQ(looked_at, 5u);

  for (const auto& [sweep, axis] :
       {std::pair{"delay-ideal", "delay of readings [s]"}, {"loss-thesis", "fraction of readings lost [-]"}}) {
    viz::SeriesOptions figure{.title = std::string("Lane edge loop: ") + sweep,
                              .subtitle = "seed 3",
                              .panels = {},
                              .x_name = axis,
                              .from_zero = true};
    for (const auto& [column, name] :
         {std::pair{"mean", "mean error [m]"}, {"abs_mean", "mean |error| [m]"}, {"abs_max", "largest |error| [m]"}}) {
      viz::Panel& panel = figure.panels.emplace_back();
      panel.y_name = name;
      for (const char* law : {"P", "PI", "P, exact edge", "PI, exact edge"}) {
        viz::Series& series = panel.series.emplace_back();
        series.name = law;
        for (const CsvRecord& record : records)
          if (record.at("sweep") == sweep && record.at("law") == law) {
            series.times.push_back(std::stod(record.at("x")));
            series.values.push_back(std::stod(record.at(column)));
          }
      }
    }
    viz::draw_series(figure, folder.path("expected.png"));
    const scenes::Picture expected = scenes::read_png(folder.path("expected.png")),
                          drawn = scenes::read_png(folder.path(std::string("out/sweep-") + sweep + ".png"));
    ASSERT_EQ(drawn.width, expected.width);
    ASSERT_EQ(drawn.height, expected.height);
    int different = 0;
    for (int y = 0; y < drawn.height; ++y)
      for (int x = 0; x < drawn.width; ++x) different += drawn.at(x, y) != expected.at(x, y) ? 1 : 0;
    EXPECT_LT(different, 1500) << sweep << ": the file has six digits, with which dashes move";
  }
}

/// The file is in metres, the report in millimetres.
TEST(ExperimentReport, LateStatesMatchTheColumnsOfTheirFile) {
  const Folder folder;
  folder.write("late-states.toml",
               short_path("4", "lane-keeping", "[states]\nrate = 10\ndelay = 0.08\nfilter = true\n"));
  run_successfully({"experiment", "late-states", "--trials", "1", "-o", folder.path("out"), "--files", folder.path()});
  const auto lines = report_lines(folder, "late-states.csv");
  ASSERT_EQ(lines.size(), 2u * 2 * 5) << "two gains, two speeds, five kinds of states";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    SCOPED_TRACE(i);
    const auto& [cells, record] = lines[i];
    ASSERT_EQ(cells.size(), 8u);
    EXPECT_EQ(cells[0], record.at("kp"));
    EXPECT_EQ(cells[1], record.at("speed"));
    EXPECT_EQ(cells[2], record.at("states"));
    expect_shown(cells[3], record, "abs_mean", 1e3, 1);
    expect_shown(cells[4], record, "amplitude", 1e3, 1);
    expect_shown(cells[5], record, "abs_max", 1e3, 0);
    EXPECT_EQ(cells[6], record.at("left_lane") == "0" ? "no" : "**yes**");
    EXPECT_EQ(cells[7], "**no**");
    EXPECT_EQ(record.at("end_reached"), "0");
    EXPECT_GT(std::stod(record.at("abs_max")), std::stod(record.at("abs_mean")));
  }
  for (const char* name : {"trajectories-0.1.png", "trajectories-0.5.png"})
    EXPECT_GT(scenes::read_png(folder.path(std::string("out/") + name)).width, 0) << name;
}

/// Each row is a trial with its gain, speed and kind of states.
TEST(ExperimentReport, LateStatesMatchTheirRows) {
  const Folder folder;
  const std::string file =
      folder.write("late-states.toml",
                   short_path("4", "lane-keeping", "[states]\nrate = 10\ndelay = 0.08\nposition_sigma = 0.01\n"));
  run_successfully({"experiment", "late-states", "--trials", "1", "--seed", "3", "-o", folder.path("out"), "--files",
                    folder.path()});
  const std::map<std::string, std::pair<std::optional<netio::LinkModel>, bool>> kinds{
      {"true", {}},
      {"newest", {netio::LinkModel{.delay = 0.08}, false}},
      {"filtered", {netio::LinkModel{.delay = 0.08}, true}},
      {"newest, 1 s late", {netio::LinkModel{.delay = 0.9, .jitter = 0.2, .loss = 0.01}, false}},
      {"filtered, 1 s late", {netio::LinkModel{.delay = 0.9, .jitter = 0.2, .loss = 0.01}, true}}};
  gpu::Device device;
  std::set<double> different;
  for (const CsvRecord& record : csv_records(read_file(folder.path("out/late-states.csv")))) {
    SCOPED_TRACE(record.at("kp") + ", " + record.at("speed") + ", " + record.at("states"));
    scenarios::Scenario scenario = scenarios::read_scenario(file);
    scenario.seed = 3;
    std::vector<control::Setting> settings{{"speed", std::stod(record.at("speed")), ""}};
    if (record.at("kp") != "own") settings.push_back({"kp", std::stod(record.at("kp")), ""});
    scenario.actor.controller.settings = {"test", std::move(settings)};
    const auto& [link, filter] = kinds.at(record.at("states"));
    if (link)
      scenario.states->link = *link, scenario.states->filter = filter;
    else
      scenario.states.reset();
    const world::World world = scenarios::disturbed_world(scenario, {});
    const scenarios::Trial trial = scenarios::run_trial(scenario, world, device, {});
    const double expected = scenarios::lane_errors(trial.tracks.front(), world.paths.front()).mean_abs;
    EXPECT_NEAR(std::stod(record.at("abs_mean")), expected, 1e-5 * expected);
    different.insert(expected);
  }
  EXPECT_GE(different.size(), 15u) << "gains hardly matter before the bend where states are not late";
}

/// The file has fractions, the report per cent.
TEST(ExperimentReport, AccuracyMatchesTheColumnsOfItsFile) {
  const Folder folder;
  folder.write("small.world",
               "model( size [0.8 0.8 0.5] boundary 1 noblocks 0 )\n"
               "position( name \"a\" size [0.2 0.2 0.1] laser( samples 91 fov 180 range_max 2 ) )\n");
  folder.write("explore.toml", "world = \"small.world\"\nduration = 2\n[default]\ncontroller = \"avoid\"\n");
  folder.write("lane-edge-p.toml", short_path("4", "lane-keeping"));
  folder.write("magnet-p.toml", short_path("4", "magnet-keeping"));
  run_successfully({"experiment", "accuracy", "--trials", "1", "-o", folder.path("out"), "--files", folder.path()});
  const auto lines = report_lines(folder, "accuracy.csv");
  ASSERT_EQ(lines.size(), 3u + 4 + 5) << "modes of the three types";
  for (std::size_t i = 0; i < lines.size(); ++i) {
    SCOPED_TRACE(i);
    const auto& [cells, record] = lines[i];
    ASSERT_EQ(cells.size(), 6u);
    EXPECT_EQ(record.at("sensor"), i < 3 ? "laneedge" : i < 7 ? "magnetometer" : "laser");
    EXPECT_EQ(cells[0], record.at("mode"));
    if (i < 7) {
      expect_shown(cells[1], record, "abs_mean", 1.0, 4);
      expect_shown(cells[2], record, "abs_max", 1.0, 4);
      EXPECT_GT(std::stod(record.at("abs_max")), std::stod(record.at("abs_mean")));
    } else {
      expect_shown(cells[1], record, "cells_missed", 100.0, 3);
      expect_shown(cells[2], record, "cells_wrong", 100.0, 3);
    }
    EXPECT_EQ(std::stod(cells[3]), std::stod(record.at("contacts")));
    expect_shown(cells[4], record, "seconds", 1.0, 1);
    EXPECT_EQ(record.at("seconds"), i < 7 ? "4.0" : "2.0");
    EXPECT_EQ(cells[5], "**no**");
    EXPECT_EQ(record.at("done"), "0");
  }
}

/// One row per robot and trial, with the same numbers in both files.
TEST(ExperimentReport, ATownMatchesTheColumnsOfItsFile) {
  const Folder folder;
  folder.write("minimagic.toml", "world = \"" + our_world("rooms.world") +
                                     "\"\nduration = 5\nrobots = 3\n[default]\ncontroller = \"wander\"\n");
  run_successfully({"experiment", "minimagic", "--trials", "2", "-o", folder.path("out"), "--files", folder.path()});
  const auto lines = report_lines(folder, "statistics.csv");
  ASSERT_GE(lines.size(), 2u * 3);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    SCOPED_TRACE(i);
    const auto& [cells, record] = lines[i];
    ASSERT_EQ(cells.size(), 6u);
    EXPECT_EQ(record.at("trial"), i < lines.size() / 2 ? "1" : "2");
    EXPECT_EQ(cells[0], record.at("robot"));
    expect_shown(cells[1], record, "driven_m", 1.0, 2);
    EXPECT_EQ(cells[2], record.at("contacts"));
    EXPECT_EQ(cells[3], record.at("checkpoints"));
    EXPECT_EQ(cells[4], record.at("full_stops"));
    EXPECT_EQ(cells[5], record.at("reds_passed"));
    EXPECT_EQ(record.at("mean_abs_error_m"), "") << "the world has no lanes";
    EXPECT_GT(std::stod(record.at("driven_m")), 0.1);
  }
}

}  // namespace
}  // namespace sf
