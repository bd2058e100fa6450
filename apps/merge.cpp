// `merge`: recordings of the ranks that shared a fleet, as one.

#include "apps/commands.h"
#include "apps/text.h"
#include "scenarios/merging.h"

namespace sf::apps {

int merge(const MergeOptions& options) {
  const scenarios::MergedRecording merged = scenarios::merge_recordings(options.places, options.out);
  for (const std::string& damage : merged.damage) print_message("{}", damage);
  if (merged.truncated)
    print_message("a rank did not finish its recording: merged are the {} ticks that all have", merged.ticks);
  print(row("ticks", merged.ticks) +
        row("recording", "{} ({:.1f} MB)", merged.file, static_cast<double>(merged.bytes) * 1e-6));
  return merged.damage.empty() ? 0 : 1;
}

}  // namespace sf::apps
