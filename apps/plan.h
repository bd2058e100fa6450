#pragma once
// Who drives, as the command line says it.

#include <string>

#include "apps/options.h"
#include "control/controllers.h"

namespace sf::apps {

/// "key=value" as a setting, whose type is what it is read as.
control::Setting setting_of(const std::string& text);

/// `--controller` with its `--set`s.
control::Plan plan_of(const Options& options);

}  // namespace sf::apps
