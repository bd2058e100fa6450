#include "library/errors.h"

#include <array>
#include <string_view>
#include <utility>

namespace sf::library {

namespace {

// Longer words precede shorter ones.
constexpr auto kWords = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"--stage-noise or the world key", "the world key"},
    {"--stage-obstacles or the world key", "the world key"},
    {"--controller NAME", "controller"},
    {"--device host", "device=\"host\""},
    {"--caster vulkan", "caster=\"vulkan\""},
    {"--caster host", "caster=\"host\""},
    {"--robots N", "robots=N"},
    {"--require-vulkan", "require_vulkan"},
    {"--record-readings", "record_readings"},
    {"--robot-from", "robot_from"},
    {"--compression", "compression"},
    {"--controller", "controller"},
    {"--accuracy", "accuracy"},
    {"--threads", "threads"},
    {"--device", "device"},
    {"--caster", "caster"},
    {"--record", "record"},
    {"--robots", "robots"},
    {"--seed", "seed"},
    {"--set", "settings"},
    {"--of", "of"},
});

bool continues(const std::string& text, std::size_t at) {
  return at < text.size() && (text[at] == '-' || (text[at] >= 'a' && text[at] <= 'z'));
}

}  // namespace

std::string in_own_words(std::string message) {
  for (const auto& [option, own] : kWords)
    for (std::size_t at = 0; (at = message.find(option, at)) != std::string::npos;) {
      const bool whole = !continues(message, at + option.size()) && (at == 0 || message[at - 1] != '-');
      if (whole) message.replace(at, option.size(), own);
      at += whole ? own.size() : option.size();
    }
  return message;
}

}  // namespace sf::library
