#pragma once
// The rule by which all modules count contacts: a contact begins at a tick in which something stops a mover that
// nothing stopped in the tick before.

namespace sf::base {

/// State of one mover, tick by tick.
struct ContactOnset {
  bool previous = false;

  /// @param now whether something stops the mover in this tick
  /// @return whether a contact begins in this tick
  bool begins(bool now) {
    const bool began = now && !previous;
    previous = now;
    return began;
  }
};

}  // namespace sf::base
