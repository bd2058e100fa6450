// A car on a full-size road in traffic: tracks of other cars from two lidars, a camera and a radar, and its own
// position, against the truth.

#include <fmt/format.h>

#include <cmath>

#include "base/hash.h"
#include "scenarios/experiment.h"
#include "scenarios/vesim_runs.h"
#include "viz/series_figure.h"

namespace sf::scenarios {

namespace {

double found_share(const VesimCell& c) { return share_of(static_cast<double>(c.found), c.targets); }

constexpr std::array<std::string_view, 2> kSides{"ahead", "elsewhere"};
std::string range_name(std::size_t i) {
  return fmt::format("{:g} to {:g} m", i == 0 ? 0.0 : kVesimRanges[i - 1], kVesimRanges[i]);
}

/// Calls `row(choice, side, range, cell)` for each cell of a run.
template <class Row>
void each_cell(const VesimRun& run, Row&& row) {
  for (std::size_t k = 0; k < kVesimChoices.size(); ++k)
    for (std::size_t side = 0; side < kSides.size(); ++side)
      for (std::size_t i = 0; i < kVesimRanges.size(); ++i) row(k, side, i, run.tracks[k].cells[side][i]);
}

std::string vesim_csv(const VesimRun& all) {
  std::string text = "sensors,side,range_m,targets,found,position_rms_m,velocity_rms_m_s,nees\n";
  each_cell(all, [&](std::size_t k, std::size_t side, std::size_t i, const VesimCell& c) {
    text += fmt::format("{},{},{:g},{},{},{:.4g},{:.4g},{:.4g}\n", kVesimChoices[k].name, kSides[side], kVesimRanges[i],
                        c.targets, c.found, rms_of(c.position_squares, c.found), rms_of(c.velocity_squares, c.found),
                        share_of(c.nees, c.found));
  });
  return text;
}

/// JSON has no NaN.
std::string number(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "null"; }

std::string place_json(const VesimPlace& p) {
  return fmt::format("{{\"readings\": {}, \"rms_m\": {}, \"largest_m\": {}, \"nees\": {}}}", p.readings,
                     number(rms_of(p.squares, p.readings)), number(p.largest), number(share_of(p.nees, p.readings)));
}

std::string run_json(const VesimRun& run) {
  std::string text =
      fmt::format("{{\"seed\": {}, \"hash\": \"{}\", \"contacts\": {}, \"gps\": {}, \"fused\": {},\n  \"tracks\": [",
                  run.seed, base::hash_hex(run.hash), run.contacts, place_json(run.gps), place_json(run.fused));
  each_cell(run, [&](std::size_t k, std::size_t side, std::size_t i, const VesimCell& c) {
    text += fmt::format(
        "{}\n    {{\"sensors\": \"{}\", \"side\": \"{}\", \"range_m\": {:g}, \"targets\": {}, \"found\": {}, "
        "\"position_rms_m\": {}, \"velocity_rms_m_s\": {}}}",
        k + side + i == 0 ? "" : ",", kVesimChoices[k].name, kSides[side], kVesimRanges[i], c.targets, c.found,
        number(rms_of(c.position_squares, c.found)), number(rms_of(c.velocity_squares, c.found)));
  });
  text += "],\n  \"others\": [";
  for (std::size_t k = 0; k < kVesimChoices.size(); ++k) {
    const VesimTracks& t = run.tracks[k];
    text += fmt::format(
        "{}\n    {{\"sensors\": \"{}\", \"readings\": {}, \"ghosts\": {}, \"at_rest\": {}, \"moving_walls\": {}, "
        "\"switches\": {}}}",
        k == 0 ? "" : ",", kVesimChoices[k].name, t.readings, t.ghosts, t.nothings, t.moving_walls, t.switches);
  }
  return text + "]}";
}

std::string vesim_json(const std::vector<VesimRun>& runs) {
  std::string text = "[";
  for (const VesimRun& run : runs) text += (&run == runs.data() ? "\n" : ",\n") + run_json(run);
  return text + "\n]\n";
}

/// "-" where nothing was found.
std::string figure(double value) { return std::isfinite(value) ? fmt::format("{:.2f}", value) : "-"; }

std::string cars_table(const VesimRun& all, std::size_t side) {
  std::string text = fmt::format(
      "\nCars {}:\n\n| sensors | range | targets | found | position | velocity | NEES "
      "|\n|---|---|---|---|---|---|---|\n",
      kSides[side]);
  each_cell(all, [&](std::size_t k, std::size_t of, std::size_t i, const VesimCell& c) {
    if (of != side || c.targets == 0) return;
    text += fmt::format("| {} | {} | {} | {:.1f} | {} | {} | {} |\n", kVesimChoices[k].name, range_name(i), c.targets,
                        100.0 * found_share(c), figure(rms_of(c.position_squares, c.found)),
                        figure(rms_of(c.velocity_squares, c.found)), figure(share_of(c.nees, c.found)));
  });
  return text;
}

std::string vesim_report(const ExperimentContext& context, const std::vector<VesimRun>& runs, const VesimRun& all) {
  std::string text = fmt::format(
      "# A car in traffic\n\nSeeds {} to {}, {:g} s each, the first 5 s left out. Targets: cars within {:g} m that "
      "neither the ground nor a house or a tree hides; ahead: within 45 degrees, the radar's field of view. Found [%]: "
      "with a track within 4 m; RMS errors of position [m] and velocity [m/s] of these, position NEES.\n",
      runs.front().seed, runs.back().seed, context.scenario.duration, kVesimRanges.back());
  for (std::size_t side = 0; side < kSides.size(); ++side) text += cars_table(all, side);
  text +=
      "\nPer reading: moving objects and objects at rest where neither a car nor a surface is, and surfaces of houses "
      "and trees that are taken for moving; changes of identity per 1000 readings.\n\n| sensors | ghosts | at rest | "
      "moving walls | changes |\n|---|---|---|---|---|\n";
  for (std::size_t k = 0; k < kVesimChoices.size(); ++k) {
    const VesimTracks& t = all.tracks[k];
    text += fmt::format("| {} | {:.3f} | {:.3f} | {:.3f} | {:.1f} |\n", kVesimChoices[k].name,
                        share_of(static_cast<double>(t.ghosts), t.readings),
                        share_of(static_cast<double>(t.nothings), t.readings),
                        share_of(static_cast<double>(t.moving_walls), t.readings),
                        1e3 * share_of(static_cast<double>(t.switches), t.readings));
  }
  text += "\n| position of the car | RMS [m] | largest [m] | NEES |\n|---|---|---|---|\n";
  for (const auto& [name, p] : {std::pair("satellites alone", all.gps), std::pair("fused", all.fused)})
    text += fmt::format("| {} | {:.2f} | {:.2f} | {} |\n", name, rms_of(p.squares, p.readings), p.largest,
                        figure(share_of(p.nees, p.readings)));
  text += "\nReadings of each trial, by their hash:";
  for (const VesimRun& run : runs) text += fmt::format(" {}", base::hash_hex(run.hash));
  return text + "\n\n" + std::string(context.type.reasons) + "\n";
}

void draw_vesim(const VesimRun& all, const std::string& path) {
  const auto panel = [&](const std::string& y_name, double (*value)(const VesimCell&)) {
    viz::Panel drawn{.y_name = y_name, .from_zero = true};
    for (std::size_t k = 0; k < kVesimChoices.size(); ++k) {
      viz::Series& series = drawn.series.emplace_back();
      series.name = kVesimChoices[k].name;
      for (std::size_t i = 0; i < kVesimRanges.size(); ++i) {
        series.times.push_back(0.5 * ((i == 0 ? 0.0 : kVesimRanges[i - 1]) + kVesimRanges[i]));
        series.values.push_back(value(all.tracks[k].cells[0][i]));
      }
    }
    return drawn;
  };
  viz::draw_series(
      {.title = "Tracks of cars ahead",
       .panels = {panel("found [%]", [](const VesimCell& c) { return 100.0 * found_share(c); }),
                  panel("position RMS [m]", [](const VesimCell& c) { return rms_of(c.position_squares, c.found); }),
                  panel("velocity RMS [m/s]", [](const VesimCell& c) { return rms_of(c.velocity_squares, c.found); })},
       .x_name = "range [m]"},
      path);
}

std::vector<std::string> run_vesim_experiment(const ExperimentContext& context) {
  const std::vector<VesimRun> runs = run_vesim_trials(context);
  if (!reports(context)) return {};
  VesimRun all = runs.front();
  for (std::size_t k = 1; k < runs.size(); ++k) all.add(runs[k]);
  const std::vector<std::string> files{in_folder(context, "results.csv"), in_folder(context, "results.json"),
                                       in_folder(context, "report.md"), in_folder(context, "tracks.png")};
  write_text(files[0], vesim_csv(all));
  write_text(files[1], vesim_json(runs));
  write_text(files[2], vesim_report(context, runs, all));
  draw_vesim(all, files[3]);
  return files;
}

constexpr std::string_view kVesimReasons =
    "The tree knows the readings and their stated errors, the size of cars, and the pose at the start; the driver "
    "alone has the true pose. Lidars see ranges, so the speed of a new track is known after some readings; the radar "
    "measures the speed along its line of sight at once. The camera is a stereo camera, whose depths are fused; its "
    "colours are not. The localization knows where the car's axles are, and takes its tyres for usual ones.";

}  // namespace

extern const ExperimentType vesim_experiment;

constinit const ExperimentType vesim_experiment{
    .name = "vesim",
    .summary =
        "a car in traffic with two lidars, camera, radar, IMU and GPS: fused tracks and position against the truth",
    .reasons = kVesimReasons,
    .run = run_vesim_experiment,
};

}  // namespace sf::scenarios
