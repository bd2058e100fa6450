// `field`: draws the field of a world's magnets, and writes the values along a line.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/commands/commands.h"
#include "apps/commands/output_file.h"
#include "apps/options/open_device.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/progress_line.h"
#include "apps/reports/report.h"
#include "apps/reports/text.h"
#include "base/elementary.h"
#include "base/error.h"
#include "viz/field_figure.h"

namespace sf::apps {

namespace {

constexpr double kGauss = 1e-4;  // [T]
constexpr const char* kNothing = "interrupted: nothing was written";

void refuse_without_field(const world::World& world) {
  const bool carried = std::any_of(world.movers.begin(), world.movers.end(),
                                   [](const world::Mover& mover) { return !mover.magnets.empty(); });
  if (world.magnets.empty() && !carried && world.earth_field == glm::dvec3{})
    throw base::InputError(
        world.file, 0,
        "has no magnets and therefore no field; give a model a 'magnetic_moment' (10000 is 1 A m^2), "
        "or the world an 'earth_field'");
}

std::string csv_of(const viz::FieldView& view, const viz::FieldSamples& samples) {
  std::string text = "along_m,x_m,y_m,z_m,field_gauss,x_gauss,y_gauss,z_gauss,magnitudes_gauss\n";
  for (const viz::ProfilePoint& p : samples.profile)
    text += fmt::format("{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", p.along, p.p.x, p.p.y,
                        view.height, base::hypot(p.field.x, p.field.y, p.field.z) / kGauss, p.field.x / kGauss,
                        p.field.y / kGauss, p.field.z / kGauss, p.field.magnitudes / kGauss);
  return text;
}

}  // namespace

int field(const FieldOptions& options) {
  install_stop_handlers();
  const world::World world = world::load_world(options.world, options.load);
  print_warnings(options.world, world.warnings);
  refuse_without_field(world);
  const viz::FieldView view = viz::field_view(world, {options.height, options.line, options.extent, options.page});

  if (!options.csv.empty()) check_writable(options.csv);
  gpu::Device device = open_device(options);
  Progress progress("summing magnets");
  const viz::FieldSamples samples = viz::sample_field(world, device, view, [&](double part) {
    progress.show(part);
    heed_stop(kNothing);
  });
  heed_stop(kNothing);
  viz::draw_field(world, view, samples, options.out, options.page);
  print_message("wrote {}", options.out);
  if (options.csv.empty()) return 0;
  write_text(options.csv, csv_of(view, samples));
  print_message("wrote {}", options.csv);
  return 0;
}

}  // namespace sf::apps
