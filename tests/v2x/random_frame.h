#pragma once
// Random frames within all bounds, often at them: another visitor of the messages' descriptions.

#include <random>

#include "v2x/frame.h"
#include "v2x/map_fields.h"
#include "v2x/spat_fields.h"

namespace sf::v2x {

class RandomFrame {
 public:
  /// @param extensions whether to add components and alternatives of later editions, and octets after the message
  RandomFrame(std::uint64_t seed, bool extensions) : random_(seed), extensions_(extensions) {}

  Frame operator()() {
    Frame frame;
    if (chance(0.5)) {
      fill(frame.message.emplace<Spat>(), Described{});
    } else {
      fill(frame.message.emplace<MapData>(), Described{});
    }
    if (extensions_) fill(frame.additions);
    if (extensions_ && chance(0.2)) fill(frame.rest, Octets{});
    return frame;
  }

  template <class T, class Type>
  void operator()(std::string_view, T& value, const Type& type) {
    fill(value, type);
  }
  template <class T, class Type>
  void optional(std::string_view, T& value, const Type& type) {
    if (chance(0.4)) fill(engage(value), type);
  }

 private:
  bool chance(double share) { return std::bernoulli_distribution(share)(random_); }
  std::int64_t number(std::int64_t min, std::int64_t max) {
    if (chance(0.3)) return chance(0.5) ? min : max;
    return std::uniform_int_distribution<std::int64_t>(min, max)(random_);
  }
  /// Mostly short, so that messages end.
  std::size_t size(std::size_t min, std::size_t max) {
    return static_cast<std::size_t>(
        number(static_cast<std::int64_t>(min), static_cast<std::int64_t>(std::min(max, min + 2))));
  }

  template <class T>
  void fill(T& value, const Whole& range) {
    value = static_cast<T>(number(range.min, range.max));
  }
  template <class T>
  void fill(T& value, const Named& named) {
    const bool addition = extensions_ && named.extensible && chance(0.1);
    const auto known = static_cast<std::int64_t>(named.names.size());
    value = static_cast<T>(addition ? known + number(0, 63) : number(0, known - 1));
  }
  template <class T>
  void fill(T& value, const BitString& bits) {
    value = static_cast<T>(number(0, (std::int64_t{1} << bits.size) - 1));
  }
  void fill(ExtensibleBits& value, const BitString& bits) {
    value.size = static_cast<std::uint8_t>(extensions_ && chance(0.1) ? number(9, 62) : bits.size);
    value.bits = static_cast<std::uint64_t>(number(0, (std::int64_t{1} << value.size) - 1));
  }
  void fill(std::string& value, const Text& text) {
    value.clear();
    for (std::size_t n = size(1, text.max); n > 0; --n) value += static_cast<char>(number(32, 126));
  }
  void fill(bool& value, const Flag&) { value = chance(0.5); }
  void fill(base::Bytes& value, const Octets&) {
    value.clear();
    for (std::size_t n = size(1, chance(0.05) ? 300 : 3); n > 0; --n)
      value.push_back(static_cast<std::uint8_t>(number(0, 255)));
  }
  template <class T, class Item>
  void fill(std::vector<T>& list, const ListOf<Item>& type) {
    list.clear();
    for (std::size_t n = size(type.min, type.max); n > 0; --n) fill(list.emplace_back(), type.item);
  }
  void fill(Additions& additions) {
    if (!chance(0.1)) return;
    additions.values.resize(size(1, 3));
    for (auto& value : additions.values)
      if (chance(0.7)) fill(value.emplace(), Octets{});
  }
  template <class T>
  void fill(T& value, const Described&) {
    if constexpr (Choice<T>) {
      const auto known = static_cast<std::int64_t>(T::kAlternatives.size());
      value.choice = static_cast<typename T::Alternative>(number(0, known - 1));
      if constexpr (ExtensibleChoice<T>) {
        if (extensions_ && chance(0.1)) {
          value.choice = static_cast<typename T::Alternative>(known + number(0, 63));
          return fill(value.unknown, Octets{});
        }
      }
      alternative(value, [&](auto& content, const auto& type) { fill(content, type); });
    } else {
      fields(value, *this);
      if constexpr (ExtensibleSequence<T>) {
        if (extensions_) fill(value.additions);
      }
    }
  }

  std::mt19937_64 random_;
  bool extensions_;
};

}  // namespace sf::v2x
