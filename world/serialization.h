#pragma once
// Serializes rows of a world, as described by the tables of world/fields.h. Shared by the hash and the snapshot.
//
// Numbers are little-endian. A flag or a word of an enumeration is one byte. Texts and vectors are preceded by their
// length (u32). A row consists of its fields in the order of its table.

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/error.h"
#include "world/fields.h"

namespace sf::world {

/// The fields of a row to write: all, or only those that readings depend on (no colours).
enum class RowFields { all, physics };

template <class T>
inline constexpr bool kIsRow = std::tuple_size_v<std::remove_const_t<decltype(kFields<T>)>> > 0;

struct RowWriter {
  base::ByteWriter& out;
  RowFields fields = RowFields::all;
  std::filesystem::path folder = {};  ///< folder of the world file; file names are written relative to it

  template <class T>
  void put(const T& value, Role role = Role::physics) {
    if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) {
      out.put(static_cast<std::uint8_t>(value));
    } else if constexpr (std::is_arithmetic_v<T>) {
      out.put(value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      out.put_string(role == Role::path ? relative(value) : value);
    } else if constexpr (kIsRow<T>) {
      put_row(value);
    } else if constexpr (std::is_same_v<T, base::Bytes>) {
      out.put(static_cast<std::uint32_t>(value.size()));
      out.put_bytes(value.data(), value.size());
    } else {
      out.put(static_cast<std::uint32_t>(value.size()));
      for (const auto& element : value) put(element, role);
    }
  }
  void put(const std::pair<const std::string, int>& counted, Role role) {
    put(counted.first, role);
    put(counted.second, role);
  }

 private:
  template <class Row>
  void put_row(const Row& row) {
    // Worlds without an accuracy keep the hash that they had before this field existed.
    if constexpr (std::is_same_v<Row, Accuracy>)
      if (fields == RowFields::physics && row.word.empty()) return;
    for_each_entry<Row>([&](const auto& entry) {
      if constexpr (requires { entry.bits; }) {
        int byte = 0;
        for (std::size_t i = 0; i < entry.bits.size(); ++i) byte |= (row.*entry.bits[i].member ? 1 : 0) << i;
        out.put(static_cast<std::uint8_t>(byte));
      } else if (fields == RowFields::all || entry.role == Role::physics) {
        put(row.*entry.member, entry.role);
      }
    });
  }
  std::string relative(const std::string& file) const {
    const std::string own = std::filesystem::path(file).lexically_normal().lexically_relative(folder).string();
    return file.empty() || own.empty() ? file : own;
  }
};

/// Returns the smallest serialized size of a T, for checking counts.
template <class T>
constexpr std::size_t least_bytes() {
  if constexpr (std::is_same_v<T, bool> || std::is_enum_v<T>) return 1;
  if constexpr (std::is_arithmetic_v<T>) return sizeof(T);
  std::size_t sum = kIsRow<T> ? 0 : 4;  // a length
  for_each_entry<T>([&](const auto& entry) {
    if constexpr (requires { entry.bits; }) {
      sum += 1;
    } else {
      sum += least_bytes<std::remove_cvref_t<decltype(std::declval<T>().*entry.member)>>();
    }
  });
  return sum;
}

struct RowReader {
  base::ByteReader& in;

  /// @throws base::InputError for a count that exceeds the remaining bytes, and for an unknown word of an enumeration
  template <class T>
  void get(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      value = in.get<std::uint8_t>() != 0;
    } else if constexpr (std::is_enum_v<T>) {
      const auto word = in.get<std::uint8_t>();
      if (word >= words_of(T{}).size()) throw base::InputError("corrupt world snapshot: unknown word");
      value = static_cast<T>(word);
    } else if constexpr (std::is_arithmetic_v<T>) {
      value = in.get<T>();
    } else if constexpr (std::is_same_v<T, std::string>) {
      value = in.get_string();
    } else if constexpr (kIsRow<T>) {
      get_row(value);
    } else if constexpr (std::is_same_v<T, base::Bytes>) {
      value.resize(count(1));
      in.get_into(value.data(), value.size());
    } else {
      value.resize(count(least_bytes<typename T::value_type>()));
      for (auto& element : value) get(element);
    }
  }
  void get(std::map<std::string, int>& counts) {
    for (std::uint32_t left = count(8); left > 0; --left) {
      const std::string word = in.get_string();
      get(counts[word]);
    }
  }

 private:
  template <class Row>
  void get_row(Row& row) {
    for_each_entry<Row>([&](const auto& entry) {
      if constexpr (requires { entry.bits; }) {
        const auto byte = in.get<std::uint8_t>();
        for (std::size_t i = 0; i < entry.bits.size(); ++i) row.*entry.bits[i].member = (byte >> i & 1) != 0;
      } else {
        get(row.*entry.member);
      }
    });
  }
  std::uint32_t count(std::size_t row_size) {
    const auto rows = in.get<std::uint32_t>();
    if (!in.good() || rows > in.left() / row_size) throw base::InputError("corrupt world snapshot: truncated");
    return rows;
  }
};

/// Returns whether all numbers are within the bounds of their fields.
template <class T>
bool is_within(const T& value, const Bounds& bounds = {}) {
  if constexpr (std::is_arithmetic_v<T>) {
    return bounds.contains(static_cast<double>(value));
  } else if constexpr (kIsRow<T>) {
    bool good = true;
    for_each_field<T>([&](const auto& field) { good = good && is_within(value.*field.member, field.bounds); });
    return good;
  } else if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, base::Bytes> ||
                       !requires { value.back(); }) {
    return true;
  } else {
    return std::all_of(value.begin(), value.end(), [&](const auto& element) { return is_within(element, bounds); });
  }
}

}  // namespace sf::world
