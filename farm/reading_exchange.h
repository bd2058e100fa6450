#pragma once
// Readings of a shared fleet that one process measures and another delivers.

#include <vector>

#include "base/bytes.h"
#include "base/reading.h"

namespace sf::farm {

class ReadingExchange {
 public:
  virtual ~ReadingExchange() = default;
  /// All processes call this at the same times, with all types except the derived ones, before latency is applied.
  /// @param readings in: measured here; out: of the robots whose readings are delivered here, in order of type, mover
  /// and sensor. Their spans are valid until the next call.
  virtual void exchange(std::vector<base::ReadingBlock>& readings) = 0;
};

/// Writes a reading bit by bit, without the quality of its state. ReadingFromBytes reads it.
void write_reading(const base::ReadingBlock& reading, base::ByteWriter& out);
/// Owns the memory that the spans of its block view.
struct ReadingFromBytes {
  base::ReadingBlock block;
  std::vector<double> values;
  std::vector<std::uint32_t> hits;
  std::vector<base::QualityFlag> quality;
  /// Reuses memory. @pre `in` is at bytes written by `write_reading`
  void read(base::ByteReader& in);
};

}  // namespace sf::farm
