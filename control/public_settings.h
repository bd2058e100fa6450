#pragma once
// The farm's settings as those of the public interface.

#include <string>
#include <string_view>
#include <vector>

#include "control/settings.h"
#include "sensorfarm/controller.h"

namespace sf::control {

/// Refers to `settings`, which must outlive it.
class PublicSettings final : public sensorfarm::Settings {
 public:
  explicit PublicSettings(control::Settings& settings) : settings_(settings) {}
  double number(std::string_view key, double fallback, double least, double most) override {
    return settings_.number(key, fallback, least, most);
  }
  bool flag(std::string_view key, bool fallback) override { return settings_.flag(key, fallback); }
  std::string text(std::string_view key, const std::string& fallback) override { return settings_.text(key, fallback); }
  std::vector<double> numbers(std::string_view key, const std::vector<double>& fallback) override {
    return settings_.numbers(key, fallback);
  }

 private:
  control::Settings& settings_;
};

}  // namespace sf::control
