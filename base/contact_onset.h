#pragma once
// How contacts are counted, everywhere: one begins when something stops a mover that nothing stopped the tick before.

namespace sf::base {

/// Follows one mover, tick by tick.
struct ContactOnset {
  bool previous = false;

  /// @return whether a contact begins now.
  bool begins(bool now) {
    const bool began = now && !previous;
    previous = now;
    return began;
  }
};

}  // namespace sf::base
