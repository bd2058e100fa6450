#include "control/settings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace sf::control {

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
  const double* value = std::get_if<double>(&setting->value);
  if (value == nullptr || !(*value >= least && *value <= most))
    refuse(key, fmt::format("'{}' of {} expects a number from {:g} to {:g}", key, owner_, least, most));
  return *value;
}

bool Settings::flag(std::string_view key, bool fallback) {
  const Setting* setting = find(key);
  if (setting == nullptr) return fallback;
  const bool* value = std::get_if<bool>(&setting->value);
  if (value == nullptr) refuse(key, fmt::format("'{}' of {} expects true or false", key, owner_));
  return *value;
}

std::string Settings::text(std::string_view key, const std::string& fallback) {
  const Setting* setting = find(key);
  if (setting == nullptr) return fallback;
  const std::string* value = std::get_if<std::string>(&setting->value);
  if (value == nullptr) refuse(key, fmt::format("'{}' of {} expects a text", key, owner_));
  return *value;
}

std::string Settings::choice(std::string_view key, const std::string& fallback, const std::vector<std::string>& words) {
  const std::string word = text(key, fallback);
  if (std::find(words.begin(), words.end(), word) == words.end())
    refuse(key, fmt::format("'{}' of {} is '{}'; expected one of: {}", key, owner_, word, fmt::join(words, ", ")));
  return word;
}

std::vector<double> Settings::numbers(std::string_view key, const std::vector<double>& fallback) {
  const Setting* setting = find(key);
  if (setting == nullptr) return fallback;
  const auto* value = std::get_if<std::vector<double>>(&setting->value);
  if (value == nullptr) refuse(key, fmt::format("'{}' of {} expects a list of numbers", key, owner_));
  return *value;
}

std::vector<std::string> Settings::texts(std::string_view key, const std::vector<std::string>& fallback) {
  const Setting* setting = find(key);
  if (setting == nullptr) return fallback;
  const auto* value = std::get_if<std::vector<std::string>>(&setting->value);
  if (value == nullptr) refuse(key, fmt::format("'{}' of {} expects a list of texts", key, owner_));
  return *value;
}

void Settings::require_all_read() const {
  for (std::size_t i = 0; i < settings_.size(); ++i) {
    if (read_[i]) continue;
    std::vector<std::string> known = asked_;
    std::sort(known.begin(), known.end());
    known.erase(std::unique(known.begin(), known.end()), known.end());
    refuse(settings_[i].key, fmt::format("{} has no setting '{}'; expected one of: {}", owner_, settings_[i].key,
                                         fmt::join(known, ", ")));
  }
}

}  // namespace sf::control
