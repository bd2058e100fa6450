#pragma once
// The interface to OpenCV: fiducial dictionaries, detection, image files, cameras, calibration, painted lines. OpenCV's
// libraries need 50 MB and 0.4 s to load, so this part is a plug-in (vision/opencv/, `sensorfarm_opencv.so`) that is
// loaded at first use.
//
// All functions throw base::InputError for invalid user input; OpenCV's exceptions do not escape.

#include <array>
#include <cstdint>
#include <glm/ext/vector_double2.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "vision/camera.h"
#include "vision/ground_raster.h"
#include "vision/image.h"
#include "vision/tag_pattern.h"

namespace sf::vision {

/// A tag found in an image, with an accuracy of about a pixel.
struct TagOutline {
  std::uint32_t id = 0;
  /// [px] outer corners of the black border: upper left, upper right, lower right, lower left of the printed tag
  std::array<glm::dvec2, 4> corners;
};

/// Finds the tags of one dictionary. Images may differ in size. Not thread-safe.
class TagFinder {
 public:
  /// [px] A tag that is farther from the border of its region has the same outline as in a search of the whole image:
  /// half of the largest threshold window, and the distance from the border that OpenCV requires.
  static constexpr int kRegionMargin = 15;

  virtual ~TagFinder() = default;
  /// Replaces the content of `found` by the tags that are completely in `region`, with the sizes expected of the whole
  /// image. @param image grey @param region within the image
  /// @return false if the image has no pixels or OpenCV fails on it; `found` is then empty
  virtual bool find(const Image& image, const Region& region, std::vector<TagOutline>& found) = 0;
};

/// Finds painted lines on the ground. Not thread-safe.
class PaintFinder {
 public:
  virtual ~PaintFinder() = default;
  /// @param image grey, of the size of the camera's images
  /// @param ground out, grey: the image as a raster of the ground, 0 where it sees nothing, else more
  /// @param paint out, grey: brightness above that of the ground beside a line, 0 where there is no line
  virtual void find(const Image& image, Image& ground, Image& paint) = 0;
};

/// Greyscale images from a device, a video or a folder. Not thread-safe.
class ImageSource {
 public:
  virtual ~ImageSource() = default;
  /// Reads the next image; blocks for a device. An unreadable file gives an image without pixels.
  /// @return false after the last image
  /// @throws base::InputError for an image of more than `kMaxImagePixels`, and if a device or a video fails
  virtual bool next(Image& out) = 0;
  /// Skips the next image without decoding it, where the source can. @return as `next`
  virtual bool skip() {
    Image skipped;
    return next(skipped);
  }
  /// True if `reopen` may succeed after the source ended.
  virtual bool can_reopen() const { return false; }
  /// Opens the source again. @return false if that failed
  virtual bool reopen() { return false; }
  virtual bool is_live() const { return false; }
  /// Returns the number of images; 0 if unknown.
  virtual std::size_t size() const { return 0; }
  /// [Hz] Returns the rate of a video; 0 if unknown.
  virtual double rate() const { return 0.0; }
};

/// Writes a video, which is complete once this is destroyed. Not thread-safe.
class VideoFile {
 public:
  virtual ~VideoFile() = default;
  /// @param image 3 channels, of the video's size
  virtual void write(const Image& image) = 0;
};

/// Lines and a text to draw into an image.
struct Mark {
  std::vector<glm::dvec2> points;              ///< [px] a line through all points
  std::string text;                            ///< ASCII; its lower left corner is at the last point
  std::array<std::uint8_t, 3> color{0, 0, 0};  ///< red, green, blue
  int width = 1;                               ///< [px] of the line
};

/// A printed chessboard, plain or with a tag in each white square (ChArUco, as printed by OpenCV from 4.6 on: the upper
/// left square is black, and ids count along the rows).
struct Chessboard {
  int columns = 9, rows = 6;  ///< inner corners along a row and a column, each > 2
  double square = 0.025;      ///< [m] side of a square
  std::string dictionary;     ///< of the tags; empty: a plain board
  double marker = 0.0;        ///< [m] side of a tag, below `square`
};

/// A corner of a board in an image.
struct BoardCorner {
  int index = 0;  ///< row by row over the inner corners, starting at 0
  glm::dvec2 pixel;
};

/// Intrinsics fitted to the corners of a chessboard in several images.
struct Calibration {
  Intrinsics intrinsics;
  double residual = 0.0;  ///< [px] RMS distance of corners from their projections, over all images
  std::vector<std::optional<double>> residuals;  ///< [px] of each image; nullopt if the board was not found
};

/// A function table, since plug-in symbols are looked up as data only.
struct OpenCv {
  /// Tags are upright as OpenCV prints them; vision/tag_family.h has their authors' orientations.
  /// @param dictionary such as "apriltag_36h11" or "aruco_4x4_50"
  TagPattern (*tag_pattern)(const std::string& dictionary, std::uint32_t id);
  std::uint32_t (*tag_count)(const std::string& dictionary);
  /// @param dictionary empty: finds all dark quadrilaterals that may be tags, with the id 0 and any corner as the first
  std::unique_ptr<TagFinder> (*make_tag_finder)(const std::string& dictionary);
  /// @param image 3 channels
  void (*draw)(Image& image, const std::vector<Mark>& marks);
  /// Returns the image as JPEG, reduced if a side is longer than `most_side` [px]. @param image with 1 or 3 channels
  std::vector<std::uint8_t> (*encode_jpeg)(const Image& image, int most_side);
  /// @param source "/dev/video0", "firewire:N" (an IIDC camera), "gstreamer:PIPELINE", a video file, an image file, or
  /// a folder of images, which are read in order of their names; pipes, sockets and other special files are skipped in
  /// a folder and rejected as a source
  /// @param width, height, rate requested from a V4L2 or FireWire device; a pipeline names its own
  std::unique_ptr<ImageSource> (*open_source)(const std::string& source, int width, int height, double rate);
  /// Opens a Motion JPEG video. @param file "*.avi" @param rate [Hz]
  std::unique_ptr<VideoFile> (*open_video)(const std::string& file, int width, int height, double rate);
  /// Finds the inner corners of the chessboard to about 0.05 px. For a plain board, returns all or none. For a board
  /// with tags, returns the visible corners; none if fewer than six were found or all are on one line. @param image
  /// grey
  /// @throws base::InputError if the board has more tags than its dictionary
  std::vector<BoardCorner> (*find_board)(const Image& image, const Chessboard& board);
  /// @param corners found in each image @param width, height [px] of all images
  /// @throws base::InputError if the board was found in fewer than three images
  Calibration (*calibrate)(const std::vector<std::vector<BoardCorner>>& corners, const Chessboard& board, int width,
                           int height);
  /// Sets a camera's pose in the world from at least four points, not on one line, and their pixels.
  void (*place)(const std::vector<glm::dvec3>& places, const std::vector<glm::dvec2>& pixels, Camera& camera);
  /// @param pixels of the raster's cells (`pixels_of`)
  std::unique_ptr<PaintFinder> (*make_paint_finder)(const GroundRaster& raster, const PaintLines& lines,
                                                    const std::vector<glm::dvec2>& pixels);
};

/// The only symbol of the plug-in: `extern "C" const OpenCv sensorfarm_opencv`.
inline constexpr const char* kOpenCvSymbol = "sensorfarm_opencv";

/// Loads the plug-in once, from the folder of the running program or the system's library path.
/// @throws base::InputError naming the file if it cannot be loaded.
const OpenCv& opencv();

}  // namespace sf::vision
