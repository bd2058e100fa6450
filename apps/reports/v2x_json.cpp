#include "apps/reports/v2x_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "base/error.h"
#include "base/suggest.h"
#include "v2x/map_fields.h"
#include "v2x/spat_fields.h"
#include "v2x/text_forms.h"

namespace sf::apps {

namespace {

using Json = nlohmann::ordered_json;
using namespace v2x;  // the constraints; each is overloaded for both directions

constexpr const char* kExtensions = "extensions";

// Values to JSON.
template <class T>
Json to_json(const T& value, const Whole&) {
  return value;
}
template <class T>
Json to_json(const T& value, const Named& type) {
  return row_text(type.names, row_of(value));
}
template <class T>
Json to_json(const T& value, const BitString& type) {
  return bits_text(value, type.size);
}
Json to_json(const ExtensibleBits& value, const BitString&) { return bits_text(value.bits, value.size); }
Json to_json(const std::string& value, const Text&) { return value; }
Json to_json(bool value, const Flag&) { return value; }
Json to_json(const base::Bytes& value, const Octets&) { return hex_text(value); }
Json to_json(const Additions& additions) {
  Json list = Json::array();
  for (const auto& value : additions.values) list.push_back(value ? Json(hex_text(*value)) : Json());
  return list;
}
template <class T>
Json to_json(const T& value, Described);
template <class T, class Item>
Json to_json(const std::vector<T>& list, const ListOf<Item>& type) {
  Json items = Json::array();
  for (const T& item : list) items.push_back(to_json(item, type.item));
  return items;
}

struct PutMembers {
  Json& object;

  template <class T, class Type>
  void operator()(std::string_view name, const T& value, const Type& type) {
    object[std::string(name)] = to_json(value, type);
  }
  template <class T, class Type>
  void optional(std::string_view name, const T& value, const Type& type) {
    if (is_present(value)) (*this)(name, engage(value), type);
  }
};

template <class T>
Json to_json(const T& value, Described) {
  Json object = Json::object();
  if constexpr (Choice<T>) {
    Json& content = object[row_text(T::kAlternatives, row_of(value.choice))];
    if constexpr (ExtensibleChoice<T>) {
      if (row_of(value.choice) >= T::kAlternatives.size()) return content = hex_text(value.unknown), object;
    }
    alternative(value, [&](const auto& inner, const auto& type) { content = to_json(inner, type); });
  } else {
    fields(value, PutMembers{object});
  }
  if constexpr (ExtensibleSequence<T>) {
    if (!value.additions.values.empty()) object[kExtensions] = to_json(value.additions);
  }
  return object;
}

/// Type of the input. Not the ordered type: ordered objects copy their values when they grow, recursively for nested
/// ones.
using Input = nlohmann::json;

/// Formats a value for a message. Lists and objects are not printed, since printing and copying them recurse for nested
/// ones.
std::string shown(const Input& json) {
  if (json.is_array()) return fmt::format("a list of {}", json.size());
  if (json.is_object()) return "an object";
  const std::string text = json.dump(-1, ' ', false, Input::error_handler_t::replace);
  return text.size() > 40 ? text.substr(0, 37) + "..." : text;
}

/// Converts JSON to values. Errors name the component, as "SPAT.intersections[0].states[2].signalGroup".
class Reader {
 public:
  Reader(const std::string& file, int line) : file_(file), line_(line) {}

  Frame frame(const Input& json) {
    Frame frame;
    Members members{*this, object(json)};
    const Input& id = members.required("messageId");
    if (id != Spat::kMessageId && id != MapData::kMessageId)
      fail(fmt::format("messageId is {}; expected 19 (SPaT) or 18 (MAP)", shown(id)));
    const Input& value = members.required("value");
    within("value", [&] {
      if (id == Spat::kMessageId) {
        message(object(value), frame.message.emplace<Spat>());
      } else if (id == MapData::kMessageId) {
        message(object(value), frame.message.emplace<MapData>());
      }
    });
    members.optional("rest", frame.rest, Octets{});
    members.optional("padding", frame.padding, Octets{});
    members.optional(kExtensions, frame.additions.values, Described{});
    members.refuse_others();
    return frame;
  }

