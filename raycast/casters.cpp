#include "raycast/casters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "base/error.h"
#include "base/suggest.h"

namespace sf::raycast {

namespace {

constexpr std::string_view kAutomatic = "auto";

#define SF_ADDRESS(name) &name,
constexpr const CasterType* kCasters[] = {SF_CASTERS(SF_ADDRESS)};
#undef SF_ADDRESS

}  // namespace

std::span<const CasterType* const> casters() { return kCasters; }

std::vector<std::string> caster_words() {
  std::vector<std::string> words{std::string(kAutomatic)};
  for (const CasterType* type : kCasters) words.emplace_back(type->name);
  return words;
}

const CasterType* caster_named(std::string_view word, std::string_view where) {
  if (word == kAutomatic) return nullptr;
  for (const CasterType* type : kCasters)
    if (type->name == word) return type;
  const std::vector<std::string> words = caster_words();
  const std::vector<std::string_view> known(words.begin(), words.end());
  throw base::InputError(fmt::format("{}there is no caster '{}'{}", where, word, base::expected_one_of(word, known)));
}

const CasterType& choose_caster(bool software, const CasterType* asked) {
  if (asked != nullptr) return *asked;
  const char* const set = std::getenv("SENSORFARM_CASTER");
  if (set != nullptr && *set != '\0') asked = caster_named(set, "SENSORFARM_CASTER: ");
  if (asked != nullptr) return *asked;
  return software ? host_caster : device_caster;
}

std::string describe_caster(bool software, const CasterType* asked) {
  return choose_caster(software, asked).describe();
}

}  // namespace sf::raycast
