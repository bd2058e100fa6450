#pragma once
// Components of MAP messages, in the order and with the names of SAE J2735.

#include "v2x/map_data.h"

namespace sf::v2x {

inline constexpr std::array<std::string_view, 13> kSpeedLimitTypes{"unknown",
                                                                   "maxSpeedInSchoolZone",
                                                                   "maxSpeedInSchoolZoneWhenChildrenArePresent",
                                                                   "maxSpeedInConstructionZone",
                                                                   "vehicleMinSpeed",
                                                                   "vehicleMaxSpeed",
                                                                   "vehicleNightMaxSpeed",
                                                                   "truckMinSpeed",
                                                                   "truckMaxSpeed",
                                                                   "truckNightMaxSpeed",
                                                                   "vehiclesWithTrailersMinSpeed",
                                                                   "vehiclesWithTrailersMaxSpeed",
                                                                   "vehiclesWithTrailersNightMaxSpeed"};
inline constexpr std::array<std::string_view, 12> kNodeAttributes{
    "reserved",        "stopLine",     "roundedCapStyleA",     "roundedCapStyleB",
    "mergePoint",      "divergePoint", "downstreamStopLine",   "downstreamStartNode",
    "closedToTraffic", "safeIsland",   "curbPresentAtStepOff", "hydrantPresent"};
inline constexpr std::array<std::string_view, 38> kSegmentAttributes{"reserved",
                                                                     "doNotBlock",
                                                                     "whiteLine",
                                                                     "mergingLaneLeft",
                                                                     "mergingLaneRight",
                                                                     "curbOnLeft",
                                                                     "curbOnRight",
                                                                     "loadingzoneOnLeft",
                                                                     "loadingzoneOnRight",
                                                                     "turnOutPointOnLeft",
                                                                     "turnOutPointOnRight",
                                                                     "adjacentParkingOnLeft",
                                                                     "adjacentParkingOnRight",
                                                                     "adjacentBikeLaneOnLeft",
                                                                     "adjacentBikeLaneOnRight",
                                                                     "sharedBikeLane",
                                                                     "bikeBoxInFront",
                                                                     "transitStopOnLeft",
                                                                     "transitStopOnRight",
                                                                     "transitStopInLane",
                                                                     "sharedWithTrackedVehicle",
                                                                     "safeIsland",
                                                                     "lowCurbsPresent",
                                                                     "rumbleStripPresent",
                                                                     "audibleSignalingPresent",
                                                                     "adaptiveTimingPresent",
                                                                     "rfSignalRequestPresent",
                                                                     "partialCurbIntrusion",
                                                                     "taperToLeft",
                                                                     "taperToRight",
                                                                     "taperToCenterLine",
                                                                     "parallelParking",
                                                                     "headInParking",
                                                                     "freeParking",
                                                                     "timeRestrictionsOnParking",
                                                                     "costToPark",
                                                                     "midBlockCurbPresent",
                                                                     "unEvenPavementPresent"};
inline constexpr std::array<std::string_view, 14> kRestrictionUsers{"none",
                                                                    "equippedTransit",
                                                                    "equippedTaxis",
                                                                    "equippedOther",
                                                                    "emissionCompliant",
                                                                    "equippedBicycle",
                                                                    "weightCompliant",
                                                                    "heightCompliant",
                                                                    "pedestrians",
                                                                    "slowMovingPersons",
                                                                    "wheelchairUsers",
                                                                    "visualDisabilities",
                                                                    "audioDisabilities",
                                                                    "otherUnknownDisabilities"};
inline constexpr std::array<std::string_view, 8> kLayers{
    "none",      "mixedContent",       "generalMapData",  "intersectionData",
    "curveData", "roadwaySectionData", "parkingAreaData", "sharedLaneData"};

inline constexpr Whole kAngle{0, 28'800};
inline constexpr Whole kScale{-2048, 2047};
inline constexpr Whole kWidth{0, 32'767};
inline constexpr Whole kNodeChange{-512, 511};
inline constexpr BitString kManeuvers{12};
inline constexpr ListOf<> kSpeedLimitList{"RegulatorySpeedLimit", 1, 9};
inline constexpr ListOf<> kLaneList{"GenericLane", 1, 255};
inline constexpr ListOf<Named> kSegmentAttributeList{"", 1, 8, {kSegmentAttributes}};

template <Is<SpeedLimit> T, class F>
void fields(T& v, F&& f) {
  f("type", v.type, Named{kSpeedLimitTypes});
  f("speed", v.speed, Whole{0, 8191});
}

template <Is<Position> T, class F>
void fields(T& v, F&& f) {
  f("lat", v.latitude, kLatitude);
  f("long", v.longitude, kLongitude);
  f.optional("elevation", v.elevation, Whole{-4096, 61'439});
  f.optional("regional", v.regional, regional("Reg-Position3D"));
}

/// Offsets with the bounds of their alternative.
template <class Offsets>
struct Bounded {
  Offsets& offsets;
  Whole bounds;
};
template <class Offsets, class F>
void fields(const Bounded<Offsets>& v, F&& f) {
  f("x", v.offsets.x, v.bounds);
  f("y", v.offsets.y, v.bounds);
}

template <Is<NodeOffset::LonLat> T, class F>
void fields(T& v, F&& f) {
  f("lon", v.longitude, kLongitude);
  f("lat", v.latitude, kLatitude);
}

template <Is<NodeOffset> T, class F>
void alternative(T& v, F&& f) {
  constexpr std::array<std::int64_t, 6> kReach{512, 1024, 2048, 4096, 8192, 32'768};
  if (v.choice <= NodeOffset::xy6) {
    auto& xy = v.xy;
    Bounded<std::remove_reference_t<decltype(xy)>> bounded{xy, Whole{-kReach[v.choice], kReach[v.choice] - 1}};
    f(bounded, Described{});
  } else if (v.choice == NodeOffset::position) {
    f(v.lon_lat, Described{});
  } else {
    f(v.regional, Described{});
  }
}

template <Is<LaneDataAttribute> T, class F>
void alternative(T& v, F&& f) {
  constexpr std::array<Whole, 5> kAngles{Whole{-150, 150}, {-128, 127}, {-128, 127}, {-128, 127}, {-180, 180}};
  if (v.choice <= LaneDataAttribute::lane_angle) {
    f(v.angle, kAngles[v.choice]);
  } else if (v.choice == LaneDataAttribute::speed_limits) {
    f(v.limits, kSpeedLimitList);
  } else {
    f(v.regional, regional("Reg-LaneDataAttribute"));
  }
}

template <Is<NodeAttributes> T, class F>
void fields(T& v, F&& f) {
  f.optional("localNode", v.local, ListOf<Named>{"", 1, 8, {kNodeAttributes}});
  f.optional("disabled", v.disabled, kSegmentAttributeList);
  f.optional("enabled", v.enabled, kSegmentAttributeList);
  f.optional("data", v.data, ListOf<>{"LaneDataAttribute", 1, 8});
  f.optional("dWidth", v.width, kNodeChange);
  f.optional("dElevation", v.elevation, kNodeChange);
  f.optional("regional", v.regional, regional("Reg-NodeAttributeSetXY"));
}

template <Is<Node> T, class F>
void fields(T& v, F&& f) {
  f("delta", v.delta, Described{});
  f.optional("attributes", v.attributes, Described{});
}

template <Is<LaneOffset> T, class F>
void alternative(T& v, F&& f) {
  f(v.offset, v.choice == LaneOffset::small ? Whole{-2047, 2047} : Whole{-32'767, 32'767});
}

template <Is<ComputedLane> T, class F>
void fields(T& v, F&& f) {
  f("referenceLaneId", v.reference_lane, kByte);
  f("offsetXaxis", v.x, Described{});
  f("offsetYaxis", v.y, Described{});
  f.optional("rotateXY", v.rotation, kAngle);
  f.optional("scaleXaxis", v.scale_x, kScale);
  f.optional("scaleYaxis", v.scale_y, kScale);
  f.optional("regional", v.regional, regional("Reg-ComputedLane"));
}

template <Is<NodeList> T, class F>
void alternative(T& v, F&& f) {
  if (v.choice == NodeList::listed) {
    f(v.nodes, ListOf<>{"NodeXY", 2, 63});
  } else {
    f(v.computed, Described{});
  }
}

template <Is<LaneType> T, class F>
void alternative(T& v, F&& f) {
  if (v.choice == LaneType::vehicle) {
    f(v.vehicle_bits, BitString{ExtensibleBits::kSize});
  } else {
    f(v.bits, BitString{16});
  }
}

template <Is<LaneAttributes> T, class F>
void fields(T& v, F&& f) {
  f("directionalUse", v.direction, BitString{2});
  f("sharedWith", v.shared_with, BitString{10});
  f("laneType", v.type, Described{});
  f.optional("regional", v.regional, Described{});
}

template <Is<Connection::ConnectingLane> T, class F>
void fields(T& v, F&& f) {
  f("lane", v.lane, kByte);
  f.optional("maneuver", v.maneuver, kManeuvers);
}

template <Is<Connection> T, class F>
void fields(T& v, F&& f) {
  f("connectingLane", v.to, Described{});
  f.optional("remoteIntersection", v.remote, Described{});
  f.optional("signalGroup", v.signal_group, kByte);
  f.optional("userClass", v.user_class, kByte);
  f.optional("connectionID", v.id, kByte);
}

template <Is<GenericLane> T, class F>
void fields(T& v, F&& f) {
  f("laneID", v.id, kByte);
  f.optional("name", v.name, kName);
  f.optional("ingressApproach", v.ingress_approach, Whole{0, 15});
  f.optional("egressApproach", v.egress_approach, Whole{0, 15});
  f("laneAttributes", v.attributes, Described{});
  f.optional("maneuvers", v.maneuvers, kManeuvers);
  f("nodeList", v.nodes, Described{});
  f.optional("connectsTo", v.connections, ListOf<>{"Connection", 1, 16});
  f.optional("overlays", v.overlays, lanes(5));
  f.optional("regional", v.regional, regional("Reg-GenericLane"));
}

template <Is<SignalControlZone> T, class F>
void fields(T& v, F&& f) {
  f("zone", v.zone, Described{});
}

/// Components at the start of intersections and road segments.
template <class T, class F>
void place_fields(T& v, F& f) {
  f.optional("name", v.name, kName);
  f("id", v.id, Described{});
  f("revision", v.revision, kRevision);
  f("refPoint", v.reference, Described{});
  f.optional("laneWidth", v.lane_width, kWidth);
  f.optional("speedLimits", v.speed_limits, kSpeedLimitList);
}

template <Is<IntersectionGeometry> T, class F>
void fields(T& v, F&& f) {
  place_fields(v, f);
  f("laneSet", v.lanes, kLaneList);
  f.optional("preemptPriorityData", v.zones, ListOf<>{"SignalControlZone", 1, 32});
  f.optional("regional", v.regional, regional("Reg-IntersectionGeometry"));
}

template <Is<RoadSegment> T, class F>
void fields(T& v, F&& f) {
  place_fields(v, f);
  f("roadLaneSet", v.lanes, kLaneList);
  f.optional("regional", v.regional, regional("Reg-RoadSegment"));
}

template <Is<DataParameters> T, class F>
void fields(T& v, F&& f) {
  f.optional("processMethod", v.method, Text{255});
  f.optional("processAgency", v.agency, Text{255});
  f.optional("lastCheckedDate", v.last_checked, Text{255});
  f.optional("geoidUsed", v.geoid, Text{255});
}

template <Is<RestrictionUser> T, class F>
void alternative(T& v, F&& f) {
  if (v.choice == RestrictionUser::basic) {
    f(v.type, Named{kRestrictionUsers});
  } else {
    f(v.regional, regional("Reg-RestrictionUserType"));
  }
}

template <Is<RestrictionClass> T, class F>
void fields(T& v, F&& f) {
  f("id", v.id, kByte);
  f("users", v.users, ListOf<>{"RestrictionUserType", 1, 16});
}

template <Is<MapData> T, class F>
void fields(T& v, F&& f) {
  f.optional("timeStamp", v.minute, kMinuteOfYear);
  f("msgIssueRevision", v.revision, kRevision);
  f.optional("layerType", v.layer, Named{kLayers});
  f.optional("layerID", v.layer_id, Whole{0, 100});
  f.optional("intersections", v.intersections, ListOf<>{"IntersectionGeometry", 1, 32});
  f.optional("roadSegments", v.roads, ListOf<>{"RoadSegment", 1, 32});
  f.optional("dataParameters", v.parameters, Described{});
  f.optional("restrictionList", v.restrictions, ListOf<>{"RestrictionClassAssignment", 1, 254});
  f.optional("regional", v.regional, regional("Reg-MapData"));
}

}  // namespace sf::v2x
