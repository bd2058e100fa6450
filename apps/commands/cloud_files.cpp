#include "apps/commands/cloud_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>

#include "apps/commands/cloud_replay.h"
#include "apps/commands/numbered_files.h"
#include "apps/commands/output_file.h"
#include "apps/processes/stop_signals.h"
#include "apps/reports/csv_text.h"
#include "apps/reports/progress_line.h"
#include "base/bytes.h"
#include "scenarios/recorded_states.h"

namespace sf::apps {

namespace {

/// [x y z qw qx qy qz]
std::string pose_text(const base::RigidTransform& X, const char* separator) {
  const glm::dquat q = glm::quat_cast(X.R);
  const double numbers[] = {X.p.x, X.p.y, X.p.z, q.w, q.x, q.y, q.z};
  return fmt::format("{}", fmt::join(numbers, separator));
}

void put_text(base::ByteWriter& out, const std::string& text) { out.put_bytes(text.data(), text.size()); }

/// Point Cloud Data, version 0.7, binary (pointclouds.org).
base::Bytes pcd_of(const Cloud& cloud) {
  const bool bright = cloud.has_intensity(), timed = cloud.is_timed();
  base::Bytes bytes;
  base::ByteWriter out(bytes);
  put_text(out, fmt::format("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z{0} ring{1}\n"
                            "SIZE 4 4 4{2} 2{3}\nTYPE F F F{4} U{5}\nCOUNT 1 1 1{6} 1{7}\n",
                            bright ? " intensity" : "", timed ? " time" : "", bright ? " 4" : "", timed ? " 4" : "",
                            bright ? " F" : "", timed ? " F" : "", bright ? " 1" : "", timed ? " 1" : ""));
  put_text(out, fmt::format("WIDTH {}\nHEIGHT {}\nVIEWPOINT {}\nPOINTS {}\nDATA binary\n", cloud.columns(),
                            cloud.lidar.beams->channels, pose_text(cloud.X_WS, " "), cloud.beams()));
  for (std::size_t i = 0; i < cloud.beams(); ++i) {
    const glm::dvec3 p = cloud.has_echo(i) ? cloud.point_S(i) : glm::dvec3(NAN);
    for (int axis = 0; axis < 3; ++axis) out.put(static_cast<float>(p[axis]));
    if (bright) out.put(static_cast<float>(cloud.intensity(i)));
    out.put(cloud.ring(i));
    if (timed) out.put(static_cast<float>(cloud.lidar.beams->times[i]));
  }
  return bytes;
}

base::Bytes ply_of(const Cloud& cloud) {
  std::vector<std::size_t> echoes;
  for (std::size_t i = 0; i < cloud.beams(); ++i)
    if (cloud.has_echo(i)) echoes.push_back(i);
  const bool bright = cloud.has_intensity(), timed = cloud.is_timed();
  base::Bytes bytes;
  base::ByteWriter out(bytes);
  put_text(out, fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty "
                            "double y\nproperty double z\n{}property ushort ring\n{}end_header\n",
                            echoes.size(), bright ? "property float intensity\n" : "",
                            timed ? "property float time\n" : ""));
  for (const std::size_t i : echoes) {
    const glm::dvec3 p = cloud.point_W(i);
    out.put(p.x), out.put(p.y), out.put(p.z);
    if (bright) out.put(static_cast<float>(cloud.intensity(i)));
    out.put(cloud.ring(i));
    if (timed) out.put(static_cast<float>(cloud.lidar.beams->times[i]));
  }
  return bytes;
}

/// Writes the files of all lidars in turn.
class CloudWriter {
 public:
  CloudWriter(const world::World& world, const std::string& folder, CloudFormat format)
      : world_(world),
        folder_(folder + "/clouds"),
        ending_(format == CloudFormat::pcd ? ".pcd" : ".ply"),
        format_(format) {}

  void add(const Cloud& cloud);
  /// @return the table written; nothing without clouds
  std::vector<std::string> close() const {
    if (rows_.empty()) return {};
    const std::string path = folder_ + "/clouds.csv";
    write_text(path, "file,time_s,robot,sensor,x_m,y_m,z_m,qw,qx,qy,qz\n" + rows_);
    return {path};
  }

 private:
  const world::World& world_;
  std::string folder_, ending_;
  CloudFormat format_;
  std::map<std::string, std::size_t> numbers_;  ///< files so far, by the beginnings of their names
  std::string rows_;
};

void CloudWriter::add(const Cloud& cloud) {
  const std::string robot = world_.movers[cloud.mover].name, sensor = cloud.row.name;
  std::string name = fmt::format("{}_{}_", robot, sensor);
  std::ranges::replace(name, '/', '_');
  const auto [number, is_first] = numbers_.try_emplace(name, 0);
  if (is_first) begin_numbered_files(folder_, name, ending_);
  const std::string file = fmt::format("{}{:06}{}", name, number->second++, ending_);
  const base::Bytes bytes = format_ == CloudFormat::pcd ? pcd_of(cloud) : ply_of(cloud);
  write_text(folder_ + "/" + file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  rows_ += fmt::format("{},{},{},{},{}\n", csv_field(file), csv_number(1e-9 * static_cast<double>(cloud.time)),
                       csv_field(robot), csv_field(sensor), pose_text(cloud.X_WS, ","));
}

}  // namespace

std::vector<std::string> write_clouds(const RecordingPart& part, const std::string& folder, CloudFormat format) {
  const world::World world = scenarios::recorded_world(part.recording);
  if (!has_lidar(part, world)) return {};
  CloudReplay replay(part, world);
  CloudWriter writer(world, folder, format);
  Progress progress("writing clouds");
  for (std::size_t tick = 0; tick < replay.ticks(); ++tick) {
    for (const Cloud& cloud : replay.at(tick)) writer.add(cloud), heed_stop();
    progress.show(static_cast<double>(tick) / static_cast<double>(replay.ticks()));
  }
  return writer.close();
}

}  // namespace sf::apps
