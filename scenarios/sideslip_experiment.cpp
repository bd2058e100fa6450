// Observers of a car's sideslip and tyre forces, after Stephant, Charara and Meizel: manoeuvres from 0.2 to 0.9 g with
// three sets of sensors, for a car that understeers and for a neutral one.

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include "base/thread_pool.h"
#include "scenarios/experiment.h"
#include "scenarios/sideslip_runs.h"
#include "viz/series_figure.h"

namespace sf::scenarios {

namespace {

using estimation::kSideslipObservers;
using estimation::SideslipObserver;

constexpr double kLevels[] = {0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9};
constexpr double kDegrees = 180.0 / M_PI;

/// One car in one manoeuvre at one level: what a thread computes.
struct Case {
  std::string_view name;
  robots::CarModel car;
  Manoeuvre manoeuvre = Manoeuvre::step_steer;
  double level = 0.0;
  SideslipRun run;
  std::vector<SideslipRow> rows;                ///< by sensors, then by observer
  std::vector<ObservabilityRow> observability;  ///< by sensors, each nonlinear and linear
};

std::vector<Case> all_cases() {
  robots::CarModel neutral;
  neutral.front_stiffness = neutral.rear_stiffness;
  std::vector<Case> cases;
  for (const bool is_neutral : {false, true})
    for (std::size_t m = 0; m < std::size(kManoeuvres); ++m)
      for (const double level : kLevels) {
        Case& each = cases.emplace_back();
        each.name = is_neutral ? "neutral" : "understeering";
        if (is_neutral) each.car = neutral;
        each.manoeuvre = static_cast<Manoeuvre>(m), each.level = level;
      }
  return cases;
}

void compute(const ExperimentOptions& options, Case& each) {
  each.run = drive_manoeuvre(each.car, each.manoeuvre, each.level);
  for (std::size_t s = 0; s < std::size(kSideslipSensors); ++s) {
    const auto sensors = static_cast<SideslipSensors>(s);
    for (std::size_t o = 0; o < kSideslipObservers.size(); ++o) {
      if (options.stop && options.stop()) throw base::Interrupted();
      each.rows.push_back(
          evaluate(each.run, each.car, sensors, static_cast<SideslipObserver>(o), options.trials, options.seed));
    }
    if (sensors == SideslipSensors::none) continue;
    for (const bool linear : {false, true})
      each.observability.push_back(observability_along(each.run, each.car, sensors, linear));
  }
}

std::string results_csv(std::span<const Case> cases) {
  std::string text =
      "car,manoeuvre,level_g,reached_g,sensors,observer,peak_deg,rms_deg,worst_deg,front_rms_n,rear_rms_n,nees,"
      "tracks\n";
  for (const Case& each : cases)
    for (const SideslipRow& r : each.rows)
      text += fmt::format("{},{},{:g},{:.4g},{},{},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:.4g},{:d}\n", each.name,
                          kManoeuvres[static_cast<std::size_t>(r.manoeuvre)], r.level, r.reached,
                          kSideslipSensors[static_cast<std::size_t>(r.sensors)],
                          kSideslipObservers[static_cast<std::size_t>(r.observer)], r.peak_deg, r.rms_deg, r.worst_deg,
                          r.front_rms_n, r.rear_rms_n, r.nees, r.tracks());
  return text;
}

std::string observability_csv(std::span<const Case> cases) {
  std::string text = "car,manoeuvre,level_g,sensors,model,rank_min,rank_max,effect_min,effect_median,share\n";
  for (const Case& each : cases)
    for (const ObservabilityRow& r : each.observability)
      text += fmt::format("{},{},{:g},{},{},{},{},{:.3g},{:.3g},{:.3g}\n", each.name,
                          kManoeuvres[static_cast<std::size_t>(r.manoeuvre)], r.level,
                          kSideslipSensors[static_cast<std::size_t>(r.sensors)], r.linear ? "linear" : "burckhardt",
                          r.least_rank, r.most_rank, r.least, r.median, r.share);
  return text;
}

/// Returns the largest level [g] up to which an observer tracks a car's manoeuvre; 0: none.
double limit_of(std::span<const Case> cases, std::string_view car, Manoeuvre manoeuvre, std::size_t row) {
  double limit = 0.0;
  for (const Case& each : cases) {
    if (each.name != car || each.manoeuvre != manoeuvre) continue;
    if (!each.rows[row].tracks()) break;
    limit = each.level;
  }
  return limit;
}

std::string limits_table(std::span<const Case> cases, std::string_view car) {
  std::string text = fmt::format("\n## Limits: {} car\n\n| sensors | observer |", car);
  for (const std::string_view name : kManoeuvres) text += fmt::format(" {} [g] |", name);
  text += "\n|---|---|---|---|---|\n";
  for (std::size_t row = 0; row < cases[0].rows.size(); ++row) {
    const SideslipRow& first = cases[0].rows[row];
    text += fmt::format("| {} | {} |", kSideslipSensors[static_cast<std::size_t>(first.sensors)],
                        kSideslipObservers[static_cast<std::size_t>(first.observer)]);
    for (std::size_t m = 0; m < std::size(kManoeuvres); ++m) {
      const double limit = limit_of(cases, car, static_cast<Manoeuvre>(m), row);
      text += limit > 0.0 ? fmt::format(" {:g} |", limit) : std::string(" - |");
    }
    text += "\n";
  }
  return text;
}

std::string observability_table(std::span<const Case> cases) {
  std::string text =
      "\n## Observability\n\nRank of the local observability matrix along the slalom at 0.2 and 0.9 g, and the effect "
      "of the sideways speed alone (median; less than 0.02 counts as none).\n\n| car | model | sensors | components | "
      "rank, 0.2 g | effect | rank, 0.9 g | effect |\n|---|---|---|---|---|---|---|---|\n";
  const auto find = [&](std::string_view car, double level) {
    return std::ranges::find_if(cases, [&](const Case& each) {
      return each.name == car && each.manoeuvre == Manoeuvre::slalom && each.level == level;
    });
  };
  for (const std::string_view car : {"understeering", "neutral"})
    for (std::size_t k = 0; k < cases[0].observability.size(); ++k) {
      const ObservabilityRow &low = find(car, kLevels[0])->observability[k],
                             &high = find(car, std::end(kLevels)[-1])->observability[k];
      const auto rank = [](const ObservabilityRow& r) {
        return r.least_rank == r.most_rank ? fmt::format("{}", r.most_rank)
                                           : fmt::format("{} to {}", r.least_rank, r.most_rank);
      };
      text += fmt::format("| {} | {} | {} | {} | {} | {:.3f} | {} | {:.3f} |\n", car,
                          low.linear ? "linear" : "burckhardt", kSideslipSensors[static_cast<std::size_t>(low.sensors)],
                          low.linear ? 2 : 3, rank(low), low.median, rank(high), high.median);
    }
  return text;
}

std::string sideslip_report(const ExperimentContext& context, std::span<const Case> cases) {
  std::string text = fmt::format(
      "# Sideslip and tyre forces\n\n{}, seeds from {}. An observer tracks a manoeuvre up to a level if, at it and all "
      "lower ones, no error of the sideslip exceeds 1 degree and its RMS is at most 20 % of the peak. Sensors `none`: "
      "the model alone, with its inputs (steering angle, torque).\n",
      counted(context.options.trials, "trial"), context.options.seed);
  for (const std::string_view car : {"understeering", "neutral"}) text += limits_table(cases, car);
  text += observability_table(cases);
  for (const Case& each : cases)
    if (each.run.reached < 0.99 * each.level)
      text += fmt::format("\nThe {} car reaches only {:.2f} g in the {} asked to reach {:g} g.\n", each.name,
                          each.run.reached, kManoeuvres[static_cast<std::size_t>(each.manoeuvre)], each.level);
  return text + fmt::format("\n## What it shows\n\n{}\n", context.type.reasons);
}

/// Draws the RMS error over the level, one panel per set of sensors.
std::string draw_levels(const ExperimentContext& context, std::span<const Case> cases, Manoeuvre manoeuvre) {
  const std::string_view name = kManoeuvres[static_cast<std::size_t>(manoeuvre)];
  viz::SeriesOptions figure{.title = fmt::format("Sideslip error: {}", name),
                            .subtitle = fmt::format("understeering car, {}", counted(context.options.trials, "trial")),
                            .x_name = "lateral acceleration [g]"};
  for (std::size_t s = 1; s < std::size(kSideslipSensors); ++s) {
    viz::Panel panel{.title = std::string(kSideslipSensors[s]), .y_name = "RMS [deg]", .from_zero = true};
    for (std::size_t o = 0; o < kSideslipObservers.size(); ++o) {
      viz::Series series{std::string(kSideslipObservers[o]), {}, {}};
      for (const Case& each : cases) {
        if (each.name != cases[0].name || each.manoeuvre != manoeuvre) continue;
        series.times.push_back(each.run.reached);
        series.values.push_back(each.rows[s * kSideslipObservers.size() + o].rms_deg);
      }
      panel.series.push_back(std::move(series));
    }
    figure.panels.push_back(std::move(panel));
  }
  const std::string file = in_folder(context, fmt::format("levels-{}.png", name));
  viz::draw_series(figure, file);
  return file;
}

/// Draws truth and estimates of the first trial over time.
std::string draw_estimates(const ExperimentContext& context, const Case& each, SideslipSensors sensors) {
  const std::string_view set = kSideslipSensors[static_cast<std::size_t>(sensors)];
  const std::string_view name = kManoeuvres[static_cast<std::size_t>(each.manoeuvre)];
  viz::SeriesOptions figure{.title = fmt::format("Sideslip and tyre forces: {} to {:g} g", name, each.level),
                            .subtitle = fmt::format("{} car, sensors: {}", each.name, set)};
  figure.panels = {{.y_name = "sideslip [deg]"}, {.y_name = "front [kN]"}, {.y_name = "rear [kN]"}};
  const auto add = [&](std::string_view line, const auto& values) {
    for (viz::Panel& panel : figure.panels) panel.series.push_back({std::string(line), {}, {}});
    for (std::size_t k = 0; k < values.size(); ++k) {
      const double numbers[] = {kDegrees * values[k].sideslip, 1e-3 * values[k].force.front,
                                1e-3 * values[k].force.rear};
      for (std::size_t p = 0; p < std::size(numbers); ++p) {
        figure.panels[p].series.back().times.push_back(each.run.moments[k].time);
        figure.panels[p].series.back().values.push_back(numbers[p]);
      }
    }
  };
  add("truth", each.run.moments);
  const SideslipErrors errors;
  const auto signals = signals_of(each.run, errors, context.options.seed);
  for (std::size_t o = 0; o < kSideslipObservers.size(); ++o)
    add(kSideslipObservers[o],
        observe(observer_of(each.car, static_cast<SideslipObserver>(o), errors, context.options.seed), sensors,
                signals));
  const std::string file = in_folder(context, fmt::format("{}-{:g}-{}.png", name, each.level, set));
  viz::draw_series(figure, file);
  return file;
}

std::vector<std::string> run_sideslip(const ExperimentContext& context) {
  if (!reports(context)) return {};
  std::vector<Case> cases = all_cases();
  base::ThreadPool pool(context.options.threads);
  if (context.options.stop) pool.interrupt_on(context.options.stop);
  std::atomic<std::size_t> done = 0;
  pool.parallel_for_each(cases.size(), 1, [&](std::size_t k, unsigned thread) {
    compute(context.options, cases[k]);
    const std::size_t count = ++done;
    if (context.progress && thread == 0)
      context.progress(0.95 * static_cast<double>(count) / static_cast<double>(cases.size()), "manoeuvres");
  });
  std::vector<std::string> files{in_folder(context, "results.csv"), in_folder(context, "observability.csv"),
                                 in_folder(context, "report.md")};
  write_text(files[0], results_csv(cases));
  write_text(files[1], observability_csv(cases));
  write_text(files[2], sideslip_report(context, cases));
  for (std::size_t m = 0; m < std::size(kManoeuvres); ++m)
    files.push_back(draw_levels(context, cases, static_cast<Manoeuvre>(m)));
  for (const Case& each : cases) {
    if (each.name != cases[0].name || each.manoeuvre != Manoeuvre::slalom || each.level != 0.8) continue;
    for (const SideslipSensors sensors : {SideslipSensors::yaw_rate, SideslipSensors::speed, SideslipSensors::both})
      files.push_back(draw_estimates(context, each, sensors));
    files.push_back(in_folder(context, "signals.csv"));
    write_text(files.back(), signals_csv(each.run, signals_of(each.run, {}, context.options.seed)));
  }
  return files;
}

constexpr std::string_view kSideslipReasons =
    "The source (by the thesis' account): nonlinear observers do best, the speed is not needed, and all observers "
    "suffice at low lateral acceleration. With 20 trials from seed 51:\n\n"
    "- Nonlinear observers do best: confirmed from 0.4 g on where a yaw rate corrects them. At 0.9 g the linear "
    "observer then errs by 1.2 to 2.2 degrees RMS, the extended ones by 0.2 to 0.4, since the tyres' forces no "
    "longer grow with slip. Exceptions at 0.9 g: the sliding mode loses the step steer (1.2 degrees), and with the "
    "speed alone the nonlinear model errs as much as the linear one.\n"
    "- The speed is not needed: confirmed. Yaw rate and both differ by less than 0.1 degrees RMS.\n"
    "- All suffice at low lateral acceleration: confirmed as an absolute error, at most 0.2 degrees at 0.2 g. As a "
    "share of the sideslip, the linear observer with a yaw rate fails in the step steer even there.\n"
    "- Up to 0.7 g the nonlinear model alone, which measures only its inputs, tracks as well as any observer: such "
    "runs do not show that sensors help. Above, the yaw rate does.\n"
    "- Speed alone: a linear model has no output then and nothing is corrected. In the nonlinear one the sideways "
    "speed acts on the speed only through the turn, too little to track further than the model alone. The other "
    "observers than the filter leave the sideways speed to the model.\n"
    "- The neutral car: l_f C_f = l_r C_r makes the linear sideslip unobservable from the yaw rate (rank 1 of 2). "
    "Its errors are small because the model is good, not because the sideslip is measured.";

}  // namespace

extern const ExperimentType sideslip_experiment;

constinit const ExperimentType sideslip_experiment{
    .name = "sideslip",
    .summary = "sideslip and tyre forces of a car by four observers and three sets of sensors",
    .source = ExperimentSource::model,
    .reasons = kSideslipReasons,
    .run = run_sideslip,
};

}  // namespace sf::scenarios
