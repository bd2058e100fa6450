#pragma once
// ROS 2 messages as bytes: CDR in its first version (OMG "DDS Interoperability Wire Protocol" 2.2, section 10; XCDR1),
// little endian. Four bytes of encapsulation (00 01 00 00) precede the fields. Every number is aligned to its own size,
// counted from the byte after the encapsulation.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/bytes.h"

namespace sf::record {

/// Appends one message to a caller's buffer.
class CdrWriter {
 public:
  explicit CdrWriter(base::Bytes& out) : out_(out), bytes_(out) {
    constexpr std::array<std::uint8_t, 4> kLittleEndian = {0, 1, 0, 0};
    bytes_.put_bytes(kLittleEndian.data(), kLittleEndian.size());
    origin_ = out.size();
  }

  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) {
    align(sizeof(T));
    bytes_.put(value);
  }
  void put(bool value) { bytes_.put(static_cast<std::uint8_t>(value ? 1 : 0)); }
  /// Appends the u32 length including the terminator, the characters, and the terminator.
  void put(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    bytes_.put_bytes(text.data(), text.size());
    bytes_.put(std::uint8_t{0});
  }
  void put(const char* text) { put(std::string_view(text)); }
  /// Appends a number within a sequence of bytes, where it is not aligned.
  template <class T>
  void put_packed(T value) {
    bytes_.put(value);
  }
  /// Appends the number of elements that precedes a sequence.
  void put_count(std::size_t count) { put(static_cast<std::uint32_t>(count)); }

 private:
  void align(std::size_t size) {
    const std::size_t past = (out_.size() - origin_) % size;
    if (past != 0) out_.resize(out_.size() + size - past, 0);
  }

  base::Bytes& out_;
  base::ByteWriter bytes_;
  std::size_t origin_ = 0;
};

/// Reads one message from a caller's bytes. A read past the end, or a malformed field, sets the state to bad and
/// returns zeros.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::uint8_t> in) : bytes_(in) {
    const auto head = bytes_.get_bytes(4);
    good_ = head.size() == 4 && head[0] == 0 && head[1] == 1;
  }

  template <class T>
  requires std::is_arithmetic_v<T> T get() {
    if constexpr (std::is_same_v<T, bool>) {
      return get<std::uint8_t>() != 0;
    } else {
      align(sizeof(T));
      return good() ? bytes_.get<T>() : T{};
    }
  }
  std::string get_string() {
    const auto size = get<std::uint32_t>();
    const auto text = good() ? bytes_.get_bytes(size) : std::span<const std::uint8_t>{};
    if (text.empty() || text.back() != 0) {
      good_ = false;
      return {};
    }
    return {reinterpret_cast<const char*>(text.data()), text.size() - 1};
  }
  /// Reads the length of a sequence whose elements take at least `least` bytes each. Sets the state to bad and returns
  /// 0 if the remaining bytes cannot hold them.
  std::uint32_t get_count(std::size_t least) {
    const auto count = get<std::uint32_t>();
    if (good() && count <= bytes_.left() / least) return count;
    good_ = false;
    return 0;
  }
  bool good() const { return good_ && bytes_.good(); }
  std::size_t left() const { return bytes_.left(); }  ///< [byte]

 private:
  void align(std::size_t size) {
    if (!good()) return;
    const std::size_t past = (bytes_.position() - 4) % size;
    if (past != 0) bytes_.get_bytes(size - past);
  }

  base::ByteReader bytes_;
  bool good_ = true;
};

}  // namespace sf::record
