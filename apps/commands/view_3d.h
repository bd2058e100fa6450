#pragma once
// `view --3d`: shows a recording in VTK's window.

#include "apps/options/options.h"

namespace sf::apps {

int view_3d(const ViewOptions& options);

}  // namespace sf::apps
