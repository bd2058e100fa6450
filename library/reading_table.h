#pragma once
// The newest readings of all sensors of one type as one table.

#include <cstdint>
#include <span>
#include <vector>

#include "base/reading.h"
#include "sensorfarm/simulation.h"
#include "sensors/sensor_set.h"

namespace sf::library {

/// Returns whether a sensor is read at every tick and at no other time. @param interval [s] of a tick
bool at_every_tick(const sensors::SensorSpec& row, double interval);

/// If all sensors of the type are read at every tick and at no other time, and the farm's buffer contains them row by
/// row, the table is that buffer; otherwise readings are copied.
class ReadingTable {
 public:
  /// @param interval [s] of a tick
  ReadingTable(const sensors::SensorSet::Group& group, double interval);

  /// Takes a tick's readings of this type, in order of delivery. Their memory must be valid until the next call.
  void take(std::span<const base::ReadingBlock> readings);

  /// Keeps the rows that the next `take` does not have. Scans are copied only if that one has them elsewhere, since the
  /// farm keeps a scan until its sensor's next one.
  void hold();

  /// Empties the rows of robots [first, end), which start afresh. Call it after `hold`.
  void forget(std::uint32_t first, std::uint32_t end);

  /// Continues with the rows of a table of the same type that had fewer sensors.
  void go_on(const ReadingTable& before);

  std::uint8_t type() const { return group_.type->id; }
  sensorfarm::Readings view() const { return view_; }

 private:
  std::size_t row_of(const base::ReadingBlock& reading) const;
  bool are_in_place(std::span<const base::ReadingBlock> readings) const;
  bool is_one_table(std::span<const base::ReadingBlock> readings) const;
  void point_at(std::span<const base::ReadingBlock> readings);
  void copy(std::span<const base::ReadingBlock> readings);
  void copy_rows(const sensorfarm::Readings& from);
  void note(const base::ReadingBlock& reading);
  void clear(std::size_t row);

  const sensors::SensorSet::Group& group_;
  bool has_hits_;      ///< elements are beams or pixels
  bool every_tick_;    ///< each sensor is read at every tick and at no other time
  bool held_ = false;  ///< the view of the farm's scans stays for the rows that the next `take` does not have
  sensorfarm::Readings view_;
  std::vector<double> values_;
  std::vector<std::uint32_t> hits_;
  std::vector<std::uint32_t> robots_, widths_, image_sizes_;
  std::vector<double> times_;
  std::vector<double> bounds_;
  std::vector<double> bound_without_noise_;
  std::vector<double> sigma_;
  std::vector<std::uint8_t> fresh_;
  std::vector<std::uint8_t> flags_;
  std::vector<std::uint8_t> flagged_;  ///< per row: some flag is set
};

}  // namespace sf::library
