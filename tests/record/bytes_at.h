#pragma once
// Reads fields of encoded messages at known offsets.

#include <cstring>
#include <stdexcept>
#include <string>

#include "base/bytes.h"

namespace sf::record::test {

/// Reads a field at an offset counted by hand, including the encapsulation. Independent of the code under test.
template <class T>
T at(const base::Bytes& bytes, std::size_t offset) {
  T value{};
  if (offset + sizeof(T) > bytes.size()) throw std::out_of_range("offset " + std::to_string(offset));
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

}  // namespace sf::record::test
