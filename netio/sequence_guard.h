#pragma once
// Sequences of one stream as a receiver believes them (RFC 3550, appendix A.1): a forged one does not make all genuine
// ones after it late.

#include <cstdint>
#include <optional>

#include "netio/client_registry.h"

namespace sf::netio {

/// One stream of one sender. One thread.
class SequenceGuard {
 public:
  /// @param max_dropout a sequence that is farther ahead of the highest before it is believed when the next one follows
  explicit SequenceGuard(std::uint32_t max_dropout) : max_dropout_(max_dropout) {}

  /// Takes in the next sequence. True: it is too far ahead to be believed, and not the second in a row that is.
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
  std::optional<std::uint32_t> expected_;  ///< the sequence that would make a leap believed
};

}  // namespace sf::netio
