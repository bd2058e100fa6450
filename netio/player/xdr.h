#pragma once
// External Data Representation (RFC 4506) as used by Player: big-endian, in units of four bytes. A variable array has
// its count twice, as a member and as the array's length. A read beyond the end makes the reader invalid and returns
// zeros.

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "base/bytes.h"

namespace sf::netio::player {

/// Appends to a caller's buffer.
class XdrWriter {
 public:
  explicit XdrWriter(base::Bytes& out) : out_(out) {}

  /// Smaller integers also take four bytes.
  void put(std::uint32_t value) { put_big(value, 4); }
  void put(std::int32_t value) { put(static_cast<std::uint32_t>(value)); }
  void put(float value) { put_big(std::bit_cast<std::uint32_t>(value), 4); }
  void put(double value) { put_big(std::bit_cast<std::uint64_t>(value), 8); }
  template <class T>
  void put_all(std::initializer_list<T> values) {
    for (const T value : values) put(value);
  }
  /// Writes the count of a variable array, whose elements follow.
  void put_count(std::size_t count) {
    put(static_cast<std::uint32_t>(count));
    put(static_cast<std::uint32_t>(count));
  }
  /// Writes a variable array of bytes.
  void put_opaque(std::span<const std::uint8_t> bytes) {
    put_count(bytes.size());
    put_padded(bytes);
  }
  /// Writes the bytes without their count.
  void put_padded(std::span<const std::uint8_t> bytes) {
    put_bytes(bytes);
    out_.resize(out_.size() + (4 - bytes.size() % 4) % 4);
  }
  /// Writes bytes that are already in XDR.
  void put_bytes(std::span<const std::uint8_t> bytes) { out_.insert(out_.end(), bytes.begin(), bytes.end()); }
  /// Writes characters with their terminator.
  void put_text(const std::string& text) {
    put_opaque({reinterpret_cast<const std::uint8_t*>(text.c_str()), text.size() + 1});
  }

 private:
  void put_big(std::uint64_t value, int bytes) {
    for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) out_.push_back(static_cast<std::uint8_t>(value >> shift));
  }

  base::Bytes& out_;
};

/// Reads a caller's bytes, which outlive the reader.
class XdrReader {
 public:
  explicit XdrReader(std::span<const std::uint8_t> in) : in_(in) {}

  std::uint32_t get() { return static_cast<std::uint32_t>(get_big(4)); }
  double get_double() { return std::bit_cast<double>(get_big(8)); }
  float get_float() { return std::bit_cast<float>(get()); }
  /// Returns the count of a variable array, of which each element takes at least `bytes` of the rest.
  std::size_t get_count(std::size_t bytes) {
    const std::size_t count = get();
    good_ = good_ && get() == count && count <= (in_.size() - at_) / bytes;
    return good_ ? count : 0;
  }
  /// Returns a variable array of bytes.
  std::span<const std::uint8_t> get_opaque() {
    const std::size_t count = get_count(1), padded = (count + 3) / 4 * 4;
    good_ = good_ && padded <= in_.size() - at_;
    if (!good_) return {};
    return in_.subspan(std::exchange(at_, at_ + padded), count);
  }
  /// Returns the text without its terminator.
  /// @param most [byte] longer texts, and counts that differ, make the reader invalid
  std::string get_text(std::size_t most) {
    const std::span<const std::uint8_t> bytes = get_opaque();
    good_ = good_ && bytes.size() <= most;
    if (!good_) return {};
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    return std::string(text.substr(0, text.find('\0')));
  }
  /// Returns false after the first read beyond the end, and after an invalid count.
  bool good() const { return good_; }
  /// Returns whether exactly all bytes were read.
  bool done() const { return good_ && at_ == in_.size(); }

 private:
  std::uint64_t get_big(std::size_t bytes) {
    good_ = good_ && bytes <= in_.size() - at_;
    std::uint64_t value = 0;
    if (!good_) return value;
    for (std::size_t i = 0; i < bytes; ++i) value = value << 8 | in_[at_ + i];
    at_ += bytes;
    return value;
  }

  std::span<const std::uint8_t> in_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace sf::netio::player
