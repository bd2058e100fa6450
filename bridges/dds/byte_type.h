#pragma once
// DDS types whose samples are bytes: a complete encoded message with its four bytes of encapsulation.

#include <cstddef>
#include <cstdint>
#include <span>

struct ddsi_serdata;
struct ddsi_sertype;

namespace sf::bridges {

/// Returns a new type without a key. The caller owns it until a topic is created from it.
ddsi_sertype* new_byte_type(const char* name);

/// Returns a sample of one message.
/// @return owned by the caller, and then by the call that writes it
ddsi_serdata* new_byte_sample(const ddsi_sertype* type, std::span<const std::uint8_t> message);

/// Valid as long as the sample.
std::span<const std::uint8_t> bytes_of(const ddsi_serdata* sample);

}  // namespace sf::bridges
