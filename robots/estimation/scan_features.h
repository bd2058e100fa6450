#pragma once
// Features of one reading: lines, corners and clusters of a laser scan, and echoes of cones, with their covariance.
//
// Lines: groups of neighbouring echoes (breakpoints as in G. A. Borges, M.-J. Aldon, Line extraction in 2D range images
// for mobile robotics, 2004) are split at the farthest echo, fitted by weighted total least squares (S. T. Pfister and
// others, Weighted line fitting algorithms for mobile robot map building, 2003) and merged. Corners: where neighbouring
// lines meet. Clusters: the remaining echoes of a group. Objects: clusters that fit into a rectangle of known size,
// turned so that the echoes are near its sides (X. Zhang and others, Efficient L-shape fitting for vehicle detection
// using laser scanners, 2017, criterion of closeness) and completed to this size behind its nearest sides. Positions
// are in the frame of the sensor's robot.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/pose.h"

namespace sf::estimation {

enum class FeatureKind : std::uint8_t { none, line, corner, cluster, tag, object };

struct Feature {
  FeatureKind kind = FeatureKind::none;
  /// [m] a line's middle; a corner; the middle between the two ends of a cluster, as seen; a tag; an object's middle.
  glm::dvec2 p;
  /// [rad] along a line or an object, in (-pi/2, pi/2]; between the two arms of a corner; of a tag; NaN for clusters.
  double direction = 0.0;
  double half_length = 0.0;            ///< [m] of a line, of an object, of a cluster as seen; else 0
  std::array<double, 6> covariance{};  ///< upper triangle of x, y, direction [m, rad]; NaN where nothing is stated
  std::uint32_t id = 0;                ///< of a tag; 0: unknown
};

/// Standard deviations of a scan's or a cone's echoes.
struct EchoNoise {
  double constant = 0.0, proportional = 0.0;  ///< [m], [-] of the range, as in raycast::ScanNoise
  double angle = 0.0;                         ///< [rad] of the bearing
  double squared = 0.0;                       ///< [1/m] of the range, grows with its square
};

struct FeatureOptions {
  double shortest = 0.3;    ///< [m] > 0: shorter straight pieces are parts of clusters
  double widest = 1.0;      ///< [m] > 0: largest width of a cluster; wider remains of a group are dropped
  std::uint32_t least = 5;  ///< >= 3 echoes on a line
  glm::dvec2 size{};        ///< [m] length and width of objects, length >= width; 0: there are none
};

/// Returns the vector turned by a right angle to the left.
inline glm::dvec2 left_of(glm::dvec2 v) { return {-v.y, v.x}; }

/// Finds the features of scans with the same bearings. Keeps its memory between scans.
class ScanFeatures {
 public:
  /// @param bearings [rad] ascending, in the frame of the sensor, X_MS in that of the robot
  ScanFeatures(const base::Pose& X_MS, std::vector<double> bearings, const EchoNoise& noise,
               const FeatureOptions& options);

  /// Returns lines, corners and clusters, each in the order of bearings. Valid until the next call.
  /// @param ranges [m] at least one per bearing; NaN where there is no valid echo
  std::span<const Feature> find(std::span<const double> ranges);

 private:
  struct Echo {
    glm::dvec2 p;          ///< in the robot's frame
    glm::dvec2 sight;      ///< unit vector from the sensor
    double along, across;  ///< [m^2] variances along and across the line of sight
    double spacing;        ///< [m] to the next beam, across
    std::uint32_t beam;
  };
  /// A straight piece: echoes [first, last], of which it is fitted to those that are not near a joint.
  struct Line {
    std::size_t first = 0, last = 0;
    glm::dvec2 centre, along;     ///< weighted
    double weight = 0.0;          ///< [1/m^2] sum of the weights
    double spread = 0.0;          ///< sum of the weights times squared distances from the centre
    double from = 0.0, to = 0.0;  ///< [m] ends along the line, from the centre
    double misfit = 0.0;          ///< weighted sum of squared residuals
    bool is_line = false;
  };

  void place_echoes(std::span<const double> ranges);
  bool continues(const Echo& before, const Echo& after) const;
  void add_group(std::size_t first, std::size_t last);
  void split(std::size_t first, std::size_t last);
  void merge();
  void trim(Line& line, bool at_first, bool at_last) const;
  Line fit(std::size_t first, std::size_t last) const;
  bool straight(const Line& line) const;
  void add_corner(const Line& before, const Line& after);
  void add_cluster(std::size_t first, std::size_t last);
  bool add_object(std::size_t first, std::size_t last);
  void add_line(const Line& line);

  base::Pose X_MS_;
  std::vector<double> bearings_;
  EchoNoise noise_;
  FeatureOptions options_;
  double step_ = 0.0;      ///< [rad] between beams
  bool is_round_ = false;  ///< the last beam is a neighbour of the first
  std::vector<Echo> echoes_;
  std::vector<Line> pieces_;
  std::vector<std::pair<std::size_t, std::size_t>> open_;
  std::vector<Feature> lines_, corners_, clusters_, found_;
};

/// Returns the echo of a cone as a cluster: somewhere on its arc. @param X_MC the cone, with x along its axis
Feature cone_echo(const base::Pose& X_MC, double range, double sigma, double fov);

/// Returns a detected tag. @param noise standard deviations of range [m], bearing [rad] and orientation [rad]
Feature tag_at(const base::Pose& X_MS, double range, double bearing, double orientation,
               const std::array<double, 3>& noise, std::uint32_t id);

}  // namespace sf::estimation
