#ifndef ROBOTS_DEVICE_OBSERVER_RECORDS_H
#define ROBOTS_DEVICE_OBSERVER_RECORDS_H
// Records of observations on the device, shared by host and device (robots/device/device_observer.h).

#ifdef __cplusplus

#include <cstdint>

namespace sf::robots {

struct ObserveTick {
  std::uint32_t agents, sensors;  ///< number, and sensors of each
  std::uint32_t beams, elements;  ///< of a sensor: in its table, and observed
  std::uint32_t every, columns;   ///< step between observed beams, and columns of one observation
  std::uint32_t speeds, again;    ///< 1: speeds are observed; 1: nothing has moved since the last observation
  double reach;                   ///< [m] > 0: goals are observed
  std::uint32_t stack, spare;     ///< observations that a row has
};

struct ObservedAgent {
  double forward, turn;  ///< largest speeds
  std::uint32_t mover, spare_0, spare_1, spare_2;
};

struct ObservedSensor {
  double limit, spare;  ///< [m] > 0
};

/// A goal [m]; NaN: none.
struct ObservedGoal {
  double x, y;
};

/// An agent's goal, and its distance from it.
struct ObservedMeasure {
  double x, y;                ///< the goal
  double distance, progress;  ///< [m] NaN without a goal, and 0
};

}  // namespace sf::robots

#endif
#endif
