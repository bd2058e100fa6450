#pragma once
// Plays a recording back as ticks, for viewers.

#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "base/tick_record.h"
#include "base/tilted_pose.h"
#include "record/recording.h"

namespace sf::scenarios {

/// Not thread-safe. The recording must outlive it.
class Replay {
 public:
  /// @param info of the same world as read by this program; readings of sensors that differ are skipped
  /// @throws base::InputError for a recording without ticks or with other movers
  Replay(const record::Recording& recording, const record::RunInfo& info);

  std::size_t ticks() const { return recording_.states.front().size(); }
  std::int64_t start() const { return time_of(0); }          ///< [ns]
  std::int64_t end() const { return time_of(ticks() - 1); }  ///< [ns]
  std::int64_t time_of(std::size_t tick) const { return recording_.states.front()[tick].time; }
  /// Returns the last tick at or before `time` [ns]; the first tick for earlier times.
  std::size_t tick_at(std::int64_t time) const;
  /// Returns a tick with readings.
  /// @param shown last tick shown: the result contains readings delivered since then; if nullopt or later than
  /// `number`, it contains every sensor's newest reading. Their poses are interpolated between ticks. Spans are valid
  /// until the next call.
  base::TickRecord tick(std::size_t number, std::optional<std::size_t> shown);
  /// Returns the number of recorded readings that cannot be shown.
  std::size_t left_out() const { return left_out_; }

 private:
  void add_states(std::size_t number);
  void add_reading(std::size_t row);
  base::TiltedPose pose_at(std::uint32_t mover, std::int64_t time) const;

  const record::Recording& recording_;
  std::size_t lights_;             ///< number in the world
  std::vector<std::size_t> rows_;  ///< of shown readings, in order of delivery
  std::map<std::tuple<std::uint32_t, std::uint8_t, std::uint32_t>, std::vector<std::size_t>> sensors_;  ///< by sensor
  std::size_t left_out_ = 0;
  std::vector<base::Report> reports_;
  std::vector<base::Twist> commands_;
  std::vector<std::uint8_t> contacts_;
  std::vector<base::ReadingBlock> readings_;
};

}  // namespace sf::scenarios
