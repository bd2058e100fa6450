#pragma once
// Reads the keys of the tables in world/fields.h into the fields of a row.

#include <span>
#include <string>
#include <string_view>
#include <type_traits>

#include "world/fields.h"
#include "world/stage/properties.h"

namespace sf::world {

/// Returns the value of `key` in SI units; `value` if `entity` lacks the key or the tuple's element.
/// @throws base::InputError if it has another type or is out of bounds
double read_number(StageContext& context, const Entity& entity, const Key& key, const Bounds& bounds, double value);

/// Returns the row in `words` of `written`, the text of `key`. @throws base::InputError at `at`, listing all words
std::size_t word_row(const StageContext& context, SourceLocation at, std::string_view key, std::string_view written,
                     std::span<const std::string_view> words);

/// Returns the row in `words` of the text of `key`. @throws base::InputError listing all words
std::size_t read_word(StageContext& context, const Entity& entity, std::string_view key,
                      std::span<const std::string_view> words);

/// Sets the fields whose keys `entity` has. Other fields keep their values, which are the keys' defaults.
template <class Row>
void read_keys(StageContext& context, const Entity& entity, Row& row) {
  for_each_key<Row>([&](const auto& field) {
    auto& value = row.*field.member;
    using T = std::remove_reference_t<decltype(value)>;
    const std::string_view key = field.key.name;
    if (find(entity, key) == nullptr) return;
    if constexpr (std::is_same_v<T, bool>) {
      value = flag(context, entity, key, value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      value = text(context, entity, key, value);
    } else if constexpr (std::is_enum_v<T>) {
      value = static_cast<T>(read_word(context, entity, key, words_of(value)));
    } else if constexpr (std::is_same_v<T, double>) {
      value = read_number(context, entity, field.key, field.bounds, value);
    }
  });
}

}  // namespace sf::world
