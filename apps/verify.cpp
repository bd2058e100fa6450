// `verify`: a recorded run computed again, on this device and in plain C++, beside what was recorded.

#include <fmt/format.h>

#include "apps/commands.h"
#include "apps/progress_line.h"
#include "apps/report.h"
#include "apps/stop_signals.h"
#include "apps/text.h"
#include "scenarios/merging.h"
#include "scenarios/verification.h"

namespace sf::apps {

namespace {

std::string line_of(const scenarios::Comparison& c, const std::string& by) {
  const std::string verdict =
      c.different > 0   ? fmt::format("{} of {} numbers DIFFER, by up to {:.3g}", c.different, c.values, c.largest)
      : c.largest > 0.0 ? fmt::format("within what their modes may be off by: up to {:.3g}", c.largest)
                        : "the same to the bit";
  std::string text = row(c.type, "{}, {}, {}", counted(c.readings, "reading"), by, verdict);
  if (c.different > 0) text += row("", "first: " + c.first);
  return text;
}

}  // namespace

std::string text_of(const scenarios::Verification& v, bool readings_recorded) {
  std::string text = row("ticks", std::to_string(v.ticks));
  for (const scenarios::Comparison& c : v.recomputed) text += line_of(c, "this device beside the recording");
  if (v.reference.readings > 0)
    text += line_of(v.reference, readings_recorded ? "plain C++ beside the recording" : "plain C++ beside this device");
  if (v.reference.readings < v.scans)
    text += row("", "a sample: {} of {} scans, spread evenly over the run (--all: every one)", v.reference.readings,
                v.scans);
  if (!readings_recorded && v.reference.readings > 0)
    text += row("note", "the run kept no readings (run --record-readings): what its poses give here was checked");
  for (const std::string& skipped : v.skipped) text += row("skipped", skipped);
  if (v.missing > 0) text += row("missing", counted(v.missing, "recorded reading") + " that no sensor was due to make");
  for (const std::string& damage : v.damage) text += row("damage", damage);
  return text + row("verdict", !v.sound()      ? "NOT SOUND"
                               : v.interrupted ? "sound as far as it went: interrupted"
                                               : "sound");
}

int verify(const VerifyOptions& options) {
  const record::Recording recording = scenarios::open_run(options.recording);
  print_damage(recording);
  gpu::Device device(options.device);
  install_stop_handlers();
  scenarios::Verification verification;
  {
    Progress progress("verifying");
    verification = scenarios::verify(
        recording, device, {.sample = options.sample, .threads = options.threads, .progress = [&](double part) {
                              progress.show(part);
                              return !stop_requested();
                            }});
  }
  const bool recorded = recording.info.estimated || !recording.readings.empty();
  print(options.json ? json_of(verification) : text_of(verification, recorded));
  return verification.sound() ? 0 : 1;
}

}  // namespace sf::apps
