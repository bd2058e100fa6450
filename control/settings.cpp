#include "control/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/error.h"
#include "base/suggest.h"

namespace sf::control {

namespace {

bool is_raw(const Value& value) { return std::holds_alternative<RawText>(value); }

/// The value as text for messages.
std::string setting_value_text(const Value& value) {
  if (const auto* raw = std::get_if<RawText>(&value)) return fmt::format("'{}'", raw->text);
  if (const auto* text = std::get_if<std::string>(&value)) return fmt::format("'{}'", *text);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
  if (const auto* numbers = std::get_if<std::vector<double>>(&value))
    return fmt::format("[{}]", fmt::join(*numbers, ", "));
  return fmt::format("['{}']", fmt::join(std::get<std::vector<std::string>>(value), "', '"));
}

/// Returns the value as a T, if it is one or `read` converts it.
template <class T, class Read>
std::optional<T> value_as(const Value& value, Read&& read) {
  if (const auto* raw = std::get_if<RawText>(&value)) return read(raw->text);
  const T* typed = std::get_if<T>(&value);
  return typed != nullptr ? std::optional<T>(*typed) : std::nullopt;
}

std::string expected_one_of(const std::string& word, const std::vector<std::string>& words) {
  return base::expected_one_of(word, std::vector<std::string_view>(words.begin(), words.end()));
}

}  // namespace

Settings::Settings(std::string owner, std::vector<Setting> settings)
    : owner_(std::move(owner)), settings_(std::move(settings)), read_(settings_.size()) {}

const Setting* Settings::find(std::string_view key) {
  asked_.emplace_back(key);
  for (std::size_t i = 0; i < settings_.size(); ++i) {
    if (settings_[i].key != key) continue;
    read_[i] = true;
    return &settings_[i];
  }
  return nullptr;
}

bool Settings::has(std::string_view key) const {
  return std::any_of(settings_.begin(), settings_.end(), [&](const Setting& s) { return s.key == key; });
}

void Settings::refuse(std::string_view key, const std::string& message) const {
  for (const Setting& setting : settings_)
    if (setting.key == key) throw base::InputError(setting.where + message);
  throw base::InputError(owner_ + ": " + message);
}

double Settings::number(std::string_view key, double fallback, double least, double most) {
  const Setting* setting = find(key);
  if (setting == nullptr) return fallback;
  const auto value = value_as<double>(setting->value, read_number);
  if (!value || !(*value >= least && *value <= most))
    refuse(key, fmt::format("'{}' of {} expects a number from {:g} to {:g}; got {}", key, owner_, least, most,
                            setting_value_text(setting->value)));
  return *value;
}

bool Settings::flag(std::string_view key, bool fallback) {
  const Setting* setting = find(key);
  if (setting == nullptr) return fallback;
  const auto value = value_as<bool>(setting->value, read_flag);
  if (!value)
    refuse(key,
           fmt::format("'{}' of {} expects true or false; got {}", key, owner_, setting_value_text(setting->value)));
  return *value;
}

std::string Settings::text(std::string_view key, const std::string& fallback) {
  const Setting* setting = find(key);
  if (setting == nullptr) return fallback;
  const auto value = value_as<std::string>(setting->value, [](const std::string& raw) { return read_text(raw); });
  if (!value)
    refuse(key,
           fmt::format("'{}' of {} expects a text in quotes; got {}", key, owner_, setting_value_text(setting->value)));
  return *value;
}

std::string Settings::choice(std::string_view key, const std::string& fallback, const std::vector<std::string>& words) {
  const std::string word = text(key, fallback);
  if (std::find(words.begin(), words.end(), word) == words.end())
    refuse(key, fmt::format("'{}' of {} is '{}'{}", key, owner_, word, expected_one_of(word, words)));
  return word;
}

std::vector<double> Settings::numbers(std::string_view key, const std::vector<double>& fallback) {
  const Setting* setting = find(key);
  if (setting == nullptr) return fallback;
  const auto value = value_as<std::vector<double>>(setting->value, read_numbers);
  if (!value)
    refuse(key, fmt::format("'{}' of {} expects a list of numbers such as {}; got {}", key, owner_,
                            is_raw(setting->value) ? "1,2" : "[1, 2]", setting_value_text(setting->value)));
  return *value;
}

std::vector<std::string> Settings::texts(std::string_view key, const std::vector<std::string>& fallback) {
  const Setting* setting = find(key);
  if (setting == nullptr) return fallback;
  const auto value = value_as<std::vector<std::string>>(setting->value, read_texts);
  if (!value)
    refuse(key, fmt::format("'{}' of {} expects a list of texts such as {}; got {}", key, owner_,
                            is_raw(setting->value) ? "a,b" : "[\"a\", \"b\"]", setting_value_text(setting->value)));
  return *value;
}

void Settings::require_all_read() const {
  for (std::size_t i = 0; i < settings_.size(); ++i) {
    if (read_[i]) continue;
    std::vector<std::string> known = asked_;
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    if (known.empty())
      refuse(settings_[i].key, fmt::format("{} has no settings; remove '{}'", owner_, settings_[i].key));
    refuse(settings_[i].key,
           fmt::format("{} has no setting '{}'{}", owner_, settings_[i].key, expected_one_of(settings_[i].key, known)));
  }
}

}  // namespace sf::control
