#pragma once
// Readings of a shared fleet that one process measures and another delivers.

#include <vector>

#include "base/bytes.h"
#include "base/reading.h"

namespace sf::farm {

class ReadingExchange {
 public:
  virtual ~ReadingExchange() = default;
  /// Called by all processes at the same times, with all types but the derived ones, before latency.
  /// @param readings in: measured here; out: of the robots whose readings are delivered here, in order of type, mover
  /// and sensor. Their spans live until the next call.
  virtual void exchange(std::vector<base::ReadingBlock>& readings) = 0;
};

/// A reading without the quality of its state, bit by bit, and back.
void write_reading(const base::ReadingBlock& reading, base::ByteWriter& out);
/// Owns what the spans of its block view.
struct ReadingFromBytes {
  base::ReadingBlock block;
  std::vector<double> values;
  std::vector<std::uint32_t> hits;
  std::vector<base::QualityFlag> quality;
  /// Memory is reused. @pre `in` is at what `write_reading` wrote
  void read(base::ByteReader& in);
};

}  // namespace sf::farm
