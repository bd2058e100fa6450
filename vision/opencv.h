#pragma once
// OpenCV's part of the module: fiducial dictionaries, detection, image files, cameras, calibration. OpenCV's libraries
// take 50 MB and 0.4 s to load, so this part is a plug-in (vision/opencv/, `sensorfarm_opencv.so`) that is loaded with
// the first use.
//
// All functions throw base::InputError for faults of the user's input; none of OpenCV's exceptions passes.

#include <array>
#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vision/camera.h"
#include "vision/image.h"
#include "vision/tag_pattern.h"

namespace sf::vision {

/// A tag found in an image, to about a pixel.
struct TagOutline {
  std::uint32_t id = 0;
  /// [px] outer corners of the black border: upper left, upper right, lower right, lower left of the printed tag
  std::array<glm::dvec2, 4> corners;
};

/// Finds the tags of one dictionary. Images may differ in size. One thread at a time.
class TagFinder {
 public:
  virtual ~TagFinder() = default;
  /// Replaces the content of `found`. @param image grey
  /// @return false where the image has no pixels, or OpenCV fails on it; `found` is then empty
  virtual bool find(const Image& image, std::vector<TagOutline>& found) = 0;
};

/// Images from a device, a video or a folder, in grey. One thread at a time.
class ImageSource {
 public:
  virtual ~ImageSource() = default;
  /// Waits for the next image of a device. A file that cannot be read gives an image without pixels.
  /// @return false after the last image
  /// @throws base::InputError for an image of more than `kMaxImagePixels`, and where a device or a video fails
  virtual bool next(Image& out) = 0;
  virtual bool is_live() const { return false; }
  /// Number of images; 0 where it is not known.
  virtual std::size_t size() const { return 0; }
  /// [Hz] of a video; 0 where it is not known.
  virtual double rate() const { return 0.0; }
};

/// A video that is being written; complete when it is destroyed. One thread at a time.
class VideoFile {
 public:
  virtual ~VideoFile() = default;
  /// @param image 3 channels, of the video's size
  virtual void write(const Image& image) = 0;
};

/// Lines and a text in an image.
struct Mark {
  std::vector<glm::dvec2> points;              ///< [px] a line through all of them
  std::string text;                            ///< ASCII; its lower left corner is at the last point
  std::array<std::uint8_t, 3> color{0, 0, 0};  ///< red, green, blue
  int width = 1;                               ///< [px] of the line
};

/// A printed chessboard, plain or with a tag in each white square (ChArUco, as OpenCV from 4.6 on prints it: the upper
/// left square is black, and ids count along the rows).
struct Chessboard {
  int columns = 9, rows = 6;  ///< inner corners along a row and a column, each > 2
  double square = 0.025;      ///< [m] side of its squares
  std::string dictionary;     ///< of its tags; empty: a plain board
  double marker = 0.0;        ///< [m] side of its tags, below `square`
};

/// A corner of a board in an image.
struct BoardCorner {
  int index = 0;  ///< row by row over the inner corners, from 0
  glm::dvec2 pixel;
};

/// Intrinsics that explain the corners of a chessboard in several images.
struct Calibration {
  Intrinsics intrinsics;
  double residual = 0.0;                         ///< [px] RMS distance of corners from their projections, of all images
  std::vector<std::optional<double>> residuals;  ///< [px] of each image; nothing where the board was not found
};

/// A function table, since only data symbols are looked up by name.
struct OpenCv {
  /// @param dictionary such as "apriltag_36h11" or "aruco_4x4_50"
  TagPattern (*tag_pattern)(const std::string& dictionary, std::uint32_t id);
  std::uint32_t (*tag_count)(const std::string& dictionary);
  std::unique_ptr<TagFinder> (*make_tag_finder)(const std::string& dictionary);
  /// @param image 3 channels
  void (*draw)(Image& image, const std::vector<Mark>& marks);
  /// @param source "/dev/video0", a video file, an image file, or a folder of images, which are read in order of names;
  /// pipes, sockets and other special files of a folder are left out, and refused as a source
  /// @param width, height, rate requested from a device
  std::unique_ptr<ImageSource> (*open_source)(const std::string& source, int width, int height, double rate);
  /// Motion JPEG. @param file "*.avi"  @param rate [Hz]
  std::unique_ptr<VideoFile> (*open_video)(const std::string& file, int width, int height, double rate);
  /// Inner corners of the chessboard to about 0.05 px, of a plain one all or none; of a board with tags those in sight,
  /// none where fewer than six were found, or all are in one line. @param image grey
  /// @throws base::InputError for a board with more tags than its dictionary
  std::vector<BoardCorner> (*find_board)(const Image& image, const Chessboard& board);
  /// @param corners of each image, as found  @param width, height [px] of all images
  /// @throws base::InputError when the board was found in fewer than three images
  Calibration (*calibrate)(const std::vector<std::vector<BoardCorner>>& corners, const Chessboard& board, int width,
                           int height);
  /// Sets a camera's pose in the world from at least four points, not on one line, and their pixels.
  void (*place)(const std::vector<glm::dvec3>& places, const std::vector<glm::dvec2>& pixels, Camera& camera);
};

/// The name of the plug-in's only symbol: `extern "C" const OpenCv sensorfarm_opencv`.
inline constexpr const char* kOpenCvSymbol = "sensorfarm_opencv";

/// Loads the plug-in, once, from the folder of the running program or the system's library path.
/// @throws base::InputError naming the file when it cannot be loaded.
const OpenCv& opencv();

}  // namespace sf::vision