 private:
  /// The members of one object. Stores their names to detect unknown ones.
  struct Members {
    Reader& reader;
    const Input& json;
    std::vector<std::string_view> known{};

    const Input& required(std::string_view name) {
      known.push_back(name);
      const auto found = json.find(std::string(name));
      if (found == json.end()) reader.fail(fmt::format("'{}' is missing", name));
      return *found;
    }
    template <class T, class Type>
    void operator()(std::string_view name, T& value, const Type& type) {
      const Input& member = required(name);
      reader.within(std::string(name), [&] { reader.read(member, value, type); });
    }
    template <class T, class Type>
    void optional(std::string_view name, T& value, const Type& type) {
      if (json.contains(std::string(name))) return (*this)(name, engage(value), type);
      known.push_back(name);
    }
    void refuse_others() const {
      for (const auto& [name, value] : json.items())
        if (std::find(known.begin(), known.end(), name) == known.end())
          reader.fail(fmt::format("'{}' is not a component here{}", name, base::suggest(name, known)));
    }
  };

  [[noreturn]] void fail(const std::string& reason) const {
    throw base::InputError(file_, line_, place_.empty() ? reason : fmt::format("{}: {}", place_, reason));
  }
  [[noreturn]] void refuse(const Input& json, const std::string& expected) const {
    fail(fmt::format("found {}; expected {}", shown(json), expected));
  }
  template <class Inner>
  void within(const std::string& component, Inner&& inner) {
    const std::size_t size = place_.size();
    place_ += (place_.empty() || component.front() == '[' ? "" : ".") + component;
    inner();
    place_.resize(size);
  }
  const Input& object(const Input& json) const {
    if (!json.is_object()) refuse(json, "an object");
    return json;
  }
  std::string text(const Input& json, const std::string& expected) const {
    if (!json.is_string()) refuse(json, expected);
    return json.get<std::string>();
  }
  std::uint64_t bits(const Input& json, std::size_t size, const std::string& expected) const {
    const std::string digits = text(json, expected);
    if (digits.size() != size || digits.find_first_not_of("01") != std::string::npos) refuse(json, expected);
    std::uint64_t value = 0;
    for (const char digit : digits) value = value << 1 | (digit == '1');
    return value;
  }

  template <class Message>
  void message(const Input& value, Message& message) {
    Members members{*this, value};
    members(Message::kTag, message, Described{});
    members.refuse_others();
  }

