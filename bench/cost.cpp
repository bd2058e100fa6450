#include "bench/cost.h"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "base/error.h"

namespace sf::bench {

namespace {

double seconds(const timeval& t) { return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec); }

}  // namespace

Cost now() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto wall = std::chrono::steady_clock::now().time_since_epoch();
  return {std::chrono::duration<double>(wall).count(), seconds(usage.ru_utime) + seconds(usage.ru_stime)};
}

Cost since(const Cost& start) {
  const double end = now().wall_s;
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return {end - start.wall_s, now().cpu_s - start.cpu_s};
}

double median(std::vector<double> values) {
  SF_CHECK(!values.empty(), "median of nothing");
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

Cost median(const std::vector<Cost>& costs) {
  std::vector<double> wall, cpu;
  for (const Cost& c : costs) {
    wall.push_back(c.wall_s);
    cpu.push_back(c.cpu_s);
  }
  return {median(wall), median(cpu)};
}

Cost ratio(const std::vector<Cost>& reference, const std::vector<Cost>& repeats) {
  std::vector<Cost> quotients;
  for (std::size_t k = 0; k < repeats.size(); ++k)
    quotients.push_back({reference[k].wall_s / repeats[k].wall_s, reference[k].cpu_s / repeats[k].cpu_s});
  return median(quotients);
}

}  // namespace sf::bench
