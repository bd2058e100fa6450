#pragma once
// Components of SPaT messages, in the order and with the names of SAE J2735.

#include "v2x/spat.h"

namespace sf::v2x {

inline constexpr std::array<std::string_view, 10> kPhaseStates{"unavailable",
                                                               "dark",
                                                               "stop-Then-Proceed",
                                                               "stop-And-Remain",
                                                               "pre-Movement",
                                                               "permissive-Movement-Allowed",
                                                               "protected-Movement-Allowed",
                                                               "permissive-clearance",
                                                               "protected-clearance",
                                                               "caution-Conflicting-Traffic"};
inline constexpr std::array<std::string_view, 4> kAdvisorySpeedTypes{"none", "greenwave", "ecoDrive", "transit"};
inline constexpr std::array<std::string_view, 8> kSpeedConfidences{
    "unavailable", "prec100ms", "prec10ms", "prec5ms", "prec1ms", "prec0-1ms", "prec0-05ms", "prec0-01ms"};
inline constexpr Whole kTimeMark{0, 36'111};
inline constexpr Whole kZoneLength{0, 10'000};
inline constexpr ListOf<> kManeuverAssistList{"ConnectionManeuverAssist", 1, 16};

template <Is<TimeChangeDetails> T, class F>
void fields(T& v, F&& f) {
  f.optional("startTime", v.start, kTimeMark);
  f("minEndTime", v.min_end, kTimeMark);
  f.optional("maxEndTime", v.max_end, kTimeMark);
  f.optional("likelyTime", v.likely, kTimeMark);
  f.optional("confidence", v.confidence, Whole{0, 15});
  f.optional("nextTime", v.next, kTimeMark);
}

template <Is<AdvisorySpeed> T, class F>
void fields(T& v, F&& f) {
  f("type", v.type, Named{kAdvisorySpeedTypes});
  f.optional("speed", v.speed, Whole{0, 500});
  f.optional("confidence", v.confidence, Named{kSpeedConfidences, false});
  f.optional("distance", v.distance, kZoneLength);
  f.optional("class", v.restriction, kByte);
  f.optional("regional", v.regional, regional("Reg-AdvisorySpeed"));
}

template <Is<MovementEvent> T, class F>
void fields(T& v, F&& f) {
  f("eventState", v.state, Named{kPhaseStates, false});
  f.optional("timing", v.timing, Described{});
  f.optional("speeds", v.speeds, ListOf<>{"AdvisorySpeed", 1, 16});
  f.optional("regional", v.regional, regional("Reg-MovementEvent"));
}

template <Is<ManeuverAssist> T, class F>
void fields(T& v, F&& f) {
  f("connectionID", v.connection, kByte);
  f.optional("queueLength", v.queue_length, kZoneLength);
  f.optional("availableStorageLength", v.available_storage, kZoneLength);
  f.optional("waitOnStop", v.wait_on_stop, Flag{});
  f.optional("pedBicycleDetect", v.pedestrian_or_bicycle, Flag{});
  f.optional("regional", v.regional, regional("Reg-ConnectionManeuverAssist"));
}

template <Is<MovementState> T, class F>
void fields(T& v, F&& f) {
  f.optional("movementName", v.name, kName);
  f("signalGroup", v.signal_group, kByte);
  f("state-time-speed", v.events, ListOf<>{"MovementEvent", 1, 16});
  f.optional("maneuverAssistList", v.assist, kManeuverAssistList);
  f.optional("regional", v.regional, regional("Reg-MovementState"));
}

template <Is<IntersectionState> T, class F>
void fields(T& v, F&& f) {
  f.optional("name", v.name, kName);
  f("id", v.id, Described{});
  f("revision", v.revision, kRevision);
  f("status", v.status, BitString{16});
  f.optional("moy", v.minute, kMinuteOfYear);
  f.optional("timeStamp", v.milliseconds, kMilliseconds);
  f.optional("enabledLanes", v.enabled_lanes, lanes(16));
  f("states", v.states, ListOf<>{"MovementState", 1, 255});
  f.optional("maneuverAssistList", v.assist, kManeuverAssistList);
  f.optional("regional", v.regional, regional("Reg-IntersectionState"));
}

template <Is<Spat> T, class F>
void fields(T& v, F&& f) {
  f.optional("timeStamp", v.minute, kMinuteOfYear);
  f.optional("name", v.name, kName);
  f("intersections", v.intersections, ListOf<>{"IntersectionState", 1, 32});
  f.optional("regional", v.regional, regional("Reg-SPAT"));
}

}  // namespace sf::v2x
