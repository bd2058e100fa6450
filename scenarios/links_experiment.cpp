// Mean speeds of links from probe vehicles and loop detectors, against those of all vehicles: a corridor at full size
// and SimVille.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "scenarios/experiment.h"
#include "scenarios/link_runs.h"
#include "scenarios/statistics.h"
#include "viz/series_figure.h"

namespace sf::scenarios {

namespace {

constexpr std::uint32_t kLinkSeeds = 10;

struct TrafficPlace {
  LinkPlan plan;
  LinkRun (*run)(const ExperimentContext& context, std::uint64_t seed);
  std::vector<LinkRun> runs = {};
};

/// Errors and coverage of one set of sensors.
struct LinkScore {
  std::size_t truths = 0, valid = 0;
  double squares = 0.0, errors = 0.0, absolute = 0.0, normalized = 0.0, relative = 0.0;
  std::map<std::uint32_t, std::array<std::size_t, 2>> links;                                ///< valid, all
  std::map<std::pair<std::uint64_t, std::uint32_t>, std::array<std::size_t, 2>> intervals;  ///< by seed
};

LinkScore score_of(const std::vector<LinkRun>& runs, std::size_t set) {
  LinkScore score;
  for (const LinkRun& run : runs)
    for (const LinkCell& cell : run.cells) {
      if (std::isnan(cell.truth)) continue;
      const bool valid = std::isfinite(cell.speeds[set]);
      ++score.truths, score.valid += valid;
      auto &link = score.links[cell.link], &interval = score.intervals[{cell.seed, cell.interval}];
      ++link[1], ++interval[1], link[0] += valid, interval[0] += valid;
      if (!valid) continue;
      const double e = cell.speeds[set] - cell.truth;
      score.squares += e * e, score.errors += e, score.absolute += std::abs(e);
      score.normalized += e * e / cell.variances[set];
      score.relative += cell.truth;
    }
  return score;
}

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? NAN : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

/// Share [%] of links, or intervals, of which at least `least` of the cells are valid.
template <class Cells>
double covered(const Cells& cells, double least) {
  std::size_t enough = 0;
  for (const auto& [key, counts] : cells)
    enough += static_cast<double>(counts[0]) >= least * static_cast<double>(counts[1]);
  return share(enough, cells.size());
}

std::string links_csv(const std::vector<TrafficPlace>& places) {
  std::string text = "place,seed,interval,link,truth_m_s,probes_percent,loops,speed_m_s,sigma_m_s\n";
  for (const TrafficPlace& place : places)
    for (const LinkRun& run : place.runs)
      for (const LinkCell& cell : run.cells)
        for (std::size_t set = 0; set < std::size(kLinkSets); ++set) {
          const auto number = [](double v) { return std::isfinite(v) ? fmt::format("{:.4g}", v) : ""; };
          text += fmt::format("{},{},{},{},{},{},{},{},{}\n", place.plan.name, cell.seed, cell.interval,
                              run.links[cell.link], number(cell.truth), kLinkSets[set].percent,
                              kLinkSets[set].loops ? 1 : 0, number(cell.speeds[set]),
                              number(std::sqrt(cell.variances[set])));
        }
  return text;
}

/// Mean and standard deviation of the truth [m/s].
ErrorStatistics truth_of(const std::vector<LinkRun>& runs) {
  std::vector<double> truths;
  for (const LinkRun& run : runs)
    for (const LinkCell& cell : run.cells)
      if (std::isfinite(cell.truth)) truths.push_back(cell.truth);
  return statistics_of(truths);
}

std::string place_table(const TrafficPlace& place) {
  const ErrorStatistics truth = truth_of(place.runs);
  std::string text = fmt::format(
      "## {}\n\n{} runs, {} vehicles, {} links, intervals of {:g} s. All vehicles: {:.3f} m/s in the mean, standard "
      "deviation {:.3f} m/s. Target: {:.3f} m/s.\n\n"
      "| probes | loops | valid [%] | links valid in 90 % of the time [%] | intervals with all links valid [%] | RMS "
      "error [m/s] | mean error [m/s] | mean absolute error [%] | NEES | within the target |\n"
      "|---|---|---|---|---|---|---|---|---|---|\n",
      place.plan.name, place.runs.size(), place.runs[0].vehicles, place.runs[0].links.size(), place.plan.interval,
      truth.mean, truth.deviation, place.plan.target);
  for (std::size_t set = 0; set < std::size(kLinkSets); ++set) {
    const LinkScore s = score_of(place.runs, set);
    const auto n = static_cast<double>(s.valid);
    const double rms = std::sqrt(s.squares / n);
    text += fmt::format("| {} % ({}) | {} | {:.0f} | {:.0f} | {:.0f} | {:.3f} | {:+.3f} | {:.0f} | {:.2f} | {} |\n",
                        kLinkSets[set].percent, probes_of(kLinkSets[set], place.runs[0].vehicles),
                        kLinkSets[set].loops ? "yes" : "no", share(s.valid, s.truths), covered(s.links, 0.9),
                        covered(s.intervals, 1.0), rms, s.errors / n, 100.0 * s.absolute / s.relative, s.normalized / n,
                        rms <= place.plan.target ? "yes" : "no");
  }
  return text + "\n";
}

/// One link's speeds over time: truth, and three estimates.
void draw_link(const TrafficPlace& place, std::uint32_t link, const std::string& file) {
  constexpr std::pair<std::size_t, const char*> kDrawn[] = {
      {0, "loops"}, {3, "10 % probes"}, {4, "10 % and loops"}, {6, "30 % and loops"}};
  viz::Panel panel{.y_name = "speed [m/s]", .series = {{"all vehicles", {}, {}}}, .from_zero = true};
  for (const auto& [set, name] : kDrawn) panel.series.push_back({name, {}, {}});
  for (const LinkCell& cell : place.runs[0].cells) {
    if (cell.link != link) continue;
    for (viz::Series& series : panel.series) series.times.push_back(cell.interval * place.plan.interval);
    panel.series[0].values.push_back(cell.truth);
    for (std::size_t k = 0; k < std::size(kDrawn); ++k)
      panel.series[k + 1].values.push_back(cell.speeds[kDrawn[k].first]);
  }
  viz::draw_series({.title = fmt::format("{}: link {}", place.plan.name, place.runs[0].links[link]), .panels = {panel}},
                   file);
}

LinkRun run_whole_corridor(const ExperimentContext& context, std::uint64_t seed) {
  return run_corridor(context, seed, kCorridorEnd);
}

std::vector<std::string> run_links(const ExperimentContext& context) {
  if (!reports(context)) return {};
  std::vector<TrafficPlace> places{{corridor_plan(), run_whole_corridor}, {town_plan(), run_town_links}};
  for (std::size_t p = 0; p < places.size(); ++p)
    for (std::uint32_t k = 0; k < kLinkSeeds; ++k) {
      if (context.progress)
        context.progress(static_cast<double>(p * kLinkSeeds + k) / static_cast<double>(places.size() * kLinkSeeds),
                         places[p].plan.name);
      places[p].runs.push_back(places[p].run(context, context.options.seed + k));
    }
  std::vector<std::string> files;
  const auto next = [&](const std::string& name) { return files.emplace_back(in_folder(context, name)); };
  write_text(next("results.csv"), links_csv(places));
  std::string report = fmt::format(
      "# Speeds of links from probes and loops\n\nSeeds {} to {}. The filters' constants were set before the first run "
      "and not tuned.\n\n",
      context.options.seed, context.options.seed + kLinkSeeds - 1);
  for (const TrafficPlace& place : places) report += place_table(place);
  write_text(next("report.md"), report + std::string(context.type.reasons) + "\n");
  draw_link(places[0], 1, next("corridor.png"));
  draw_link(places[1], 0, next("simville.png"));
  return files;
}

constexpr std::string_view kLinksReasons =
    "The target is 7 km/h at full size. SimVille has 1/7 of all lengths and unscaled time, so speeds are 1/7: 0.278 "
    "m/s. Its cars drive at most 0.5 m/s (13 km/h), so the target is not demanding there; the error in percent is.";

}  // namespace

extern const ExperimentType links_experiment;

constinit const ExperimentType links_experiment{
    .name = "links",
    .summary = "speeds of roads from probe vehicles and loop detectors, against those of all vehicles",
    .fixed_trials = true,
    .plant = Plant::ideal,
    .reasons = kLinksReasons,
    .run = run_links,
};

}  // namespace sf::scenarios
