#pragma once
// Records a run in DIR/run.mcap while it runs:
//
//   Recorder recorder(dir, info);           // the file has its final name and contains world and run info
//   for (...) recorder.write(tick_record);  // one chunk
//   recorder.finish();                      // summary and indexes
//
// A process killed at any time leaves a file with all ticks whose `write` returned, except the last
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
#include "record/topics.h"

namespace sf::record {

/// The part of a recording that one process writes if several processes share a fleet (scenarios/recording_merge.h),
/// and its format.
struct RecordingPart {
  unsigned part = 0;   ///< below `parts`; part 0 has everything except the readings of other parts, which have their
                       ///< own and /clock
  unsigned parts = 1;  ///< 1: DIR/run.mcap; otherwise DIR/rank-0.mcap and so on
  Compression compression = Compression::zstd;

  std::string file() const { return parts == 1 ? "run.mcap" : "rank-" + std::to_string(part) + ".mcap"; }
};

/// Name of the metadata with the number of the part and the count of parts, in recordings with several parts.
inline constexpr const char* kPartMetadata = "sensorfarm.part";
/// Name of the metadata of a robot that joined: name, row of its original, pose. In the order of joining.
inline constexpr const char* kJoinedMetadata = "sensorfarm.joined";
/// Returns the robot described by such metadata; nullopt if it is malformed.
std::optional<JoinedMover> joined_mover_of(const TextPairs& pairs);

/// Single-threaded. Replaces an existing recording in the directory in one step, once the new one contains its world.
class Recorder : public base::Sink {
 public:
  /// Creates the directory. A rate of odometry of 0 omits odometry. @pre `info.snapshot` is not empty; the interval and
  /// the rates of sensors are positive
  /// @throws base::InputError if the directory cannot be written, another run is being recorded there, or the fleet has
  /// more topics than a file can hold
  Recorder(const std::string& directory, RunInfo info, const RecordingPart& part = {});
  /// Calls `finish` if needed and ignores its errors; call `finish` to get them.
  ~Recorder() override;

  /// Records a tick. @pre every report's mover is a row of `info.movers`, its quality exists if `info.estimated`, every
  /// reading's sensor is one of its sensors; time is non-decreasing
  /// @throws base::InputError if this tick, or with compression one of the last three, could not be written completely
  /// (a full disk). All earlier ticks are in the file; the recorder accepts no more.
  void write(const base::TickRecord& record) override;
  /// Adds movers that joined the run, as the last rows of `info.movers`; they are recorded from the next tick on. @pre
  /// everything else equals the previous info; `info.joined` begins with the previous entries
  /// @throws base::InputError as `write`, and if the file cannot hold the topics; nothing is written in that case
  void add_movers(RunInfo info);
  /// Seals the file. Further calls, and a call after a failed `write`, do nothing. @throws base::InputError if that
  /// fails
  void finish();

  /// Returns a line for each topic name that was already taken (name_frames), for all movers so far.
  const std::vector<std::string>& taken_names() const { return taken_names_; }
  const std::string& path() const { return file_.path(); }
  std::uint64_t size() const { return file_.size(); }  ///< [byte] in the file so far

 private:
  void add(const TopicMessage& message);
  void check_topics(const TickMessages& messages) const;
  void add_channels();
  void flush();
  void start_writer();
  bool stop_writer();

  std::vector<std::string> taken_names_;  ///< set during the construction of `info_`
  RunInfo info_;
  GrowingFile file_;
  McapWriter mcap_;
  McapChunk chunk_;  ///< chunk of the current tick
  std::optional<TickMessages> messages_;
  std::map<std::string, std::uint16_t> schemas_;      ///< schema ids by type
  std::map<std::string, std::uint16_t> channels_of_;  ///< channel ids by topic, for all topics so far
  std::vector<std::uint16_t> channels_;               ///< per topic
  std::int64_t time_ = 0;                             ///< [ns] time of the last tick
  std::vector<bool> wanted_;                          ///< per topic, of ticks; empty: all
  bool finished_ = false;
  std::optional<ChunkWriter> writer_;  ///< nullopt: `flush` writes
};

}  // namespace sf::record
