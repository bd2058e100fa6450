// `merge`: merges the recordings of ranks that shared a fleet.

#include "apps/commands/commands.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/text.h"
#include "base/thread_pool.h"
#include "scenarios/recording_merge.h"

namespace sf::apps {

namespace {

scenarios::MergedRecording merge_until_stopped(const MergeOptions& options) {
  try {
    return scenarios::merge_recordings(options.places, options.out, [] { return stop_requested().load(); });
  } catch (const base::Interrupted&) {
    throw Incomplete("interrupted: nothing was written, and existing files are unchanged");
  }
}

}  // namespace

int merge(const MergeOptions& options) {
  install_stop_handlers();
  const scenarios::MergedRecording merged = merge_until_stopped(options);
  for (const std::string& damage : merged.damage) print_message("{}", damage);
  if (merged.truncated)
    print_message("a rank did not finish its recording: only the {} ticks that all ranks recorded are merged",
                  merged.ticks);
  print(row("ticks", merged.ticks) +
        row("recording", "{} ({:.1f} MB)", merged.file, static_cast<double>(merged.bytes) * 1e-6));
  return merged.damage.empty() ? 0 : 1;
}

}  // namespace sf::apps
