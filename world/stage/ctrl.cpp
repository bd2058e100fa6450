#include "world/stage/ctrl.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <utility>

#include "base/installation.h"
#include "base/suggest.h"

namespace sf::world {

namespace {

/// Plug-ins that Stage installs; its `wander` has the farm's as its counterpart.
constexpr std::array<std::string_view, 9> kStagePlugins{
    "fasr", "fasr2", "dynamic", "lasernoise", "pioneer_flocking", "rasterize", "sink", "source", "lsp_test"};

/// Returns the words between blanks outside of quotes and brackets.
std::vector<std::string> setting_words(std::string_view text) {
  std::vector<std::string> words(1);
  char open = 0;
  for (const char c : text) {
    const bool blank = open == 0 && (c == ' ' || c == '\t' || c == '\n' || c == '\r');
    if (blank && !words.back().empty()) words.emplace_back();
    if (blank) continue;
    words.back() += c;
    if (open != 0)
      open = c == open ? '\0' : open;
    else
      open = c == '\'' || c == '"' ? c : c == '[' ? ']' : '\0';
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

std::vector<std::string_view> model_controllers(const BuildState& b) {
  return b.options.model_controllers != nullptr ? b.options.model_controllers() : std::vector<std::string_view>();
}

/// Returns why a robot's `ctrl` cannot choose this controller; empty: it can.
std::string fault_of(const BuildState& b, const std::string& name) {
  std::vector<std::string_view> known{"wander"};
  if (b.options.controllers != nullptr) known = b.options.controllers();
  known.emplace_back("none");
  if (base::names_a_plugin(name) || std::find(known.begin(), known.end(), name) != known.end()) return {};
  if (std::find(kStagePlugins.begin(), kStagePlugins.end(), name) != kStagePlugins.end())
    return fmt::format(
        "ctrl \"{}\" names a plug-in of Stage, which is not run; choose a controller with --controller NAME, or write "
        "ctrl \"wander\"",
        name);
  return fmt::format(
      "ctrl \"{}\" is ignored: there is no controller of this name{}, or a file (./libmine.so, mine.py:MyClass)", name,
      base::expected_one_of(name, known));
}

/// Returns the controller and its settings; empty without `ctrl`.
std::vector<std::string> words_of_ctrl(const Entity& entity) {
  const Property* property = find(entity, "ctrl");
  if (property == nullptr || property->values.empty()) return {};
  return setting_words(property->values.front().text);
}

}  // namespace

void read_dynamics(BuildState& b, const Entity& entity, Mover& mover) {
  const Property* property = find(entity, "dynamics");
  if (property == nullptr) return;
  const auto refuse = [&](const std::string& why) { fail(b.context, property->at, why); };
  const std::vector<std::string> words = setting_words(property->values.front().text);
  if (mover.is_tag) refuse(fmt::format("'{}' is not a robot; expected 'dynamics' in a robot", mover.name));
  if (property->values.size() > 1 || words.empty() || (words[0] != "car" && !base::names_a_plugin(words[0])))
    refuse("'dynamics' expects one text: \"car\" or a plug-in's file (./libmine.so), and settings KEY=VALUE");
  if (mover.actuator_model == ActuatorModel::player_create)
    refuse(
        fmt::format("'{}' has command_law \"player_create\", which halves its commands to at most 0.5 m/s as the "
                    "driver of a Create; leave it or 'dynamics' out",
                    mover.name));
  const std::string& file = b.context.document.files[property->at.file];
  mover.dynamics = {words[0] == "car" ? "car" : (std::filesystem::path(file).parent_path() / words[0]).string(),
                    {},
                    fmt::format("{}:{}: ", file, property->at.line)};
  for (auto word = words.begin() + 1; word != words.end(); ++word) {
    const std::size_t equals = word->find('=');
    const std::string key = word->substr(0, equals);
    if (equals == std::string::npos || key.empty())
      refuse(fmt::format("'{}' in 'dynamics': expected a setting KEY=VALUE", *word));
    for (const auto& setting : mover.dynamics.settings)
      if (setting.first == key) refuse(fmt::format("'dynamics' gives '{}' twice", key));
    mover.dynamics.settings.emplace_back(key, word->substr(equals + 1));
  }
}

bool names_model_controller(const BuildState& b, const Entity& entity) {
  const std::vector<std::string> words = words_of_ctrl(entity);
  if (words.empty()) return false;
  const std::vector<std::string_view> known = model_controllers(b);
  return base::names_a_plugin(words.front()) || std::ranges::find(known, words.front()) != known.end();
}

void warn_of_ctrl(BuildState& b, const Entity& entity, const std::string& model) {
  const std::vector<std::string> words = words_of_ctrl(entity);
  if (words.empty() || words.front() == "none") return;
  warn(
      b.context, location_of(entity, "ctrl"),
      fmt::format("ctrl \"{}\" of '{}' is ignored: it is not a robot; expected ctrl inside a robot's parentheses, or a "
                  "model controller: in a file (./libmine.so, mine.py:MyClass), or the name of a loaded one{}",
                  words.front(), model, base::suggest(words.front(), model_controllers(b))));
}

void read_ctrl(BuildState& b, const Entity& entity, Mover& mover) {
  const Property* property = find(entity, "ctrl");
  const std::vector<std::string> words = words_of_ctrl(entity);
  if (words.empty()) {
    if (property != nullptr)
      warn(b.context, property->at,
           "'ctrl' names no controller and is ignored; write ctrl \"none\" for a robot that stays at rest");
    return;
  }
  if (mover.is_tag && !names_model_controller(b, entity)) return warn_of_ctrl(b, entity, mover.name);
  if (property->values.size() > 1)
    warn(b.context, property->at, "'ctrl' expects one controller per model; only the first is used");
  const std::string& name = words.front();
  if (const std::string fault = mover.is_tag ? "" : fault_of(b, name); !fault.empty()) {
    if (b.warned_types.insert("ctrl " + name).second) warn(b.context, property->at, fault);
    return;
  }
  const std::string& file = b.context.document.files[property->at.file];
  mover.controller = base::names_a_plugin(name) ? (std::filesystem::path(file).parent_path() / name).string() : name;
  mover.controller_at = fmt::format("{}:{}: ", file, property->at.line);
  for (auto word = words.begin() + 1; word != words.end(); ++word) {
    const std::size_t equals = word->find('=');
    const std::string key = word->substr(0, equals);
    const bool repeated = std::any_of(mover.controller_settings.begin(), mover.controller_settings.end(),
                                      [&](const auto& setting) { return setting.first == key; });
    if (equals == std::string::npos || key.empty() || repeated)
      warn(b.context, property->at,
           fmt::format("'{}' in ctrl \"{}\" is ignored: {}", *word, name,
                       repeated ? "the setting is given twice" : "expected a setting KEY=VALUE"));
    else
      mover.controller_settings.emplace_back(key, word->substr(equals + 1));
  }
}

}  // namespace sf::world
