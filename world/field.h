#pragma once
// Description of one field of a row: its key in Stage files, its bounds, and its part in snapshots and the hash.
// world/fields.h has the tables.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <tuple>

namespace sf::world {

/// Unit of a number in a Stage file. Fields are in SI units, whatever the file's units.
enum class Unit { none, length, angle, seconds, milliseconds };

/// A key whose value is one field: a number, a flag (0 or 1), a text, or a word of an enumeration (`words_of`).
struct Key {
  std::string_view name;  ///< empty: the field has no key, or a key with a reader of its own
  Unit unit = Unit::none;
  std::string_view tuple = {};  ///< names of a tuple's elements, e.g. "[xmin xmax]"; empty: a single value
  std::uint32_t element = 0;    ///< of the tuple; the field keeps its value where a shorter tuple lacks it
  std::uint32_t least = 0;      ///< elements that the tuple needs
};

/// The values from `least` to `most`, without `least` where `open`. NaN is never inside.
struct Bounds {
  double least = -std::numeric_limits<double>::max();
  double most = std::numeric_limits<double>::max();
  bool open = false;

  bool contains(double value) const { return (open ? value > least : value >= least) && value <= most; }
};

inline constexpr Bounds kFinite{};
inline constexpr Bounds kNotNegative{0.0};
inline constexpr Bounds kAboveZero{.least = 0.0, .open = true};
inline constexpr Bounds kAboveZeroOrInfinite{0.0, HUGE_VAL, true};

enum class Role {
  physics,  ///< readings depend on the field: snapshot and hash
  label,    ///< snapshot only
  path      ///< snapshot only: the name of a file, relative to the world file's folder
};

template <class Row, class T>
struct Field {
  T Row::*member;
  Key key;
  Bounds bounds;
  Role role;
};

template <class Row, class T>
constexpr Field<Row, T> field(T Row::*member, const Key& key = {}, const Bounds& bounds = kFinite,
                              Role role = Role::physics) {
  return {member, key, bounds, role};
}
template <class Row, class T>
constexpr Field<Row, T> field(T Row::*member, const Bounds& bounds) {
  return {member, {}, bounds, Role::physics};
}
template <class Row, class T>
constexpr Field<Row, T> label(T Row::*member, const Key& key = {}) {
  return {member, key, kFinite, Role::label};
}
template <class Row, class T>
constexpr Field<Row, T> path(T Row::*member) {
  return {member, {}, kFinite, Role::path};
}

/// Flags that share a byte, the first in its lowest bit.
template <class Row, std::size_t n>
struct Flags {
  std::array<Field<Row, bool>, n> bits;
};
template <class Row, class... More>
constexpr auto flags(const Field<Row, bool>& first, const More&... more) {
  return Flags<Row, 1 + sizeof...(more)>{{first, more...}};
}

/// The fields of a row in the order of their bytes: Field, or Flags. Specialized in world/fields.h.
template <class Row>
inline constexpr std::tuple<> kFields{};

/// `visit(entry)` for each entry of the table.
template <class Row, class Visit>
constexpr void for_each_entry(Visit&& visit) {
  std::apply([&](const auto&... entry) { (visit(entry), ...); }, kFields<Row>);
}

/// `visit(field)` for each field of the table, flags one by one.
template <class Row, class Visit>
constexpr void for_each_field(Visit&& visit) {
  for_each_entry<Row>([&](const auto& entry) {
    if constexpr (requires { entry.bits; }) {
      for (const auto& bit : entry.bits) visit(bit);
    } else {
      visit(entry);
    }
  });
}

/// `visit(field)` for each field with a key.
template <class Row, class Visit>
constexpr void for_each_key(Visit&& visit) {
  for_each_field<Row>([&](const auto& field) {
    if (!field.key.name.empty()) visit(field);
  });
}

}  // namespace sf::world
