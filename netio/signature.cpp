#include "netio/signature.h"

#include <sodium.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "base/elapsed.h"
#include "base/error.h"
#include "netio/packets.h"

namespace sf::netio {

namespace {

constexpr std::uint16_t kTrailer = kSignatureBytes;

}  // namespace

Sha256 sha256(std::span<const std::uint8_t> bytes) {
  Sha256 hash{};
  crypto_hash_sha256(hash.data(), bytes.data(), bytes.size());
  return hash;
}

TruncatedHmac hmac_sha256(std::span<const std::uint8_t> key, std::span<const std::uint8_t> bytes) {
  static const bool ready = sodium_init() >= 0;
  SF_CHECK(ready, "libsodium does not start");
  crypto_auth_hmacsha256_state state;
  std::array<std::uint8_t, crypto_auth_hmacsha256_BYTES> whole{};
  crypto_auth_hmacsha256_init(&state, key.data(), key.size());
  crypto_auth_hmacsha256_update(&state, bytes.data(), bytes.size());
  crypto_auth_hmacsha256_final(&state, whole.data());
  TruncatedHmac truncated;
  std::memcpy(truncated.data(), whole.data(), truncated.size());
  return truncated;
}

std::uint64_t unix_microseconds() { return static_cast<std::uint64_t>(base::unix_time() / 1000); }

void write_signature(std::span<std::uint8_t> packet, const SigningKey& key, std::uint64_t counter) {
  SF_CHECK(packet.size() >= kHeaderBytes + kSignatureBytes, std::to_string(packet.size()) + " bytes to sign");
  std::memcpy(packet.data() + kTrailerAt, &kTrailer, sizeof kTrailer);
  std::memcpy(packet.data() + packet.size() - kSignatureBytes, &counter, sizeof counter);
  const std::size_t covered = packet.size() - sizeof(TruncatedHmac);
  const TruncatedHmac hmac = hmac_sha256(key, packet.first(covered));
  std::memcpy(packet.data() + covered, hmac.data(), hmac.size());
}

void sign(base::Bytes& packet, const SigningKey& key, std::uint64_t counter) {
  packet.resize(packet.size() + kSignatureBytes);
  write_signature(packet, key, counter);
}

bool CounterWindow::admit(std::uint64_t counter) {
  if (counter > newest_) {
    const std::uint64_t ahead = counter - newest_;
    seen_ = (ahead < kSize ? seen_ << ahead : 0) | 1;
    newest_ = counter;
    return true;
  }
  const std::uint64_t behind = newest_ - counter;
  if (behind >= kSize || (seen_ >> behind & 1) != 0) return false;
  seen_ |= std::uint64_t{1} << behind;
  return true;
}

bool has_signature(std::span<const std::uint8_t> packet) {
  std::uint16_t trailer = 0;
  if (packet.size() < kHeaderBytes + kSignatureBytes) return false;
  std::memcpy(&trailer, packet.data() + kTrailerAt, sizeof trailer);
  return trailer == kTrailer;
}

PacketStatus SignatureChecker::verify(std::span<const std::uint8_t> packet) const {
  if (!has_signature(packet)) return PacketStatus::not_signed;
  const std::size_t covered = packet.size() - sizeof(TruncatedHmac);
  const TruncatedHmac expected = hmac_sha256(key_, packet.first(covered));
  if (sodium_memcmp(expected.data(), packet.data() + covered, expected.size()) != 0)
    return PacketStatus::wrong_signature;
  return PacketStatus::accepted;
}

PacketStatus SignatureChecker::check(std::span<const std::uint8_t> packet) {
  const PacketStatus status = verify(packet);
  if (status != PacketStatus::accepted) return status;
  std::uint64_t counter = 0;
  std::memcpy(&counter, packet.data() + packet.size() - kSignatureBytes, sizeof counter);
  lag_ = window_.newest() - std::min(counter, window_.newest());
  return window_.admit(counter) ? PacketStatus::accepted : PacketStatus::replayed;
}

}  // namespace sf::netio
