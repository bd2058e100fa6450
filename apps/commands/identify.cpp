// `identify`: learns a model of one sensor from others, from recordings.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "apps/commands/commands.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "base/thread_pool.h"
#include "scenarios/experiment.h"
#include "scenarios/identification.h"
#include "scenarios/recording_merge.h"

namespace sf::apps {

namespace {

/// Parses "NAME=LEAST,MOST".
scenarios::InputBounds bounds_of(const std::string& text) {
  scenarios::InputBounds bounds;
  const std::size_t equal = text.rfind('='), comma = text.find(',', std::min(equal, text.size()));
  const auto number = [&](std::size_t first, std::size_t last, double& value) {
    const char* const end = text.data() + last;
    return std::from_chars(text.data() + first, end, value).ptr == end && first < last;
  };
  if (comma == std::string::npos || !number(equal + 1, comma, bounds.least) ||
      !number(comma + 1, text.size(), bounds.most) || !(bounds.least <= bounds.most))
    throw base::InputError(fmt::format("--where {}: expected NAME=LEAST,MOST, such as gyro.rate_rad_s=-1,1", text));
  bounds.name = text.substr(0, equal);
  return bounds;
}

scenarios::IdentificationData read_all(const IdentifyOptions& options) {
  scenarios::IdentificationSignals signals{options.robot, options.inputs, options.output, options.rate};
  if (!options.between.empty() && !(options.between[0] <= options.between[1]))
    throw base::InputError("--between: expected LEAST,MOST, the smaller number first");
  if (std::ranges::find(options.inputs, options.output) != options.inputs.end())
    throw base::InputError(fmt::format("--output {} is one of the inputs; expected another sensor", options.output));
  if (!options.between.empty()) signals.least = options.between[0], signals.most = options.between[1];
  for (const std::string& text : options.where) signals.where.push_back(bounds_of(text));
  scenarios::IdentificationData data;
  for (const std::string& place : options.recordings) {
    const record::Recording recording = scenarios::open_run(place);
    print_damage(recording);
    scenarios::add_recording(recording, signals, data);
    if (stop_requested()) throw Incomplete("interrupted: no model was written");
  }
  return data;
}

std::vector<estimation::Structure> candidates_of(const IdentifyOptions& options, std::uint32_t inputs) {
  std::vector<scenarios::ModelKind> kinds;
  for (const std::string& kind : options.kinds)
    kinds.push_back(static_cast<scenarios::ModelKind>(std::ranges::find(scenarios::kModelKinds, kind) -
                                                      std::begin(scenarios::kModelKinds)));
  std::vector<estimation::Structure> all = scenarios::structures_of(kinds, inputs, options.lags, options.hidden);
  if (all.empty())
    throw base::InputError(
        fmt::format("{} numbers of the inputs at {} steps are more than the {} that a model may have: "
                    "choose fewer --lags or --inputs",
                    inputs, *std::ranges::min_element(options.lags), estimation::kMostRegressors));
  return all;
}

std::string table_of(const estimation::Selection& selection, const std::string& unit) {
  std::string text = fmt::format("{:<28} {:>14} {:>14}   RMS error [{}], in cross-validation\n", "model", "one step",
                                 "free run", unit);
  for (std::size_t i = 0; i < selection.candidates.size(); ++i) {
    const estimation::Candidate& each = selection.candidates[i];
    text += fmt::format("{:<28} {:>14.6g} {:>14.6g}{}\n", scenarios::structure_name(each.structure),
                        each.error.one_step, each.error.free_run, i == selection.chosen ? "   chosen" : "");
  }
  return text;
}

}  // namespace

int identify(const IdentifyOptions& options) {
  install_stop_handlers();
  const std::filesystem::path folder = std::filesystem::path(options.out).parent_path();
  if (!folder.empty()) scenarios::make_folder(folder.string());  // before the work
  scenarios::IdentificationData data = read_all(options);
  const std::vector<estimation::Structure> structures = candidates_of(options, data.signals.inputs);
  base::ThreadPool thread_pool(options.threads);
  estimation::Selection selection;
  {
    Progress progress("identifying");
    selection = estimation::select_structure(structures, data.signals,
                                             {.fit = {.seed = options.seed},
                                              .folds = options.folds,
                                              .free_run = !options.measured,
                                              .progress =
                                                  [&](double part) {
                                                    progress.show(part);
                                                    return !stop_requested();
                                                  }},
                                             thread_pool);
  }
  if (stop_requested()) throw Incomplete("interrupted: no model was written");
  if (selection.model.weights.empty())
    throw base::InputError(
        fmt::format("{} steps are too few for any of {} models, or none predicts '{}': record longer "
                    "runs, or try fewer --lags and --hidden",
                    data.signals.size(), structures.size(), data.model.output));
  data.model.regression = std::move(selection.model);
  scenarios::write_text(options.out, sensors::text_of(data.model));
  const std::size_t unit = data.model.output.rfind('.');
  print(table_of(selection, data.model.output.substr(unit == std::string::npos ? 0 : unit + 1)) +
        row("steps", data.signals.size()) + row("output", data.model.output) + row("model", options.out));
  return 0;
}

}  // namespace sf::apps
