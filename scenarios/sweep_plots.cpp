#include "scenarios/sweep_plots.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>

#include "base/error.h"
#include "base/number_text.h"
#include "scenarios/experiment.h"
#include "scenarios/intervals.h"
#include "scenarios/sweep_jobs.h"
#include "viz/ticks.h"

namespace sf::scenarios {

namespace {

constexpr std::size_t kMostPlotsOfFigure = 24;
constexpr std::size_t kMostOverlaid = 7;  ///< maximum number of lines in an additional figure of one plot

/// A parameter and its values.
struct Parameter {
  std::size_t row = 0;
  std::vector<std::string> values;  ///< unique: numbers ascending, others in order of appearance
  bool numeric = true;

  std::size_t index_of(const SweepPoint& point) const {
    return static_cast<std::size_t>(std::find(values.begin(), values.end(), point.values[row]) - values.begin());
  }
};

std::vector<Parameter> parameters_of(const SweepJobs& jobs) {
  std::vector<Parameter> all;
  for (std::size_t row = 0; row < jobs.parameters.size(); ++row) {
    Parameter& p = all.emplace_back(Parameter{row, {}, true});
    std::map<std::string, bool> seen;
    for (const SweepPoint& point : jobs.points) {
      if (!seen.emplace(point.values[row], true).second) continue;
      p.values.push_back(point.values[row]);
      p.numeric = p.numeric && base::finite_number(point.values[row]);
    }
    if (p.numeric)
      std::sort(p.values.begin(), p.values.end(), [](const std::string& a, const std::string& b) {
        return *base::finite_number(a) < *base::finite_number(b);
      });
  }
  return all;
}

/// Returns "link.delay [s]"; keys of controllers have their own units.
std::string parameter_name(const std::string& name) {
  if (name.find("settings.") != std::string::npos) return name;
  const std::string key = name.substr(name.rfind('.') + 1);
  for (const char* seconds : {"delay", "jitter", "duration", "tick", "start_at", "at"})
    if (key == seconds) return name + " [s]";
  if (key == "rate") return name + " [Hz]";
  return key == "position_sigma" ? name + " [m]" : key == "yaw_sigma" ? name + " [rad]" : name;
}

/// Returns the shortest unique end of a parameter's name: "kp", or "link.delay" if there is also "states.delay".
std::string short_name(const SweepJobs& jobs, std::size_t row) {
  const std::string& name = jobs.parameters[row];
  for (std::size_t dot = name.rfind('.'); dot != std::string::npos && dot > 0; dot = name.rfind('.', dot - 1)) {
    const std::string end = name.substr(dot);
    const auto ends = std::count_if(jobs.parameters.begin(), jobs.parameters.end(), [&](const std::string& other) {
      return other.ends_with(end) || "." + other == end;
    });
    if (ends == 1) return end.substr(1);
  }
  return name;
}

/// Returns "kp = 0.5".
std::string value_name(const SweepJobs& jobs, const Parameter& p, const std::string& value) {
  return fmt::format("{} = {}", short_name(jobs, p.row),
                     p.numeric ? viz::number_text(std::strtod(value.c_str(), nullptr)) : value);
}

/// Returns a metric as the name of an axis.
std::string metric_name(const std::string& metric) {
  const std::size_t of = metric.find(" of ");
  const std::string base = metric.substr(0, of), robot = of == std::string::npos ? "" : metric.substr(of);
  const std::pair<std::string_view, std::string_view> kNames[] = {
      {"met", "fraction of runs that met their expectations"},
      {"contacts", "contacts"},
      {"mean_error", "|mean error|"},
      {"mean_abs_error", "mean |error|"},
      {"map_coverage", "fraction of the map seen"},
      {"red_lights_passed", "red lights passed"},
      {"done", "fraction of runs that were done"},
      {"distance", "distance [m]"},
      {"all_checkpoints", "checkpoints of all robots"}};
  for (const auto& [word, name] : kNames) {
    if (base != word) continue;
    const std::size_t unit = std::min(name.find(" ["), name.size());
    return fmt::format("{}{}{}", name.substr(0, unit), robot, name.substr(unit));
  }
  return metric;
}

std::string file_stem(const std::string& metric) {
  std::string stem = metric;
  for (char& c : stem)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
  return stem;
}

class SweepPlotter {
 public:
  SweepPlotter(const SweepJobs& jobs, const std::string& folder, const SweepPlotChoice& choice, SweepPlots& plots)
      : jobs_(jobs), folder_(folder), choice_(choice), plots_(plots) {
    for (const Parameter& p : parameters_of(jobs))
      if (p.values.size() > 1) varied_.push_back(p);
    std::size_t combinations = 1;
    for (const Parameter& p : varied_) combinations = std::min(combinations * p.values.size(), jobs_.points.size() + 1);
    is_grid_ = combinations == jobs_.points.size();
  }

