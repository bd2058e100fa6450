#include "apps/processes/checkpoints.h"

#include <fmt/format.h>

#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "base/error.h"
#include "base/files.h"
#include "base/hash.h"

namespace sf::apps {

Checkpoints::Checkpoints(const std::string& folder, std::uint64_t run, std::uint64_t every, bool resume)
    : file_(folder + "/checkpoints"), every_(every) {
  const std::string head = fmt::format("sensorfarm checkpoints 1, run {}", base::hash_hex(run));
  if (resume)
    read(head);
  else
    append(head, true);
}

void Checkpoints::read(const std::string& head) {
  if (!std::filesystem::exists(file_))
    throw base::InputError(file_, 0, "no run to resume: create one with --record and --checkpoint S");
  const std::string text = base::read_text(file_);
  const std::size_t whole = text.rfind('\n') + 1;  // the last line may be truncated
  std::filesystem::resize_file(file_, whole);
  std::istringstream lines(text.substr(0, whole));
  std::string line;
  std::getline(lines, line);
  if (line != head)
    throw base::InputError(
        file_, 1,
        "belongs to another run: expected the same world, robots, seed and controllers as in the interrupted run");
  for (int number = 2; std::getline(lines, line); ++number) {
    std::uint64_t tick = 0;
    Point point;
    if (std::sscanf(line.c_str(), "%" SCNu64 " %" SCNx64 " %" SCNx64, &tick, &point.readings, &point.states) != 3)
      throw base::InputError(file_, number, "is not a checkpoint: expected a tick and two hashes");
    known_[tick] = point;
  }
}

void Checkpoints::append(const std::string& line, bool anew) {
  if (anew) std::filesystem::create_directories(std::filesystem::path(file_).parent_path());
  std::ofstream out(file_, anew ? std::ios::trunc : std::ios::app);
  out << line << '\n' << std::flush;
  if (!out) throw base::InputError(file_, 0, "cannot be written");
}

void Checkpoints::update(std::uint64_t ticks, std::uint64_t readings, std::span<const base::Report> reports) {
  const auto known = known_.find(ticks);
  const bool due = every_ > 0 && ticks % every_ == 0;
  if (known == known_.end() && !due) return;
  Point point{readings};
  for (const base::Report& report : reports) {
    const double state[] = {report.X_WM.x,           report.X_WM.y,        report.X_WM.z,       report.X_WM.yaw,
                            report.velocity.forward, report.velocity.left, report.velocity.turn};
    point.states = base::hash_bytes(state, sizeof state, point.states);
  }
  if (known == known_.end())
    append(fmt::format("{} {} {}", ticks, base::hash_hex(point.readings), base::hash_hex(point.states)), false);
  else if (point != known->second)
    throw base::InputError(
        file_, 0,
        fmt::format(
            "the run differs from the interrupted run at tick {}: expected the same program, world and plug-ins",
            ticks));
}

}  // namespace sf::apps
