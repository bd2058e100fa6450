#pragma once
// MAP: the lanes of intersections and road segments, and the signal groups that control their connections.

#include "v2x/common.h"

namespace sf::v2x {

struct SpeedLimit {
  std::uint8_t type = 0;    ///< row of kSpeedLimitTypes
  std::uint16_t speed = 0;  ///< [0.02 m/s] in [0, 8191]; 8191: unavailable
  bool operator==(const SpeedLimit&) const = default;
};

struct Position {
  std::int32_t latitude = kUnknownLatitude;    ///< [1e-7 degrees]
  std::int32_t longitude = kUnknownLongitude;  ///< [1e-7 degrees]
  std::optional<std::int32_t> elevation;       ///< [0.1 m] in [-4096, 61439] above WGS84; -4096: unknown
  Regional regional;
  Additions additions;
  bool operator==(const Position&) const = default;
};

/// A point of a lane, relative to the previous point; the first point is relative to the reference point.
struct NodeOffset {
  /// Offsets of 10, 11, 12, 13, 14 and 16 bits, a position, or an extension.
  enum Alternative : std::uint8_t { xy1, xy2, xy3, xy4, xy5, xy6, position, regional_offset };
  static constexpr std::array<std::string_view, 8> kAlternatives{"node-XY1", "node-XY2", "node-XY3",    "node-XY4",
                                                                 "node-XY5", "node-XY6", "node-LatLon", "regional"};
  struct Xy {
    std::int32_t x = 0;  ///< [cm] east
    std::int32_t y = 0;  ///< [cm] north
    bool operator==(const Xy&) const = default;
  };
  struct LonLat {
    std::int32_t longitude = 0;  ///< [1e-7 degrees], absolute
    std::int32_t latitude = 0;
    bool operator==(const LonLat&) const = default;
  };
  Alternative choice = xy6;
  Xy xy;
  LonLat lon_lat;
  RegionalExtension regional;
  bool operator==(const NodeOffset&) const = default;
};

struct LaneDataAttribute {
  enum Alternative : std::uint8_t {
    path_end_point_angle,  ///< [degrees] in [-150, 150]
    crown_center,          ///< [0.3 degrees] in [-128, 127]
    crown_left,
    crown_right,
    lane_angle,  ///< [1.5 degrees] in [-180, 180]
    speed_limits,
    regional_data
  };
  static constexpr std::array<std::string_view, 7> kAlternatives{"pathEndPointAngle",
                                                                 "laneCrownPointCenter",
                                                                 "laneCrownPointLeft",
                                                                 "laneCrownPointRight",
                                                                 "laneAngle",
                                                                 "speedLimits",
                                                                 "regional"};
  Alternative choice = path_end_point_angle;
  std::int16_t angle = 0;          ///< of the first five alternatives
  std::vector<SpeedLimit> limits;  ///< 1 to 9
  Regional regional;
  base::Bytes unknown;
  bool operator==(const LaneDataAttribute&) const = default;
};

/// Attributes of a node, and of the lane from that node on.
struct NodeAttributes {
  std::vector<std::uint8_t> local;     ///< of this node: rows of kNodeAttributes; at most 8, also in the next two lists
  std::vector<std::uint8_t> disabled;  ///< ending at this node: rows of kSegmentAttributes
  std::vector<std::uint8_t> enabled;   ///< starting at this node
  std::vector<LaneDataAttribute> data;    ///< at most 8
  std::optional<std::int16_t> width;      ///< [cm] added to the lane's width, in [-512, 511]
  std::optional<std::int16_t> elevation;  ///< [10 cm] added to the elevation of the previous node, in [-512, 511]
  Regional regional;
  Additions additions;
  bool operator==(const NodeAttributes&) const = default;
};

struct Node {
  NodeOffset delta;
  std::optional<NodeAttributes> attributes;
  Additions additions;
  bool operator==(const Node&) const = default;
};

struct LaneOffset {
  enum Alternative : std::uint8_t { small, large };
  static constexpr std::array<std::string_view, 2> kAlternatives{"small", "large"};
  Alternative choice = small;
  std::int16_t offset = 0;  ///< [cm] in [-2047, 2047]; large: [-32767, 32767]
  bool operator==(const LaneOffset&) const = default;
};

/// A lane defined as a copy of another one.
struct ComputedLane {
  std::uint8_t reference_lane = 0;
  LaneOffset x, y;
  std::optional<std::uint16_t> rotation;  ///< [0.0125 degrees] in [0, 28800]; 28800: unavailable
  std::optional<std::int16_t> scale_x;    ///< [0.05 %] in addition to 100 %, in [-2048, 2047]
  std::optional<std::int16_t> scale_y;
  Regional regional;
  Additions additions;
  bool operator==(const ComputedLane&) const = default;
};

struct NodeList {
  enum Alternative : std::uint8_t { listed, computed_lane };
  static constexpr std::array<std::string_view, 2> kAlternatives{"nodes", "computed"};
  Alternative choice = listed;
  std::vector<Node> nodes;  ///< 2 to 63; the first node of an ingress lane is at the stop line
  ComputedLane computed;
  base::Bytes unknown;
  bool operator==(const NodeList&) const = default;
};

struct LaneType {
  enum Alternative : std::uint8_t { vehicle, crosswalk, bike, sidewalk, median, striping, tracked_vehicle, parking };
  static constexpr std::array<std::string_view, 8> kAlternatives{"vehicle", "crosswalk", "bikeLane",       "sidewalk",
                                                                 "median",  "striping",  "trackedVehicle", "parking"};
  Alternative choice = vehicle;
  ExtensibleBits vehicle_bits;
  std::uint16_t bits = 0;  ///< of all other types
  base::Bytes unknown;
  bool operator==(const LaneType&) const = default;
};

struct LaneAttributes {
  std::uint8_t direction = 0;     ///< 2 bits: 2 ingress, 1 egress
  std::uint16_t shared_with = 0;  ///< 10 bits
  LaneType type;
  std::optional<RegionalExtension> regional;
  bool operator==(const LaneAttributes&) const = default;
};

/// A connection from a lane to another, which may be part of another intersection.
struct Connection {
  struct ConnectingLane {
    std::uint8_t lane = 0;
    std::optional<std::uint16_t> maneuver;  ///< 12 bits
    bool operator==(const ConnectingLane&) const = default;
  };
  ConnectingLane to;
  std::optional<IntersectionReference> remote;
  std::optional<std::uint8_t> signal_group;
  std::optional<std::uint8_t> user_class;
  std::optional<std::uint8_t> id;
  bool operator==(const Connection&) const = default;
};

struct GenericLane {
  std::uint8_t id = 0;
  std::string name;
  std::optional<std::uint8_t> ingress_approach;  ///< in [0, 15]
  std::optional<std::uint8_t> egress_approach;
  LaneAttributes attributes;
  std::optional<std::uint16_t> maneuvers;  ///< 12 bits
  NodeList nodes;
  std::vector<Connection> connections;  ///< at most 16
  std::vector<std::uint8_t> overlays;   ///< lanes, at most 5
  Regional regional;
  Additions additions;
  bool operator==(const GenericLane&) const = default;
};

/// Contains only an extension.
struct SignalControlZone {
  RegionalExtension zone;
  Additions additions;
  bool operator==(const SignalControlZone&) const = default;
};

struct IntersectionGeometry {
  std::string name;
  IntersectionReference id;
  std::uint8_t revision = 0;
  Position reference;
  std::optional<std::uint16_t> lane_width;  ///< [cm] in [0, 32767]
  std::vector<SpeedLimit> speed_limits;     ///< at most 9
  std::vector<GenericLane> lanes;           ///< 1 to 255
  std::vector<SignalControlZone> zones;     ///< at most 32
  Regional regional;
  Additions additions;
  bool operator==(const IntersectionGeometry&) const = default;
};

struct RoadSegment {
  std::string name;
  IntersectionReference id;  ///< of the segment
  std::uint8_t revision = 0;
  Position reference;
  std::optional<std::uint16_t> lane_width;
  std::vector<SpeedLimit> speed_limits;
  std::vector<GenericLane> lanes;
  Regional regional;
  Additions additions;
  bool operator==(const RoadSegment&) const = default;
};

struct DataParameters {
  std::string method, agency, last_checked, geoid;  ///< at most 255 characters each
  Additions additions;
  bool operator==(const DataParameters&) const = default;
};

struct RestrictionUser {
  enum Alternative : std::uint8_t { basic, regional_user };
  static constexpr std::array<std::string_view, 2> kAlternatives{"basicType", "regional"};
  Alternative choice = basic;
  std::uint8_t type = 0;  ///< row of kRestrictionUsers
  Regional regional;
  base::Bytes unknown;
  bool operator==(const RestrictionUser&) const = default;
};

struct RestrictionClass {
  std::uint8_t id = 0;
  std::vector<RestrictionUser> users;  ///< 1 to 16
  bool operator==(const RestrictionClass&) const = default;
};

struct MapData {
  static constexpr std::uint16_t kMessageId = 18;
  static constexpr std::string_view kTag = "MapData";
  std::optional<std::uint32_t> minute;              ///< of the year
  std::uint8_t revision = 0;                        ///< of the message, in [0, 127]
  std::optional<std::uint8_t> layer;                ///< row of kLayers
  std::optional<std::uint8_t> layer_id;             ///< in [0, 100]
  std::vector<IntersectionGeometry> intersections;  ///< at most 32
  std::vector<RoadSegment> roads;                   ///< at most 32
  std::optional<DataParameters> parameters;
  std::vector<RestrictionClass> restrictions;  ///< at most 254
  Regional regional;
  Additions additions;
  bool operator==(const MapData&) const = default;
};

}  // namespace sf::v2x