  void draw(const std::string& file) {
    if (varied_.empty()) {
      plots_.notes.emplace_back("no parameter has two values: nothing to plot");
      return;
    }
    metrics_ = jobs_.metrics;
    if (has_expectations()) metrics_.emplace_back("met");
    for (std::size_t metric = 0; metric < metrics_.size(); ++metric) {
      if (!is_measured(metric)) continue;
      for (const Parameter& x : along_x(file)) is_grid_ ? draw_grid(file, metric, x) : draw_sample(file, metric, x);
    }
  }

 private:
  bool has_expectations() const {
    return std::any_of(jobs_.points.begin(), jobs_.points.end(), [](const SweepPoint& point) {
      return std::any_of(point.status.begin(), point.status.end(),
                         [](const std::string& s) { return s == "pass" || s == "missed"; });
    });
  }

  bool is_met(std::size_t metric) const { return metric == jobs_.metrics.size(); }
  bool is_measured(std::size_t metric) const {
    return std::any_of(jobs_.points.begin(), jobs_.points.end(),
                       [&](const SweepPoint& point) { return interval_of(metric, point).count > 0; });
  }

  Interval interval_of(std::size_t metric, const SweepPoint& point) const {
    if (!is_met(metric)) return metric_interval(metrics_[metric], point.metrics[metric]);
    const auto count = [&](const char* status) {
      return static_cast<std::size_t>(std::count(point.status.begin(), point.status.end(), status));
    };
    return proportion_interval(count("pass"), count("pass") + count("missed") + count("failed"));
  }

  /// Returns the requested parameter; one for a grid, all for a sample.
  std::vector<Parameter> along_x(const std::string& file) const {
    const auto named = [&](const Parameter& p) { return jobs_.parameters[p.row] == choice_.over; };
    if (const auto found = std::find_if(varied_.begin(), varied_.end(), named); found != varied_.end()) return {*found};
    if (!choice_.over.empty())
      throw base::InputError(file, 0,
                             fmt::format("has no parameter '{}' with two values; it has {}", choice_.over, names()));
    if (!is_grid_) return varied_;
    const auto first = std::find_if(varied_.begin(), varied_.end(), [](const Parameter& p) { return p.numeric; });
    return {first == varied_.end() ? varied_.front() : *first};
  }

  std::string names() const {
    std::vector<std::string> names;
    for (const Parameter& p : varied_) names.push_back(jobs_.parameters[p.row]);
    return fmt::format("{}", fmt::join(names, ", "));
  }

  viz::IntervalFigure figure_of(const std::string& file, std::size_t metric, const Parameter& x) const {
    viz::IntervalFigure figure{.title = metrics_[metric],
                               .subtitle = subtitle_of(metric),
                               .x_name = parameter_name(jobs_.parameters[x.row]),
                               .y_name = metric_name(metrics_[metric]),
                               .joined = is_grid_,
                               .proportion = is_met(metric) || metrics_[metric] == "done"};
    if (!x.numeric) figure.categories = x.values;
    figure.logarithmic = is_logarithmic(file, x);
    return figure;
  }

