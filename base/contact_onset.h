#pragma once
// The rule by which all modules count contacts: a contact begins in a tick when a mover is blocked that was not blocked
// in the previous tick.

namespace sf::base {

/// Contact state of one mover, updated every tick.
struct ContactOnset {
  bool previous = false;

  /// @param now true when the mover is blocked in this tick
  /// @return true when a contact begins in this tick
  bool begins(bool now) {
    const bool began = now && !previous;
    previous = now;
    return began;
  }
};

}  // namespace sf::base
