#pragma once
// Types of components as in ASN.1. Each message describes itself once, by
//
//   fields(value, f)        f("name", member, constraint), f.optional("name", member, constraint), in order (SEQUENCE)
//   alternative(value, f)   f(member, constraint) for the alternative `value.choice` (CHOICE)
//
// Encodings are visitors of these descriptions: UPER (uper_decoder.h, uper_encoder.h), XML (xml.cpp), JSON
// (apps/reports/v2x_json.cpp). An optional component is a std::optional, or a text or list that is absent when empty.

#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "base/bytes.h"

namespace sf::v2x {

/// INTEGER (min..max)
struct Whole {
  std::int64_t min = 0;
  std::int64_t max = 0;
};

/// ENUMERATED: the member is the row of its name. In an extensible type, larger values are the number of names plus the
/// number of the addition.
struct Named {
  std::span<const std::string_view> names;
  bool extensible = true;
};

/// BIT STRING (SIZE(size)), bit 0 the most significant of `size`. Extensible: the member is `ExtensibleBits`.
struct BitString {
  unsigned size = 0;
};

/// BIT STRING (SIZE(8,...))
struct ExtensibleBits {
  static constexpr std::uint8_t kSize = 8;
  std::uint64_t bits = 0;
  std::uint8_t size = kSize;  ///< in [0, 64]
  bool operator==(const ExtensibleBits&) const = default;
};

/// IA5String (SIZE(1..max)): ASCII
struct Text {
  std::size_t max = 0;
};

/// BOOLEAN
struct Flag {};

/// An open type, stored as octets
struct Octets {};

/// A SEQUENCE or CHOICE that describes itself
struct Described {};

/// SEQUENCE (SIZE(min..max)) OF
template <class Item = Described>
struct ListOf {
  std::string_view element;  ///< its name in XML; none for items that are a CHOICE or ENUMERATED
  std::size_t min = 1;
  std::size_t max = 0;
  Item item{};
};

/// Components added to a SEQUENCE by a later edition; absent ones are empty. No values: no extension.
struct Additions {
  static constexpr std::size_t kMax = 64;
  std::vector<std::optional<base::Bytes>> values;
  bool operator==(const Additions&) const = default;
};

template <class T>
concept Choice = requires(T& value) {
  value.choice;
};
/// `unknown` contains the octets of an alternative added by a later edition.
template <class T>
concept ExtensibleChoice = Choice<T> && requires(T& value) {
  value.unknown;
};
template <class T>
concept ExtensibleSequence = requires(T& value) {
  value.additions;
};
template <class T, class U>
concept Is = std::same_as<std::remove_const_t<T>, U>;

template <class T>
bool is_present(const std::optional<T>& value) {
  return value.has_value();
}
inline bool is_present(const std::string& text) { return !text.empty(); }
template <class T>
bool is_present(const std::vector<T>& list) {
  return !list.empty();
}

/// Returns the value of an optional component, and creates it if absent.
template <class T>
T& engage(std::optional<T>& value) {
  return value ? *value : value.emplace();
}
template <class T>
const T& engage(const std::optional<T>& value) {
  return *value;
}
template <class T>
T& engage(T& value) {
  return value;
}

/// Row in the names of a choice or enumeration as a number; additions follow the names.
template <class Row>
std::size_t row_of(Row row) {
  return static_cast<std::size_t>(row);
}

}  // namespace sf::v2x
