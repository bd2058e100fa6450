#pragma once
// Checks that a stream's sequence numbers are plausible (RFC 3550, appendix A.1), so that a forged number does not make
// all later genuine packets stale.

#include <cstdint>
#include <optional>

#include "netio/sender_bindings.h"

namespace sf::netio {

/// One stream of one sender. Single-threaded.
class SequenceGuard {
 public:
  /// @param max_dropout a larger gap is accepted only if the next sequence follows it
  explicit SequenceGuard(std::uint32_t max_dropout) : max_dropout_(max_dropout) {}

  /// Checks the next sequence. @return true if it is implausibly far ahead and does not follow another such jump
  bool rejects(std::uint32_t sequence) {
    const bool ahead = highest_ && newer(sequence, *highest_);
    const bool far = ahead && sequence - *highest_ > max_dropout_ && expected_ != sequence;
    expected_ = far ? std::optional(sequence + 1) : std::nullopt;
    if (!far && (ahead || !highest_)) highest_ = sequence;
    return far;
  }

 private:
  std::uint32_t max_dropout_;
  std::optional<std::uint32_t> highest_;
  std::optional<std::uint32_t> expected_;  ///< sequence that would confirm the last jump
};

}  // namespace sf::netio