  template <class T>
  void read(const Input& json, T& value, const Whole& range) {
    const std::string expected = fmt::format("a whole number from {} to {}", range.min, range.max);
    const bool fits = json.is_number_integer() && (!json.is_number_unsigned() ||
                                                   json.get<std::uint64_t>() <= static_cast<std::uint64_t>(INT64_MAX));
    if (!fits) refuse(json, expected);
    const auto number = json.get<std::int64_t>();
    if (number < range.min || number > range.max) refuse(json, expected);
    value = static_cast<T>(number);
  }
  template <class T>
  void read(const Input& json, T& value, const Named& type) {
    const std::string word = text(json, "a name");
    const auto row = read_row(type.names, type.extensible, word);
    if (!row) refuse(json, fmt::format("one of {}{}", fmt::join(type.names, ", "), base::suggest(word, type.names)));
    value = static_cast<T>(*row);
  }
  template <class T>
  void read(const Input& json, T& value, const BitString& type) {
    value = static_cast<T>(bits(json, type.size, fmt::format("a text of {} digits 0 and 1", type.size)));
  }
  void read(const Input& json, ExtensibleBits& value, const BitString&) {
    const std::string expected = "a text of 8, at most 64, digits 0 and 1";
    const std::size_t size = text(json, expected).size();
    if (size > 64) refuse(json, expected);
    value = {bits(json, size, expected), static_cast<std::uint8_t>(size)};
  }
  void read(const Input& json, std::string& value, const Text& type) {
    const std::string expected = fmt::format("a text of 1 to {} ASCII characters", type.max);
    value = text(json, expected);
    const bool is_ascii = std::all_of(value.begin(), value.end(), [](char c) { return (c & 0x80) == 0; });
    if (value.empty() || value.size() > type.max || !is_ascii) refuse(json, expected);
  }
  void read(const Input& json, bool& value, const Flag&) {
    if (!json.is_boolean()) refuse(json, "true or false");
    value = json.get<bool>();
  }
  void read(const Input& json, base::Bytes& value, const Octets&) {
    const std::string expected = "a text of hexadecimal digits, two for each octet";
    const auto octets = read_hex(text(json, expected));
    if (!octets || octets->size() > kMaxFrame) refuse(json, expected);
    value = *octets;
  }
  void read(const Input& json, std::vector<std::optional<base::Bytes>>& values, Described) {
    if (!json.is_array() || json.empty() || json.size() > Additions::kMax)
      refuse(json, fmt::format("a list of 1 to {} extensions", Additions::kMax));
    for (std::size_t i = 0; i < json.size(); ++i) {
      auto& value = values.emplace_back();
      if (!json[i].is_null()) within(fmt::format("[{}]", i), [&] { read(json[i], value.emplace(), Octets{}); });
    }
  }
  template <class T, class Item>
  void read(const Input& json, std::vector<T>& list, const ListOf<Item>& type) {
    if (!json.is_array() || json.size() < type.min || json.size() > type.max)
      refuse(json, fmt::format("a list of {} to {}", type.min, type.max));
    for (std::size_t i = 0; i < json.size(); ++i)
      within(fmt::format("[{}]", i), [&] { read(json[i], list.emplace_back(), type.item); });
  }
  template <class T>
  void read(const Input& json, T& value, Described) {
    if constexpr (Choice<T>) {
      choice(object(json), value);
    } else {
      Members members{*this, object(json)};
      fields(value, members);
      if constexpr (ExtensibleSequence<T>) members.optional(kExtensions, value.additions.values, Described{});
      members.refuse_others();
    }
  }
  template <class T>
  void choice(const Input& json, T& value) {
    const std::string expected = fmt::format("one of {} with its value", fmt::join(T::kAlternatives, ", "));
    if (json.size() != 1) refuse(json, expected);
    const std::string name = json.begin().key();
    const auto row = read_row(T::kAlternatives, ExtensibleChoice<T>, name);
    if (!row) refuse(json, expected);
    value.choice = static_cast<typename T::Alternative>(*row);
    within(name, [&] {
      if constexpr (ExtensibleChoice<T>) {
        if (*row >= T::kAlternatives.size()) return read(json.front(), value.unknown, Octets{});
      }
      alternative(value, [&](auto&& inner, const auto& type) { read(json.front(), inner, type); });
    });
  }

  const std::string& file_;
  int line_;
  std::string place_;
};

}  // namespace

std::string v2x_frame_json(const v2x::Frame& frame) {
  Json object = Json::object();
  std::visit(
      [&](const auto& message) {
        object["messageId"] = message.kMessageId;
        object["value"][std::string(message.kTag)] = to_json(message, Described{});
      },
      frame.message);
  if (!frame.rest.empty()) object["rest"] = hex_text(frame.rest);
  if (!frame.padding.empty()) object["padding"] = hex_text(frame.padding);
  if (!frame.additions.values.empty()) object[kExtensions] = to_json(frame.additions);
  return object.dump();
}

void read_frames(const std::string& file, const std::string& text, const std::function<void(const v2x::Frame&)>& take) {
  std::istringstream stream(text);
  int line = 1;
  std::size_t counted = 0;
  if ((stream >> std::ws).eof()) throw base::InputError(file, 0, "no frame in it; expected JSON");
  while (!(stream >> std::ws).eof()) {
    const auto at = static_cast<std::size_t>(stream.tellg());
    line += static_cast<int>(std::count(text.begin() + counted, text.begin() + at, '\n'));
    counted = at;
    Input json;
    try {
      stream >> json;
    } catch (const Input::exception& error) {
      const std::string what = error.what();
      throw base::InputError(file, line, "not JSON from here on: " + what.substr(what.find("] ") + 2));
    }
    const auto read = [&](const Input& one) { take(Reader(file, line).frame(one)); };
    if (json.is_array()) {
      for (const Input& one : json) read(one);
    } else {
      read(json);
    }
  }
}

}  // namespace sf::apps
