#pragma once
// Bit streams, most significant bit first, as in the unaligned packed encoding rules (UPER, ITU-T X.691), with the
// encodings shared by all types: lengths, open types, small numbers.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/bytes.h"

namespace sf::v2x {

/// Reads a caller's bytes, which must outlive the reader. Does not throw: after the first fault all reads return zeros.
class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> in) : in_(in) {}

  /// Returns the next `count` bits, at most 64.
  std::uint64_t bits(unsigned count);
  bool bit() { return bits(1) != 0; }
  /// Reads octets after a length, which may be fragmented: an open type or an unbounded OCTET STRING (X.691, 11.9).
  base::Bytes octets();
  /// Reads a normally small number (X.691, 11.6) below 64; a larger number is a fault.
  std::uint8_t small_number();

  /// Records a fault. Only the first one is kept.
  void fail(std::string reason);
  /// Prepends a component's name to the location of the fault: "states", "[3]", "signalGroup".
  void fail_within(std::string_view component);

  bool good() const { return reason_.empty(); }
  /// Returns "states[3].signalGroup: reason"; empty without a fault.
  std::string fault() const { return place_.empty() ? reason_ : place_ + ": " + reason_; }
  std::size_t position() const { return at_; }               ///< [bit]
  std::size_t left() const { return in_.size() * 8 - at_; }  ///< [bit]

 private:
  std::span<const std::uint8_t> in_;
  std::size_t at_ = 0;
  std::string place_, reason_;
};

/// Appends to a caller's buffer, starting at a byte boundary.
class BitWriter {
 public:
  explicit BitWriter(base::Bytes& out) : out_(out) {}

  /// Writes the lowest `count` bits of `value`, at most 64.
  void put(std::uint64_t value, unsigned count);
  void put_octets(std::span<const std::uint8_t> octets);
  /// @pre number < 64
  void put_small_number(std::uint64_t number);

 private:
  base::Bytes& out_;
  unsigned free_ = 0;  ///< unused bits of the last byte
};

}  // namespace sf::v2x
