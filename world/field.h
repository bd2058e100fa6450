#pragma once
// Describes one field of a row: its key in Stage files, its bounds, and its use in snapshots and the hash. The tables
// are in world/fields.h.

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <tuple>

namespace sf::world {

/// Unit of a number in a Stage file. Fields are in SI units, whatever the units of the file.
enum class Unit { none, length, angle, seconds, milliseconds };

/// A key whose value is one field: a number, a flag (0 or 1), a text, or a word of an enumeration (`words_of`).
struct Key {
  std::string_view name;  ///< empty: the field has no key, or its key has its own reader
  Unit unit = Unit::none;
  std::string_view tuple = {};  ///< names of a tuple's elements, e.g. "[xmin xmax]"; empty: a single value
  std::uint32_t element = 0;    ///< index in the tuple; the field keeps its value if a shorter tuple lacks it
  std::uint32_t least = 0;      ///< required number of elements
};

/// The values from `least` to `most`, excluding `least` if `open`. Never contains NaN.
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
  physics,  ///< readings depend on the field: in snapshot and hash
  label,    ///< in the snapshot only
  path      ///< in the snapshot only: a file name, relative to the world file's folder
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

/// Flags that share a byte, with the first in the lowest bit.
template <class Row, std::size_t n>
struct Flags {
  std::array<Field<Row, bool>, n> bits;
};
template <class Row, class... More>
constexpr auto flags(const Field<Row, bool>& first, const More&... more) {
  return Flags<Row, 1 + sizeof...(more)>{{first, more...}};
}

/// The fields of a row in the order of their bytes: Field or Flags. Specialized in world/fields.h.
template <class Row>
inline constexpr std::tuple<> kFields{};

/// Calls `visit(entry)` for each entry of the table.
template <class Row, class Visit>
constexpr void for_each_entry(Visit&& visit) {
  std::apply([&](const auto&... entry) { (visit(entry), ...); }, kFields<Row>);
}

/// Calls `visit(field)` for each field of the table, including each single flag.
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

/// Calls `visit(field)` for each field with a key.
template <class Row, class Visit>
constexpr void for_each_key(Visit&& visit) {
  for_each_field<Row>([&](const auto& field) {
    if (!field.key.name.empty()) visit(field);
  });
}

}  // namespace sf::world
