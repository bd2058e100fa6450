#pragma once
// Decodes described values from UPER bits (ITU-T X.691, unaligned). The reader stores a fault with its location.
//
// Work is bounded by the input: every component takes at least one bit, and reading stops at a fault.

#include <fmt/format.h>

#include <bit>

#include "v2x/bit_stream.h"
#include "v2x/constraints.h"

namespace sf::v2x::uper {

/// Width [bit] of a number in [0, range].
constexpr unsigned width_of(std::uint64_t range) { return static_cast<unsigned>(std::bit_width(range)); }

template <class T>
void decode(BitReader& in, T& value, const Whole& range) {
  const std::int64_t number = range.min + static_cast<std::int64_t>(in.bits(width_of(range.max - range.min)));
  if (number > range.max) in.fail(fmt::format("{} is above {}", number, range.max));
  value = static_cast<T>(number);
}

template <class T>
void decode(BitReader& in, T& value, const Named& named) {
  const bool is_addition = named.extensible && in.bit();
  std::size_t row = is_addition ? named.names.size() + in.small_number() : in.bits(width_of(named.names.size() - 1));
  if (!is_addition && row >= named.names.size()) in.fail(fmt::format("{} is not a value of the enumeration", row));
  value = static_cast<T>(row);
}

template <class T>
void decode(BitReader& in, T& value, const BitString& bits) {
  value = static_cast<T>(in.bits(bits.size));
}

inline void decode(BitReader& in, ExtensibleBits& value, const BitString& bits) {
  const bool is_extended = in.bit();
  const std::size_t size = is_extended ? in.bits(8) : bits.size;
  if (size > 64) in.fail("a bit string of more than 64 bits, which is not supported");
  value.size = static_cast<std::uint8_t>(size);
  value.bits = in.good() ? in.bits(value.size) : 0;
}

inline void decode(BitReader& in, std::string& value, const Text& text) {
  const std::size_t size = 1 + in.bits(width_of(text.max - 1));
  if (size > text.max) in.fail(fmt::format("a text of {} characters; expected at most {}", size, text.max));
  value.clear();
  for (std::size_t i = 0; i < size && in.good(); ++i) value += static_cast<char>(in.bits(7));
}

template <class T>
void decode(BitReader& in, T& value, const Flag&) {
  value = in.bit();
}

inline void decode(BitReader& in, base::Bytes& value, const Octets&) { value = in.octets(); }

template <class T>
void decode(BitReader& in, T& value, Described);

template <class T, class Item>
void decode(BitReader& in, std::vector<T>& list, const ListOf<Item>& type) {
  const std::size_t size = type.min + in.bits(width_of(type.max - type.min));
  if (size > type.max) in.fail(fmt::format("a list of {}; expected at most {}", size, type.max));
  list.clear();
  for (std::size_t i = 0; i < size && in.good(); ++i) {
    decode(in, list.emplace_back(), type.item);
    if (!in.good()) in.fail_within(fmt::format("[{}]", i));
  }
}

inline void decode(BitReader& in, Additions& additions) {
  const std::size_t count = 1 + std::size_t{in.small_number()};
  const std::uint64_t present = in.bits(static_cast<unsigned>(count));
  additions.values.assign(in.good() ? count : 0, std::nullopt);
  for (std::size_t i = 0; i < count && in.good(); ++i)
    if (present >> (count - 1 - i) & 1) additions.values[i] = in.octets();
}

/// Reads the presence bits of optional components.
struct Presence {
  BitReader& in;
  std::uint32_t bits = 0;
  unsigned count = 0;

  template <class T, class Type>
  void operator()(std::string_view, T&, const Type&) {}
  template <class T, class Type>
  void optional(std::string_view, T&, const Type&) {
    bits |= static_cast<std::uint32_t>(in.bit()) << count++;
  }
};

/// Reads the components that are present.
struct Components {
  BitReader& in;
  std::uint32_t present = 0;

  template <class T, class Type>
  void operator()(std::string_view name, T& value, const Type& type) {
    if (!in.good()) return;
    decode(in, value, type);
    if (!in.good()) in.fail_within(name);
  }
  template <class T, class Type>
  void optional(std::string_view name, T& value, const Type& type) {
    if (present & 1) (*this)(name, engage(value), type);
    present >>= 1;
  }
};

template <class T>
void decode_choice(BitReader& in, T& value) {
  bool is_addition = false;
  if constexpr (ExtensibleChoice<T>) is_addition = in.bit();
  const std::size_t known = T::kAlternatives.size();
  const std::size_t row = is_addition ? known + in.small_number() : in.bits(width_of(known - 1));
  if (!is_addition && row >= known) in.fail(fmt::format("{} is not an alternative of the choice", row));
  if (!in.good()) return;
  value.choice = static_cast<typename T::Alternative>(row);
  if constexpr (ExtensibleChoice<T>) {
    if (is_addition) value.unknown = in.octets();
  }
  if (is_addition) return;
  alternative(value, [&](auto& content, const auto& type) { decode(in, content, type); });
  if (!in.good()) in.fail_within(T::kAlternatives[row]);
}

template <class T>
void decode(BitReader& in, T& value, Described) {
  if constexpr (Choice<T>) {
    decode_choice(in, value);
  } else {
    bool is_extended = false;
    if constexpr (ExtensibleSequence<T>) is_extended = in.bit();
    Presence presence{in};
    fields(value, presence);
    fields(value, Components{in, presence.bits});
    if constexpr (ExtensibleSequence<T>) {
      if (is_extended && in.good()) decode(in, value.additions);
    }
  }
}

}  // namespace sf::v2x::uper
