#pragma once
// Reads the text format of the UTIAS Multi-Robot Cooperative Localization and Mapping data sets: odometry, range and
// bearing of barcodes, and the truth of several robots.
//
// A folder has Barcodes.dat, Landmark_Groundtruth.dat and, for each robot k, Robot<k>_Odometry.dat,
// Robot<k>_Measurement.dat and Robot<k>_Groundtruth.dat. Each line has numbers separated by blanks or tabs; lines that
// begin with # are comments. Lines may end with CRLF, and need not be sorted.
//
// Reference: K. Y. K. Leung, Y. Halpern, T. D. Barfoot and H. H. T. Liu, The UTIAS multi-robot cooperative localization
// and mapping dataset, International Journal of Robotics Research 30, 2011.

#include <cstdint>
#include <string>
#include <vector>

#include "base/pose.h"

namespace sf::record {

struct MrclamOdometry {
  std::int64_t time = 0;             ///< [ns] since 1970
  double forward = 0.0, turn = 0.0;  ///< [m/s], [rad/s]
};
struct MrclamSighting {
  std::int64_t time = 0;              ///< [ns] since 1970
  int subject = 0;                    ///< robot or landmark
  double range = 0.0, bearing = 0.0;  ///< [m] > 0, [rad] in the robot's frame
};
struct MrclamTruth {
  std::int64_t time = 0;  ///< [ns] since 1970
  base::Pose X_WM;
};

struct MrclamRobot {
  int subject = 0;
  // Sorted by time; of equal times, in the order of the file.
  std::vector<MrclamOdometry> odometry;
  std::vector<MrclamSighting> sightings;  ///< of known barcodes
  std::vector<MrclamTruth> truth;         ///< one per time: the first
  std::size_t unknown_barcodes = 0;       ///< dropped measurements of barcodes that Barcodes.dat does not list
  std::size_t unknown_subjects = 0;  ///< the same of subjects that are neither a landmark nor a robot of the folder
};
struct MrclamLandmark {
  int subject = 0;
  glm::dvec2 p{};  ///< [m]
};
struct MrclamData {
  std::vector<MrclamRobot> robots;        ///< sorted by subject, at least one
  std::vector<MrclamLandmark> landmarks;  ///< sorted by subject
};

/// @throws base::InputError naming file and line for a missing or empty file and a line that is not as described
MrclamData read_mrclam(const std::string& folder);

}  // namespace sf::record
