#pragma once
// Encodes described values to UPER bits (ITU-T X.691, unaligned), the inverse of uper_decoder.h. A value out of bounds
// is a programming error and aborts.

#include <fmt/format.h>

#include <bit>

#include "base/error.h"
#include "v2x/bit_stream.h"
#include "v2x/constraints.h"

namespace sf::v2x::uper {

inline void put_number(BitWriter& out, std::int64_t number, std::int64_t min, std::int64_t max) {
  SF_CHECK(number >= min && number <= max, fmt::format("{} is not in [{}, {}]", number, min, max));
  out.put(static_cast<std::uint64_t>(number - min),
          static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(max - min))));
}

template <class T>
void encode(BitWriter& out, const T& value, const Whole& range) {
  put_number(out, value, range.min, range.max);
}

template <class T>
void encode(BitWriter& out, const T& value, const Named& named) {
  const std::size_t row = row_of(value);
  const std::size_t known = named.names.size();
  const bool is_addition = named.extensible && row >= known;
  if (named.extensible) out.put(is_addition, 1);
  if (is_addition) out.put_small_number(row - known);
  if (!is_addition) put_number(out, static_cast<std::int64_t>(row), 0, static_cast<std::int64_t>(known) - 1);
}

template <class T>
void encode(BitWriter& out, const T& value, const BitString& bits) {
  SF_CHECK(std::uint64_t{value} >> bits.size == 0, fmt::format("{:#x} has more than {} bits", value, bits.size));
  out.put(value, bits.size);
}

inline void encode(BitWriter& out, const ExtensibleBits& value, const BitString& bits) {
  const bool is_extended = value.size != bits.size;
  out.put(is_extended, 1);
  if (is_extended) put_number(out, value.size, 0, 255);
  SF_CHECK(value.size <= 64, "a bit string of more than 64 bits");
  out.put(value.bits, value.size);
}

inline void encode(BitWriter& out, const std::string& value, const Text& text) {
  put_number(out, static_cast<std::int64_t>(value.size()), 1, static_cast<std::int64_t>(text.max));
  for (const char c : value) put_number(out, c, 0, 127);
}

template <class T>
void encode(BitWriter& out, const T& value, const Flag&) {
  out.put(value, 1);
}

inline void encode(BitWriter& out, const base::Bytes& value, const Octets&) { out.put_octets(value); }

template <class T>
void encode(BitWriter& out, const T& value, Described);

template <class T, class Item>
void encode(BitWriter& out, const std::vector<T>& list, const ListOf<Item>& type) {
  put_number(out, static_cast<std::int64_t>(list.size()), static_cast<std::int64_t>(type.min),
             static_cast<std::int64_t>(type.max));
  for (const T& item : list) encode(out, item, type.item);
}

inline void encode(BitWriter& out, const Additions& additions) {
  out.put_small_number(additions.values.size() - 1);
  for (const auto& value : additions.values) out.put(value.has_value(), 1);
  for (const auto& value : additions.values)
    if (value) out.put_octets(*value);
}

/// Writes the presence bits of optional components.
struct PutPresence {
  BitWriter& out;

  template <class T, class Type>
  void operator()(std::string_view, const T&, const Type&) {}
  template <class T, class Type>
  void optional(std::string_view, const T& value, const Type&) {
    out.put(is_present(value), 1);
  }
};

/// Writes the components that are present.
struct PutComponents {
  BitWriter& out;

  template <class T, class Type>
  void operator()(std::string_view, const T& value, const Type& type) {
    encode(out, value, type);
  }
  template <class T, class Type>
  void optional(std::string_view, const T& value, const Type& type) {
    if (is_present(value)) encode(out, engage(value), type);
  }
};

template <class T>
void encode_choice(BitWriter& out, const T& value) {
  const std::size_t row = row_of(value.choice);
  const std::size_t known = T::kAlternatives.size();
  if constexpr (ExtensibleChoice<T>) {
    out.put(row >= known, 1);
    if (row >= known) {
      out.put_small_number(row - known);
      return out.put_octets(value.unknown);
    }
  }
  put_number(out, static_cast<std::int64_t>(row), 0, static_cast<std::int64_t>(known) - 1);
  alternative(value, [&](const auto& content, const auto& type) { encode(out, content, type); });
}

template <class T>
void encode(BitWriter& out, const T& value, Described) {
  if constexpr (Choice<T>) {
    encode_choice(out, value);
  } else {
    if constexpr (ExtensibleSequence<T>) out.put(!value.additions.values.empty(), 1);
    fields(value, PutPresence{out});
    fields(value, PutComponents{out});
    if constexpr (ExtensibleSequence<T>) {
      if (!value.additions.values.empty()) encode(out, value.additions);
    }
  }
}

}  // namespace sf::v2x::uper
