#pragma once
// Proof of address ownership by tokens, without state per address.

#include <array>
#include <cstdint>
#include <span>

#include "netio/endpoint.h"

namespace sf::netio {

using SipHashKey = std::array<std::uint64_t, 2>;

/// Returns SipHash-2-4 (Aumasson and Bernstein, 2012). Its values cannot be predicted without the key.
std::uint64_t siphash(const SipHashKey& key, std::span<const std::uint8_t> bytes);

/// Draws a key from the kernel's random number generator.
SipHashKey random_key();
std::uint32_t random_session();  ///< never 0

/// Computes the token of an address and port. A sender proves its address by returning the token sent there.
class AddressTokens {
 public:
  explicit AddressTokens(const SipHashKey& key = random_key()) : key_(key) {}
  std::uint32_t of(const Endpoint& endpoint) const;  ///< never 0

 private:
  SipHashKey key_;
};

}  // namespace sf::netio
