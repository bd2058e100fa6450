#include "netio/address_token.h"

#include <sys/random.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/error.h"

namespace sf::netio {

namespace {

struct Sip {
  std::uint64_t a, b, c, d;

  void round() {
    a += b, b = std::rotl(b, 13) ^ a, a = std::rotl(a, 32);
    c += d, d = std::rotl(d, 16) ^ c;
    a += d, d = std::rotl(d, 21) ^ a;
    c += b, b = std::rotl(b, 17) ^ c, c = std::rotl(c, 32);
  }
  void take(std::uint64_t word) {
    d ^= word;
    round();
    round();
    a ^= word;
  }
};

template <class T>
T random_bits() {
  T value{};
  SF_CHECK(getrandom(&value, sizeof value, 0) == static_cast<ssize_t>(sizeof value), "no random numbers");
  return value;
}

}  // namespace

std::uint64_t siphash(const SipHashKey& key, std::span<const std::uint8_t> bytes) {
  Sip sip{key[0] ^ 0x736f6d6570736575u, key[1] ^ 0x646f72616e646f6du, key[0] ^ 0x6c7967656e657261u,
          key[1] ^ 0x7465646279746573u};
  std::size_t at = 0;
  for (; at + 8 <= bytes.size(); at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, 8);
    sip.take(word);
  }
  std::uint64_t last = std::uint64_t{bytes.size()} << 56;
  for (std::size_t i = at; i < bytes.size(); ++i) last |= std::uint64_t{bytes[i]} << (8 * (i - at));
  sip.take(last);
  sip.c ^= 0xFF;
  for (int i = 0; i < 4; ++i) sip.round();
  return sip.a ^ sip.b ^ sip.c ^ sip.d;
}

SipHashKey random_key() { return random_bits<SipHashKey>(); }

std::uint32_t random_session() { return std::max(random_bits<std::uint32_t>(), std::uint32_t{1}); }

std::uint32_t AddressTokens::of(const Endpoint& endpoint) const {
  std::array<std::uint8_t, 6> bytes{};
  std::memcpy(bytes.data(), &endpoint.address, 4);
  std::memcpy(bytes.data() + 4, &endpoint.port, 2);
  return std::max(static_cast<std::uint32_t>(siphash(key_, bytes)), std::uint32_t{1});
}

}  // namespace sf::netio
