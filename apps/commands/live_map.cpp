#include "apps/commands/live_map.h"

#include <algorithm>
#include <cctype>

#include "apps/reports/text.h"
#include "base/elapsed.h"
#include "base/error.h"
#include "viz/png.h"

namespace sf::apps {

namespace {

// Small enough for a browser, whatever the size of the map.
viz::Page view_page(const viz::Page& page) { return {.width = 180.0, .height = 180.0, .map_colors = page.map_colors}; }

/// Returns a name as in topics: others than letters, digits, '_' and '-' become '_'.
std::string topic_word(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !(std::isalnum(c) || c == '_' || c == '-'); }, '_');
  return name;
}

}  // namespace

LiveMap::LiveMap(LiveMapOptions options) : options_(std::move(options)) {
  if (options_.view) {
    std::vector<std::string> names;
    for (const std::string& name : options_.names) names.push_back(topic_word(name));
    bridges::ImageViewOptions view{*options_.view};
    view.interval = 0.5 * options_.interval;  // this thread paces the updates
    view.tags = false;
    view.format = "png";
    view_.emplace("sensorfarm: " + options_.title, names, view);
    print_message("{}", view_->describe());
  }
  thread_ = std::thread([this] { run(); });
}

LiveMap::~LiveMap() {
  try {
    finish();
  } catch (const base::InputError&) {  // the caller ends with another error
  }
}

void LiveMap::show(std::size_t map, maps::OccupancyGrid grid, viz::MapFigure figure, const std::string& file) {
  const std::lock_guard lock(mutex_);
  jobs_.insert_or_assign(map, Job{std::move(grid), std::move(figure), file});
  changed_.notify_one();
}

void LiveMap::finish() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
    changed_.notify_one();
  }
  thread_.join();
  if (!problem_.empty()) throw base::InputError(problem_);
}

void LiveMap::run() {
  const auto interval = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options_.interval));
  for (bool ends = false; !ends;) {
    const Clock::time_point start = Clock::now();
    std::map<std::size_t, Job> jobs;
    {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, interval, [this] { return ends_ || !jobs_.empty(); });
      jobs.swap(jobs_);
      ends = ends_;
    }
    const Clock::time_point begun = Clock::now();
    draw(jobs);
    publish();  // also without news: a browser may have connected
    const Clock::time_point done = Clock::now(), next = std::max(start + interval, done + 2 * (done - begun));
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, next, [this] { return ends_; });
    ends = ends && jobs_.empty();
  }
}

void LiveMap::draw(const std::map<std::size_t, Job>& jobs) {
  for (const auto& [map, job] : jobs) {
    std::string problem;
    try {
      if (!job.file.empty())
        viz::replace_picture(job.file, viz::picture_bytes(viz::map_drawing(job.grid, job.figure, options_.page),
                                                          job.file, options_.page));
      if (view_) {
        const viz::Page page = view_page(options_.page);
        const std::string png = viz::picture_bytes(viz::map_drawing(job.grid, job.figure, page), "view.png", page);
        pictures_[map].assign(png.begin(), png.end());
      }
    } catch (const base::InputError& error) {
      problem = error.what();
    }
    const std::lock_guard lock(mutex_);
    if (!problem.empty() && problem != problem_) print_message("warning: {}", problem);
    problem_ = problem;
  }
}

void LiveMap::publish() {
  const auto wanted = view_ ? view_->wanted() : std::nullopt;
  if (!wanted) return;
  std::vector<bridges::CameraPicture> pictures;
  for (const std::size_t map : *wanted)
    if (const auto found = pictures_.find(map); found != pictures_.end()) pictures.push_back({map, found->second});
  view_->publish(base::unix_time(), std::move(pictures), {});
}

}  // namespace sf::apps
