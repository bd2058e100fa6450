#pragma once
// Bits in and out, most significant first, as the unaligned packed encoding rules have them (UPER, ITU-T X.691), with
// the encodings that all types share: lengths, open types, small numbers.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "base/bytes.h"

namespace sf::v2x {

/// Reads a caller's bytes, which must outlive the reader. No exceptions: after the first fault all reads return zeros.
class BitReader {
 public:
  explicit BitReader(std::span<const std::uint8_t> in) : in_(in) {}

  /// The next `count` bits, at most 64.
  std::uint64_t bits(unsigned count);
  bool bit() { return bits(1) != 0; }
  /// Octets behind a length, which may be fragmented: an open type or an OCTET STRING without bounds (X.691, 11.9).
  base::Bytes octets();
  /// A normally small number (X.691, 11.6) below 64; a larger one is a fault.
  std::uint8_t small_number();

  /// The first fault counts.
  void fail(std::string reason);
  /// Puts a component's name before the place of the fault: "states", "[3]", "signalGroup".
  void fail_within(std::string_view component);

  bool good() const { return reason_.empty(); }
  /// "states[3].signalGroup: reason"; empty without a fault.
  std::string fault() const { return place_.empty() ? reason_ : place_ + ": " + reason_; }
  std::size_t position() const { return at_; }               ///< [bit]
  std::size_t left() const { return in_.size() * 8 - at_; }  ///< [bit]

 private:
  std::span<const std::uint8_t> in_;
  std::size_t at_ = 0;
  std::string place_, reason_;
};

/// Appends to a caller's buffer, which starts at a byte's border.
class BitWriter {
 public:
  explicit BitWriter(base::Bytes& out) : out_(out) {}

  /// The lowest `count` bits of `value`, at most 64.
  void put(std::uint64_t value, unsigned count);
  void put_octets(std::span<const std::uint8_t> octets);
  /// @pre number < 64
  void put_small_number(std::uint64_t number);

 private:
  base::Bytes& out_;
  unsigned free_ = 0;  ///< bits of the last byte that are not used yet
};

}  // namespace sf::v2x
