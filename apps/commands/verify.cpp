// `verify`: recomputes a recorded run on this device and in plain C++ and compares the results with the recording. Also
// compares another accuracy mode with `exact`.

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "apps/commands/commands.h"
#include "apps/options/open_device.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "scenarios/recorded_accuracy.h"
#include "scenarios/recording_merge.h"
#include "scenarios/recording_verification.h"

namespace sf::apps {

namespace {

std::string line_of(const scenarios::Comparison& c, const std::string& by) {
  const std::string verdict =
      c.different > 0   ? fmt::format("{} of {} numbers DIFFER, by up to {:.3g}", c.different, c.values, c.largest)
      : c.largest > 0.0 ? fmt::format("within the error bounds of their modes: up to {:.3g}", c.largest)
                        : "bitwise equal";
  std::string text = row(c.type, "{}, {}, {}", counted(c.readings, "reading"), by, verdict);
  if (c.different > 0) text += row("", "first: " + c.first);
  return text;
}

/// Infinite: only one of the two readings is finite.
std::string error_text(double error, const std::string& unit) {
  return std::isinf(error) ? "infinite" : quantity_text(error, unit);
}

std::string verdict_of(const scenarios::Verification& v) {
  if (v.faulty()) return "NOT SOUND";
  if (!v.sound()) return v.interrupted ? "nothing was compared: interrupted" : "nothing could be compared";
  if (v.interrupted) return "sound up to the interruption";
  return v.truncated ? "sound up to its end, but the recording was not finished" : "sound";
}

scenarios::VerifyOptions verify_options(const VerifyOptions& options, Progress& progress) {
  return {.sample = options.sample, .threads = options.threads, .progress = [&progress](double part) {
            progress.show(part);
            return !stop_requested();
          }};
}

/// Returns nullopt if no mode was requested.
std::optional<scenarios::RecordedAccuracy> measure_accuracy(const VerifyOptions& options,
                                                            const record::Recording& recording, gpu::Device& device) {
  if (options.accuracy.empty()) return std::nullopt;
  Progress progress("measuring");
  return scenarios::recorded_accuracy(recording, device, options.accuracy, verify_options(options, progress));
}

}  // namespace

std::string recorded_accuracy_text(const scenarios::RecordedAccuracy& a) {
  std::string text = fmt::format("Errors of \"{}\" against exact at the recorded poses, both without noise, {}:\n",
                                 a.words, counted(a.ticks, "tick"));
  text += fmt::format("{:<13} {:<8} {:>10} {:>9} {:>10} {:>10} {:>10} {:>11} {:>11} {:>11}\n", "sensor", "mode",
                      "values", "error 0", "median", "99 %", "largest", "covered", "largest", "bound");
  for (const scenarios::ModeErrors& t : a.types) {
    const scenarios::ErrorDistribution& e = t.errors;
    text +=
        fmt::format("{:<13} {:<8} {:>10} {:>7.2f} % {:>10} {:>10} {:>10} {:>9.2f} % {:>11} {:>11}\n", t.sensor, t.mode,
                    e.count(), 100.0 * e.zero(), error_text(e.quantile(0.5), t.unit),
                    error_text(e.quantile(0.99), t.unit), error_text(e.max(), t.unit), 100.0 * e.covered(),
                    e.covered() > 0.0 ? error_text(e.covered_max(), t.unit) : "-", quantity_text(e.bound(), t.unit));
  }
  if (a.types.empty()) text += "no sensor of the recorded world has accuracy modes\n";
  for (const scenarios::ModeErrors& t : a.types)
    if (t.noisy) text += fmt::format("{}: the recorded sensors have noise, which these errors exclude\n", t.sensor);
  for (const std::string& note : a.notes) text += note + "\n";
  if (a.interrupted) text += "interrupted: not all ticks were computed\n";
  return text + (a.within_bounds() ? "\n" : "AN ERROR IS BEYOND ITS STATED BOUND\n\n");
}

std::string verification_text(const scenarios::Verification& v, bool readings_recorded) {
  std::string text = row("ticks", std::to_string(v.ticks));
  for (const scenarios::Comparison& c : v.recomputed) text += line_of(c, "this device against the recording");
  if (v.reference.readings > 0)
    text +=
        line_of(v.reference, readings_recorded ? "plain C++ against the recording" : "plain C++ against this device");
  if (v.reference.readings < v.scans)
    text += row("", "a sample: {} of {} scans, spread evenly over the run (--all: every one)", v.reference.readings,
                v.scans);
  if (!readings_recorded && v.reference.readings > 0)
    text += row(
        "note",
        "the run has no recorded readings (run --record-readings): readings computed here from its poses were checked");
  for (const std::string& skipped : v.skipped) text += row("skipped", skipped);
  if (v.missing > 0) text += row("missing", counted(v.missing, "recorded reading") + " for which no sensor was due");
  for (const std::string& damage : v.damage) text += row("damage", damage);
  return text + row("verdict", verdict_of(v));
}

int verify(const VerifyOptions& options) {
  const record::Recording recording = scenarios::open_run(options.recording);
  print_damage(recording);
  gpu::Device device = open_device(options);
  install_stop_handlers();
  const auto accuracy = measure_accuracy(options, recording, device);
  scenarios::Verification verification;
  {
    Progress progress("verifying");
    verification = scenarios::verify(recording, device, verify_options(options, progress));
  }
  const bool recorded = recording.info.estimated || !recording.readings.empty();
  print(options.json ? verification_json(verification, accuracy ? &*accuracy : nullptr)
                     : (accuracy ? recorded_accuracy_text(*accuracy) : "") + verification_text(verification, recorded));
  if (verification.faulty() || (accuracy && !accuracy->within_bounds())) return 1;
  if (verification.interrupted || (accuracy && accuracy->interrupted)) return interrupted_code();
  // If there are readings, they must be checked. Without readings, the file and its states were checked.
  return verification.sound() || recording.readings.empty() ? 0 : 1;
}

}  // namespace sf::apps
