#pragma once
// Pictures of maps that robots build while they drive: files that are replaced, and a page in the browser.
//
//   LiveMap live({.names = {"roomba0"}, .view = address});
//   live.show(0, grid, figure, "map.png");   // again and again
//   live.finish();

#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "bridges/image_view.h"
#include "maps/grid.h"
#include "viz/map_figure.h"

namespace sf::apps {

struct LiveMapOptions {
  std::string title;                             ///< of the page
  std::vector<std::string> names;                ///< of the maps
  std::optional<bridges::WebAddress> view = {};  ///< nullopt: no page
  double interval = 1.0;                         ///< [s] > 0, least time between two pictures of a map
  viz::Page page = {};                           ///< of files
};

/// Draws on its own thread, at most a third of the time: a caller never waits for a picture. While it is alive, other
/// threads must not draw figures.
class LiveMap {
 public:
  /// Prints the page's address. @throws base::InputError if it is unavailable
  explicit LiveMap(LiveMapOptions options);
  ~LiveMap();

  /// Replaces the map that is to be drawn next. @param map row of the names @param file to replace; empty: none
  void show(std::size_t map, maps::OccupancyGrid grid, viz::MapFigure figure, const std::string& file);
  /// Draws the last maps, and ends the thread. @throws base::InputError if the last file could not be written
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  struct Job {
    maps::OccupancyGrid grid;
    viz::MapFigure figure;
    std::string file;
  };

  void run();
  void draw(const std::map<std::size_t, Job>& jobs);
  void publish();

  const LiveMapOptions options_;
  std::optional<bridges::ImageView> view_;
  std::map<std::size_t, base::Bytes> pictures_;  ///< newest of each map, for the page
  std::mutex mutex_;                             ///< guards the members below
  std::condition_variable changed_;
  std::map<std::size_t, Job> jobs_;  ///< by map
  bool ends_ = false;
  std::string problem_;  ///< of the last picture; empty: none
  std::thread thread_;   ///< last member: it uses the others
};

}  // namespace sf::apps