  bool is_logarithmic(const std::string& file, const Parameter& x) const {
    if (!x.numeric || choice_.x_axis == viz::AxisScale::linear) return false;
    std::vector<double> values;
    for (const std::string& text : x.values) values.push_back(*base::finite_number(text));
    if (choice_.x_axis == viz::AxisScale::automatic) return viz::is_geometric(values);
    if (values.front() > 0.0) return true;
    throw base::InputError(file, 0,
                           fmt::format("{} = {}: a logarithmic axis allows only values above 0",
                                       jobs_.parameters[x.row], x.values.front()));
  }

  /// Returns "mean and 95 % interval (Student), n = 3 per point; 2 results left out".
  std::string subtitle_of(std::size_t metric) const {
    std::size_t least = SIZE_MAX, most = 0, seeds = 0, counted_runs = 0;
    for (const SweepPoint& point : jobs_.points) {
      const std::size_t n = interval_of(metric, point).count;
      least = std::min(least, n);
      most = std::max(most, n);
      counted_runs += n;
      seeds += point.status.size();
    }
    const bool part = is_met(metric) || metrics_[metric] == "done";
    std::string text = part       ? "fraction and 95 % interval (Wilson), "
                       : most < 2 ? "one result per point: no interval"
                                  : "mean and 95 % interval (Student's t), ";
    if (part || most > 1)
      text +=
          least == most ? fmt::format("n = {} per point", most) : fmt::format("n = {} to {} per point", least, most);
    if (metrics_[metric].starts_with("mean_")) text += "; error in the controller's unit";
    if (counted_runs < seeds)
      text += fmt::format("; {} without a finite value left out", counted(seeds - counted_runs, "job"));
    return text;
  }

  viz::IntervalPoint point_of(std::size_t metric, const Parameter& x, const SweepPoint& point) const {
    const Interval interval = interval_of(metric, point);
    const double at = x.numeric ? *base::finite_number(point.values[x.row]) : static_cast<double>(x.index_of(point));
    return {at, interval.mean, interval.low, interval.high};
  }

  /// Returns the points accepted by `is`, in order of x.
  template <class Is>
  viz::IntervalLine line_of(std::string name, std::size_t metric, const Parameter& x, Is&& is) const {
    viz::IntervalLine line{std::move(name), {}};
    for (const SweepPoint& point : jobs_.points)
      if (is(point)) line.points.push_back(point_of(metric, x, point));
    std::stable_sort(line.points.begin(), line.points.end(), [](const auto& a, const auto& b) { return a.x < b.x; });
    return line;
  }

  /// Returns the parameters except x, those with few values first.
  std::vector<Parameter> others_than(const Parameter& x) const {
    std::vector<Parameter> others;
    for (const Parameter& p : varied_)
      if (p.row != x.row) others.push_back(p);
    std::stable_sort(others.begin(), others.end(),
                     [](const Parameter& a, const Parameter& b) { return a.values.size() < b.values.size(); });
    return others;
  }

  /// Returns one plot of the points accepted by `is`, with a line per value of `lines`; one line if it is null.
  template <class Is>
  viz::IntervalPlot plot_of(std::size_t metric, const Parameter& x, const Parameter* lines, std::string title,
                            Is&& is) const {
    viz::IntervalPlot plot{std::move(title), {}, {}};
    if (lines == nullptr) plot.lines.push_back(line_of("", metric, x, is));
    for (std::size_t k = 0; lines != nullptr && k < lines->values.size(); ++k)
      plot.lines.push_back(line_of(value_name(jobs_, *lines, lines->values[k]), metric, x, [&](const SweepPoint& p) {
        return is(p) && p.values[lines->row] == lines->values[k];
      }));
    return plot;
  }

  void draw_grid(const std::string& file, std::size_t metric, const Parameter& x) {
    const std::vector<Parameter> others = others_than(x);
    viz::IntervalFigure figure = figure_of(file, metric, x);
    const auto any = [](const SweepPoint&) { return true; };
    if (others.empty() || (others.size() == 1 && others[0].values.size() <= kMostOverlaid)) {
      figure.plots = {plot_of(metric, x, others.empty() ? nullptr : &others[0], "", any)};
      save(figure, file_stem(metrics_[metric]));
    }
    if (others.size() == 1) return draw_multiples(std::move(figure), metric, x, others[0]);
    if (others.size() > 1) draw_combinations(std::move(figure), metric, x, others);
  }

