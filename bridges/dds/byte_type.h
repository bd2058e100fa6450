#pragma once
// Types of DDS whose samples are bytes: a whole message, already encoded, with its four bytes of encapsulation.

#include <cstddef>
#include <cstdint>
#include <span>

struct ddsi_serdata;
struct ddsi_sertype;

namespace sf::bridges {

/// A new type without a key. Its owner is the caller, and then the topic made of it.
ddsi_sertype* new_byte_type(const char* name);

/// A sample of one message. @return owned by the caller, and then by the call that writes it
ddsi_serdata* new_byte_sample(const ddsi_sertype* type, std::span<const std::uint8_t> message);

/// Valid as long as the sample.
std::span<const std::uint8_t> bytes_of(const ddsi_serdata* sample);

}  // namespace sf::bridges
