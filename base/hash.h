#pragma once
// 64-bit content hashes (XXH3) of worlds, runs and readings. Not cryptographic.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

namespace sf::base {

/// Returns the hash of `size` bytes, chained from `seed`: hash(b, hash(a)) is the hash of the sequence a, b.
std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t seed = 0);

/// Computes `hash_bytes` of data that arrives in parts.
class StreamingHash {
 public:
  StreamingHash();
  ~StreamingHash();
  void add(const void* data, std::size_t size);
  std::uint64_t value() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns 16 lower-case hexadecimal digits.
std::string hash_hex(std::uint64_t hash);

}  // namespace sf::base
