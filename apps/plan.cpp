#include "apps/plan.h"

#include <fmt/format.h>

namespace sf::apps {

control::Setting setting_of(const std::string& text) {
  const std::size_t at = text.find('=');
  const std::string key = text.substr(0, at);
  return {key, control::RawText{text.substr(at + 1)}, fmt::format("--set {}: ", key)};
}

control::Plan plan_of(const Options& options) {
  std::vector<control::Setting> settings;
  for (const std::string& text : options.set) settings.push_back(setting_of(text));
  return {options.controller, 0.0,
          control::Settings(fmt::format("controller '{}'", options.controller), std::move(settings))};
}

}  // namespace sf::apps
