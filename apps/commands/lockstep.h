#pragma once
// `serve --lockstep`: the farm moves the robots, and processes elsewhere command them tick by tick.

#include "apps/options/options.h"

namespace sf::apps {

/// @return the exit code: 1 where a process timed out, or the recording is not whole
int serve_lockstep(const ServeOptions& options);

}  // namespace sf::apps
