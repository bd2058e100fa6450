#include "base/hash.h"

#include <xxhash.h>

#include <cstdio>
#include <new>

namespace sf::base {

std::uint64_t hash_bytes(const void* data, std::size_t size, std::uint64_t seed) {
  return XXH3_64bits_withSeed(data, size, seed);
}

struct StreamingHash::State {
  XXH3_state_t* xxh3 = XXH3_createState();
  ~State() { XXH3_freeState(xxh3); }
};

StreamingHash::StreamingHash() : state_(std::make_unique<State>()) {
  if (state_->xxh3 == nullptr) throw std::bad_alloc();
  XXH3_64bits_reset(state_->xxh3);
}
StreamingHash::~StreamingHash() = default;

void StreamingHash::add(const void* data, std::size_t size) { XXH3_64bits_update(state_->xxh3, data, size); }
std::uint64_t StreamingHash::value() const { return XXH3_64bits_digest(state_->xxh3); }

std::string hash_hex(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace sf::base
