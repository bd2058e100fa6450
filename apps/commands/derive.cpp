// `derive`: replays a recording through derived sensors that it did not have.

#include <fmt/format.h>

#include "apps/commands/commands.h"
#include "apps/options/recording_part.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/recording_csv.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "record/recorder.h"
#include "scenarios/derive.h"
#include "scenarios/recorded_states.h"
#include "scenarios/recording_merge.h"
#include "scenarios/run_info.h"

namespace sf::apps {

int derive(const DeriveOptions& options) {
  const record::Recording recording = scenarios::open_run(options.recording);
  print_damage(recording);
  world::World world = scenarios::recorded_world(recording);
  const auto added = scenarios::add_derived_sensors(world, options.with);
  const sensors::SensorSet sensor_set(world);
  record::Recorder recorder(options.out, scenarios::run_info(world, sensor_set,
                                                             {.seed = recording.info.seed,
                                                              .record_readings = true,
                                                              .caster = "none: derived from " + options.recording,
                                                              .joined = recording.info.joined}));
  install_stop_handlers();
  {
    Progress progress("deriving");
    scenarios::derive(recording, world, added, options.threads, recorder, [&](double part) {
      progress.show(part);
      return stop_requested().load();
    });
  }
  recorder.finish();
  const RecordingPart part = open_part(options.out, {});
  const auto files = write_readings_csv(part, options.out);
  print(row("sensors", "{}", added.size()) + row("readings", "{}", part.recording.readings.size()) +
        row("recording", "{}", recorder.path()) + row("tables", "{}", fmt::join(files, ", ")));
  return stop_requested().load() ? interrupted_code() : 0;
}

}  // namespace sf::apps
