#pragma once
// A recording as ticks again, for viewers.

#include <cstdint>
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "base/tick_record.h"
#include "record/recording.h"

namespace sf::scenarios {

/// One thread. The recording outlives it.
class Replay {
 public:
  /// @param info of the same world as this program reads it: readings of sensors that it has otherwise are left out
  /// @throws base::InputError for a recording without ticks, or of other movers
  Replay(const record::Recording& recording, const record::RunInfo& info);

  std::size_t ticks() const { return recording_.states.front().size(); }
  std::int64_t start() const { return time_of(0); }          ///< [ns]
  std::int64_t end() const { return time_of(ticks() - 1); }  ///< [ns]
  std::int64_t time_of(std::size_t tick) const { return recording_.states.front()[tick].time; }
  /// The last tick at or before `time` [ns]; the first one for earlier times.
  std::size_t tick_at(std::int64_t time) const;
  /// @param shown tick that was shown last: readings delivered since then are in the result; nullopt, or a later tick:
  /// every sensor's newest reading is. Their poses are interpolated between ticks. Spans live until the next call.
  base::TickRecord tick(std::size_t number, std::optional<std::size_t> shown);
  /// Recorded readings that cannot be shown.
  std::size_t left_out() const { return left_out_; }

 private:
  void add_states(std::size_t number);
  void add_reading(std::size_t row);
  base::Pose pose_at(std::uint32_t mover, std::int64_t time) const;

  const record::Recording& recording_;
  std::size_t lights_;             ///< of the world
  std::vector<std::size_t> rows_;  ///< of readings that are shown, by delivery
  std::map<std::tuple<std::uint32_t, std::uint8_t, std::uint32_t>, std::vector<std::size_t>> sensors_;  ///< likewise
  std::size_t left_out_ = 0;
  std::vector<base::Report> reports_;
  std::vector<base::Twist> commands_;
  std::vector<std::uint8_t> contacts_;
  std::vector<base::ReadingBlock> readings_;
};

}  // namespace sf::scenarios
