#pragma once
// Range finders of both dialects as `Laser`s: `laser( ... )`, `ranger( sensor( ... ) ... )`, `ranger( scount n spose[i]
// ... )`.

#include <string>
#include <vector>

#include "world/stage/properties.h"

namespace sf::world {

/// The lasers of one `laser` or `ranger` model, in file order.
/// @param X_MB the model's body frame (its origin included) in the mover's frame.
/// @param height of the model [m]: a 3.x laser is at half of it, a transducer at half of its own height.
/// @param name of the model without its mover's; the k-th of several transducers is `name[k]`.
/// @throws base::InputError for settings out of range.
std::vector<Laser> lasers_of(StageContext& context, const LoadOptions& options, const Entity& entity, const Pose& X_MB,
                             double height, const std::string& name);

}  // namespace sf::world
