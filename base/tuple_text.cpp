#include "base/tuple_text.h"

#include <algorithm>
#include <limits>

namespace sf::base {

std::size_t numbers_in(std::string_view description) {
  constexpr std::size_t kAny = std::numeric_limits<std::size_t>::max();
  std::size_t most = 0;
  for (std::size_t at = description.find('['); at != std::string_view::npos; at = description.find('[', at + 1)) {
    const std::string_view names = description.substr(at, description.find(']', at) - at);
    if (names.ends_with("...")) return kAny;
    most = std::max(most, 1 + static_cast<std::size_t>(std::ranges::count(names, ' ')));
  }
  return most > 0 ? most : kAny;
}

}  // namespace sf::base
