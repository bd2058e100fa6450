#pragma once
// `serve --lockstep`: the farm moves the robots, and other processes command them tick by tick.

#include "apps/options/options.h"

namespace sf::apps {

/// @return the exit code: 1 if a process timed out or the recording is incomplete
int serve_lockstep(const ServeOptions& options);

}  // namespace sf::apps
