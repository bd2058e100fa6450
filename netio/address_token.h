#pragma once
// Proof of an address: it sends back the token that was sent there. Nothing is kept per address.

#include <array>
#include <cstdint>
#include <span>

#include "netio/endpoint.h"

namespace sf::netio {

using SipHashKey = std::array<std::uint64_t, 2>;

/// SipHash-2-4 (Aumasson and Bernstein, 2012): without the key its values cannot be told.
std::uint64_t siphash(const SipHashKey& key, std::span<const std::uint8_t> bytes);

/// From the kernel's random numbers.
SipHashKey random_key();
std::uint32_t random_session();  ///< never 0

/// The token of each address and port.
class AddressTokens {
 public:
  explicit AddressTokens(const SipHashKey& key = random_key()) : key_(key) {}
  std::uint32_t of(const Endpoint& endpoint) const;  ///< never 0

 private:
  SipHashKey key_;
};

}  // namespace sf::netio