  /// Two parameters: a plot per value of the second one, with the other values' lines in grey.
  void draw_multiples(viz::IntervalFigure figure, std::size_t metric, const Parameter& x, const Parameter& other) {
    figure.plots.clear();
    const auto at = [&](std::size_t k) {
      return line_of("", metric, x, [&](const SweepPoint& p) { return p.values[other.row] == other.values[k]; });
    };
    for (std::size_t k = 0; k < std::min(other.values.size(), kMostPlotsOfFigure); ++k) {
      viz::IntervalPlot plot{value_name(jobs_, other, other.values[k]), {at(k)}, {}};
      for (std::size_t i = 0; i < std::min(other.values.size(), kMostPlotsOfFigure); ++i)
        if (i != k) plot.others.push_back(at(i));
      figure.plots.push_back(std::move(plot));
    }
    note_left_out(metric, other.values.size());
    save(figure, file_stem(metrics_[metric]) + "_multiples");
  }

  /// More parameters: a plot per combination of the other parameters' values.
  void draw_combinations(viz::IntervalFigure figure, std::size_t metric, const Parameter& x,
                         const std::vector<Parameter>& others) {
    std::size_t count = 1;
    for (std::size_t i = 1; i < others.size(); ++i) count *= others[i].values.size();
    figure.plots.clear();
    for (std::size_t k = 0; k < std::min(count, kMostPlotsOfFigure); ++k) {
      std::vector<std::string> titles, wanted(others.size());
      for (std::size_t i = 1, rest = k; i < others.size(); rest /= others[i].values.size(), ++i) {
        wanted[i] = others[i].values[rest % others[i].values.size()];
        titles.push_back(value_name(jobs_, others[i], wanted[i]));
      }
      const auto is = [&](const SweepPoint& p) {
        for (std::size_t i = 1; i < others.size(); ++i)
          if (p.values[others[i].row] != wanted[i]) return false;
        return true;
      };
      figure.plots.push_back(plot_of(metric, x, &others[0], fmt::format("{}", fmt::join(titles, ", ")), is));
    }
    note_left_out(metric, count);
    save(figure, file_stem(metrics_[metric]));
  }

  void draw_sample(const std::string& file, std::size_t metric, const Parameter& x) {
    viz::IntervalFigure figure = figure_of(file, metric, x);
    figure.plots = {plot_of(metric, x, nullptr, "", [](const SweepPoint&) { return true; })};
    save(figure, file_stem(metrics_[metric]) + "_over_" + file_stem(jobs_.parameters[x.row]));
  }

  void note_left_out(std::size_t metric, std::size_t count) {
    if (count > kMostPlotsOfFigure)
      plots_.notes.push_back(fmt::format("{}: the first {} of {} small multiples are drawn; all are in points.csv",
                                         metrics_[metric], kMostPlotsOfFigure, count));
  }

  void save(const viz::IntervalFigure& figure, const std::string& stem) {
    if (plots_.files.empty()) make_folder(folder_);
    plots_.files.push_back(folder_ + "/" + stem + "." + choice_.format);
    viz::draw_intervals(figure, plots_.files.back(), choice_.page);
  }

  const SweepJobs& jobs_;
  const std::string& folder_;
  const SweepPlotChoice& choice_;
  SweepPlots& plots_;
  std::vector<Parameter> varied_;     ///< with at least two values
  std::vector<std::string> metrics_;  ///< with "met" if runs have expectations
  bool is_grid_ = true;               ///< whether each combination of values has exactly one point
};

}  // namespace

SweepPlots draw_sweep(const std::string& file, std::string_view text, const std::string& folder,
                      const SweepPlotChoice& choice) {
  const SweepJobs jobs = read_sweep_jobs(file, text);
  SweepPlots plots;
  SweepPlotter(jobs, folder, choice, plots).draw(file);
  return plots;
}

}  // namespace sf::scenarios
