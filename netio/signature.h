#pragma once
// Signatures of packets: a counter and a truncated HMAC in the trailer, modelled on the message signing of MAVLink 2.
// docs/packets.md specifies the bytes.
//
//   PacketSigner signer(key);
//   signer.sign(packet);                                             // an encoded packet
//   SignatureChecker checker(key);
//   if (checker.check(bytes) == PacketStatus::accepted) ...          // the first time; then it is `replayed`
//
// Each object is single-threaded.

#include <array>
#include <cstdint>
#include <span>

#include "base/bytes.h"
#include "netio/packet_status.h"

namespace sf::netio {

inline constexpr std::size_t kKeyBytes = 32;
inline constexpr std::size_t kSignatureBytes = 24;  ///< [byte] u64 counter, and 16 bytes of HMAC
using SigningKey = std::array<std::uint8_t, kKeyBytes>;
using TruncatedHmac = std::array<std::uint8_t, 16>;

using Sha256 = std::array<std::uint8_t, 32>;

/// Returns SHA-256 (FIPS 180-4).
Sha256 sha256(std::span<const std::uint8_t> bytes);

/// Returns the first 16 bytes of HMAC-SHA-256 (RFC 2104; truncated by its section 5). @param key of any length
TruncatedHmac hmac_sha256(std::span<const std::uint8_t> key, std::span<const std::uint8_t> bytes);

/// Returns the time since 1970 [us]. Senders start their counter with it, so the counter of a restarted sender
/// continues to increase.
std::uint64_t unix_microseconds();

/// Signs an encoded packet whose last kSignatureBytes are free. Writes the signature there, and its size into the
/// header.
void write_signature(std::span<std::uint8_t> packet, const SigningKey& key, std::uint64_t counter);
/// Signs a packet without a trailer, which grows by kSignatureBytes.
void sign(base::Bytes& packet, const SigningKey& key, std::uint64_t counter);

/// Window of received counters (RFC 4303, section 3.4.3). Accepts each counter once, in any order within the newest
/// kSize.
class CounterWindow {
 public:
  static constexpr std::uint64_t kSize = 64;
  /// Records the counter of a valid signature. @return false if it was received before, or is kSize or more behind the
  /// newest
  bool admit(std::uint64_t counter);
  std::uint64_t newest() const { return newest_; }

 private:
  std::uint64_t newest_ = 0;
  std::uint64_t seen_ = 0;  ///< bit k: counter newest_ - k was received
};

/// A key with the counter of its next packet.
class PacketSigner {
 public:
  explicit PacketSigner(const SigningKey& key, std::uint64_t first = unix_microseconds()) : key_(key), next_(first) {}
  const SigningKey& key() const { return key_; }
  /// Reserves `count` counters. @return the first of them
  std::uint64_t take(std::uint64_t count = 1) { return (next_ += count) - count; }
  void sign(base::Bytes& packet) { netio::sign(packet, key_, take()); }

 private:
  SigningKey key_;
  std::uint64_t next_;
};

/// Returns whether the packet states that it ends with a signature. Checks neither the signer nor the signature.
bool has_signature(std::span<const std::uint8_t> packet);

/// A key with the counters received under it.
class SignatureChecker {
 public:
  explicit SignatureChecker(const SigningKey& key) : key_(key) {}
  /// Checks a packet that `decode` accepts. @return accepted, not_signed, wrong_signature or replayed
  PacketStatus check(std::span<const std::uint8_t> packet);
  /// Checks the signature but not the counter, so a packet may arrive twice. @return accepted, not_signed or
  /// wrong_signature
  PacketStatus verify(std::span<const std::uint8_t> packet) const;
  /// Returns how far the counter of the last checked packet was behind the newest one. Senders count microseconds.
  std::uint64_t lag() const { return lag_; }

 private:
  SigningKey key_;
  CounterWindow window_;
  std::uint64_t lag_ = 0;
};

}  // namespace sf::netio
