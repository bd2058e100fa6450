#pragma once
// Little-endian readers and writers for packets, recordings and snapshots. They throw no exceptions: a read beyond the
// end returns zeros and marks the reader as bad.

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sf::base {

static_assert(std::endian::native == std::endian::little, "the farm's byte formats assume a little-endian host");

using Bytes = std::vector<std::uint8_t>;

/// Appends to a caller's buffer, which keeps its capacity between uses.
class ByteWriter {
 public:
  explicit ByteWriter(Bytes& out) : out_(out) {}

  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) {
    const std::size_t at = out_.size();
    out_.resize(at + sizeof(T));
    std::memcpy(out_.data() + at, &value, sizeof(T));
  }
  void put_bytes(const void* data, std::size_t size) {
    const std::size_t at = out_.size();
    out_.resize(at + size);
    if (size > 0) std::memcpy(out_.data() + at, data, size);
  }
  /// Writes the length as u32, then the characters without a terminator.
  void put_string(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    put_bytes(text.data(), text.size());
  }
  std::size_t size() const { return out_.size(); }
  Bytes& bytes() { return out_; }

 private:
  Bytes& out_;
};

/// Reads a caller's bytes, which must outlive the reader.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> in) : in_(in) {}

  template <class T>
  requires std::is_arithmetic_v<T> T get() {
    T value{};
    if (!take(sizeof(T))) return value;
    std::memcpy(&value, in_.data() + at_ - sizeof(T), sizeof(T));
    return value;
  }
  /// Returns the next `size` bytes. If fewer are left, returns an empty span and marks the reader as bad.
  std::span<const std::uint8_t> get_bytes(std::size_t size) {
    if (!take(size)) return {};
    return in_.subspan(at_ - size, size);
  }
  /// Copies the next `size` bytes. If fewer are left, copies nothing and marks the reader as bad.
  void get_into(void* out, std::size_t size) {
    if (take(size) && size > 0) std::memcpy(out, in_.data() + at_ - size, size);
  }
  std::string get_string() {
    const auto text = get_bytes(get<std::uint32_t>());
    return {reinterpret_cast<const char*>(text.data()), text.size()};
  }
  /// Returns false after the first read beyond the end.
  bool good() const { return good_; }
  std::size_t left() const { return in_.size() - at_; }
  std::size_t position() const { return at_; }

 private:
  bool take(std::size_t size) {
    if (!good_ || size > left()) {
      good_ = false;
      return false;
    }
    at_ += size;
    return true;
  }

  std::span<const std::uint8_t> in_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace sf::base
