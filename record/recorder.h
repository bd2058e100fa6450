#pragma once
// Records a run in DIR/run.mcap while it runs:
//
//   Recorder recorder(dir, info);           // world and run info are in the file, which has its final name
//   for (...) recorder.write(tick_record);  // one chunk
//   recorder.finish();                      // summary and indexes
//
// A process killed at any time leaves a file with all ticks whose `write` returned, but for the last
// `ChunkWriter::kMaxWaiting` + 1, which a thread compresses and writes. Without compression `write` itself writes them,
// and no tick is lost.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/tick_record.h"
#include "record/chunk_writer.h"
#include "record/mcap_writer.h"
#include "record/recording_files.h"
#include "record/run_info.h"
#include "record/tick_messages.h"

namespace sf::record {

/// Part of a recording that a process writes, where several share a fleet (scenarios/merging.h), and its form.
struct RecordingPart {
  unsigned part = 0;   ///< below `parts`; 0 has all but the others' readings, the others have theirs and /clock
  unsigned parts = 1;  ///< 1: DIR/run.mcap; else DIR/rank-0.mcap and so on
  Compression compression = Compression::zstd;

  std::string file() const { return parts == 1 ? "run.mcap" : "rank-" + std::to_string(part) + ".mcap"; }
};

/// Name of the metadata with number and count of parts, in recordings with several.
inline constexpr const char* kPartMetadata = "sensorfarm.part";
/// Name of the metadata of a robot that joined: name, row of its original, pose. In the order of joining.
inline constexpr const char* kJoinedMetadata = "sensorfarm.joined";
/// The robot of such metadata; none where it is malformed.
std::optional<JoinedMover> joined_mover_of(const TextPairs& pairs);

/// One thread. A recording already in the directory is replaced in one step, once the new one contains its world.
class Recorder : public base::Sink {
 public:
  /// Creates the directory. Rule: `info.snapshot` is not empty; the interval and the rates of sensors are
  /// positive; a rate of odometry of 0 leaves odometry out.
  /// @throws base::InputError when the directory cannot be written, another run is being recorded there, or the fleet
  /// has more topics than a file can hold.
  Recorder(const std::string& directory, RunInfo info, const RecordingPart& part = {});
  /// Calls `finish` if needed and ignores its errors; call `finish` to get them.
  ~Recorder() override;

  /// Rule: every report's mover is a row of `info.movers`, its quality is there if `info.estimated`, every reading's
  /// sensor one of its sensors; time is non-decreasing.
  /// @throws base::InputError when this tick, or one of the last three with compression, could not be written whole (a
  /// full disk). All ticks before that are in the file; the recorder accepts no more.
  void write(const base::TickRecord& record) override;
  /// The run has got more movers, which are the last rows of `info.movers`: they are recorded from the next tick on.
  /// Rule: all else is as in the info before; `info.joined` begins with what was there.
  /// @throws base::InputError as `write`, and where the file cannot hold the topics; then nothing was written
  void add_movers(RunInfo info);
  /// Seals the file. Further calls, and a call after a failed `write`, do nothing. @throws base::InputError when that
  /// fails.
  void finish();

  /// A line for each name of a topic that another one has taken (name_frames), of all movers so far.
  const std::vector<std::string>& taken_names() const { return taken_names_; }
  const std::string& path() const { return file_.path(); }
  std::uint64_t size() const { return file_.size(); }  ///< [byte] in the file so far

 private:
  void add(const TopicMessage& message);
  void check_topics(const TickMessages& messages) const;
  void add_channels();
  void flush();
  void start_writer();

  std::vector<std::string> taken_names_;  ///< set by the making of `info_`
  RunInfo info_;
  GrowingFile file_;
  McapWriter mcap_;
  McapChunk chunk_;  ///< of the tick
  std::optional<TickMessages> messages_;
  std::map<std::string, std::uint16_t> schemas_;      ///< by type
  std::map<std::string, std::uint16_t> channels_of_;  ///< by topic, of all that ever were
  std::vector<std::uint16_t> channels_;               ///< per topic
  std::int64_t time_ = 0;                             ///< [ns] of the last tick
  std::vector<bool> wanted_;                          ///< per topic, of ticks; empty: all
  bool finished_ = false;
  std::optional<ChunkWriter> writer_;  ///< none: `flush` writes
};

}  // namespace sf::record
