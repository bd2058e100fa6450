#include "apps/options/robot_names.h"

#include <algorithm>

namespace sf::apps {

std::vector<std::string> robot_names(const std::vector<std::string>& texts, std::span<const std::string_view> known) {
  std::vector<std::string> names;
  for (const std::string_view text : texts)
    for (std::size_t from = 0; from <= text.size();) {
      const std::string_view rest = text.substr(from);
      std::size_t length = std::min(rest.find(','), rest.size());
      for (const std::string_view name : known)
        if (name.size() > length && rest.starts_with(name) && (name.size() == rest.size() || rest[name.size()] == ','))
          length = name.size();
      names.emplace_back(rest.substr(0, length));
      from += length + 1;
    }
  return names;
}

}  // namespace sf::apps
