// `derive`: computes derived sensors from the readings of a recording.

#include <fmt/format.h>

#include <filesystem>
#include <optional>

#include "apps/commands/commands.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/recording_csv.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/error.h"
#include "record/recorder.h"
#include "scenarios/experiment.h"
#include "scenarios/foreign_recording.h"
#include "scenarios/recorded_states.h"
#include "scenarios/recording_merge.h"

namespace sf::apps {

namespace {

scenarios::DerivedSource open_source(const std::string& place, const scenarios::DeriveFile& file) {
  scenarios::DerivedSource source;
  if (file.inputs.empty()) {
    source.recording = scenarios::open_run(place);
    if (!record::option_of(source.recording.info, scenarios::kTimeZero).empty())
      throw base::InputError(place, 0,
                             "was derived from the recording of another program, and has the ticks of deliveries only: "
                             "derive from that recording");
    source.world = scenarios::recorded_world(source.recording);
  } else {
    source = scenarios::read_foreign(place, file);
  }
  scenarios::add_sensors(file.file, file.derived, source.world);
  return source;
}

/// The recording would be replaced while it is read.
void refuse_same_file(const std::string& recorded, const std::string& folder) {
  std::error_code ignored;
  if (std::filesystem::equivalent(recorded, folder + "/" + record::RecordingPart{}.file(), ignored) ||
      std::filesystem::equivalent(recorded, folder, ignored))
    throw base::InputError(folder, 0, "is the folder of the recording itself: choose another with -o");
}

/// Writes ticks to the recording, and derived readings to the tables.
class DerivedOutput final : public base::Sink {
 public:
  DerivedOutput(const scenarios::DerivedSource& source, const std::string& folder) : source_(source), folder_(folder) {}
  void write(const base::TickRecord& record) override {
    if (!recorder_) open();
    recorder_->write(record);
    for (const base::ReadingBlock& reading : record.readings) tables_->add(reading);
  }
  /// @pre a tick was written
  std::vector<std::string> close() {
    recorder_->finish();
    return tables_->close();
  }
  std::string recording_text() const {
    return fmt::format("{} ({:.1f} MB)", recorder_->path(), static_cast<double>(recorder_->size()) * 1e-6);
  }

 private:
  /// With the first tick, so that a source that is refused leaves no files.
  void open() {
    scenarios::make_folder(folder_);
    recorder_.emplace(folder_, scenarios::derived_run_info(source_));
    tables_.emplace(source_.world, sensors::SensorSet(source_.world), folder_);
  }

  const scenarios::DerivedSource& source_;
  const std::string& folder_;
  std::optional<record::Recorder> recorder_;
  std::optional<DerivedCsv> tables_;
};

std::string derived_text(const scenarios::DerivedReplay& replay, const record::Recording& recording) {
  std::string text = row("ticks", replay.ticks) + row("inputs", counted(replay.inputs, "reading")) +
                     row("derived", counted(replay.derived, "reading"));
  if (const auto zero = record::option_of(recording.info, scenarios::kTimeZero); !zero.empty())
    text += row("time 0", "{} ns of the recording", zero);
  if (replay.equal + replay.different == 0) return text;
  text += row("recorded", "{} derived before: {}", counted(replay.equal + replay.different, "reading"),
              replay.different == 0 ? "bitwise equal" : fmt::format("{} DIFFER", replay.different));
  if (replay.different > 0) text += row("", "first: " + replay.first);
  return text;
}

}  // namespace

int derive(const DeriveOptions& options) {
  install_stop_handlers();
  const scenarios::DeriveFile file = scenarios::read_derive_file(options.with);
  const scenarios::DerivedSource source = open_source(options.recording, file);
  print_damage(source.recording);
  refuse_same_file(source.recording.file, options.out);
  DerivedOutput output(source, options.out);
  scenarios::DerivedReplay replay;
  {
    Progress progress("deriving");
    replay = scenarios::replay_derived(source, output, {options.threads, [&](double part) {
                                                          progress.show(part);
                                                          return !stop_requested();
                                                        }});
  }
  if (replay.interrupted) throw Incomplete("interrupted: the recording ends there, and no table was written");
  const std::vector<std::string> tables = output.close();
  std::string text = derived_text(replay, source.recording) + row("recording", output.recording_text());
  for (const std::string& table : tables) text += row("table", table);
  print(text);
  print_never_valid(replay.never_valid);
  return replay.different == 0 ? 0 : 1;
}

}  // namespace sf::apps
