#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <nlohmann/json.hpp>

#include "apps/reports/mesh_report.h"
#include "apps/reports/rate_warnings.h"
#include "apps/reports/report.h"
#include "apps/reports/robot_report.h"
#include "apps/reports/spatial_pose.h"
#include "base/elementary.h"
#include "base/hash.h"
#include "base/tilted_pose.h"
#include "sensors/accuracy.h"
#include "sensors/camera.h"
#include "sensors/laser.h"
#include "sensors/magnetic_field/truncation.h"
#include "world/terrain.h"

namespace sf::apps {

namespace {

using Json = nlohmann::ordered_json;

/// Formats JSON. Names may contain any bytes of a world file, so invalid UTF-8 is replaced.
std::string dump_json(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

std::string indented(const Json& json) { return dump_json(json, 2) + "\n"; }

Json pose_json(const base::Pose& X) { return {X.x, X.y, base::wrap_angle(X.yaw)}; }

Json reasons(const netio::PacketCounts& counts) {
  Json json = Json::object();
  for (std::size_t i = 0; i < netio::kPacketStatuses; ++i) {
    const auto reason = static_cast<netio::PacketStatus>(i);
    if (counts[reason] > 0) json[std::string(name(reason))] = counts[reason];
  }
  return json;
}

Json spat_json(const server::LightCounts& heard) {
  return {{"messages", heard.messages},
          {"states", heard.states},
          {"others", heard.others},
          {"invalid", heard.invalid},
          {"refused", heard.refused}};
}

std::uint64_t count_rays(const netio::StreamSummary& summary) {
  const auto lasers = summary.of.find(std::string(sensors::laser_type.name));
  return lasers == summary.of.end() ? 0 : lasers->second.elements;
}

Json warnings_json(const std::vector<world::Warning>& warnings) {
  Json json = Json::array();
  for (const world::Warning& w : warnings) json.push_back({{"file", w.file}, {"line", w.line}, {"message", w.message}});
  return json;
}

/// Returns null for infinite numbers, which JSON does not support.
Json finite_json(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

/// Returns the additional keys of a noisy sensor.
Json noise_json(double bound_without_noise, double sigma) {
  return {{"bound_without_noise", finite_json(bound_without_noise)}, {"sigma", finite_json(sigma)}};
}

Json statements_json(const std::vector<sensors::AccuracyStatement>& statements) {
  Json json = Json::array();
  for (const sensors::AccuracyStatement& s : statements) {
    json.push_back({{"type", s.type->name},
                    {"sensors", s.sensors},
                    {"mode", sensors::word_of(*s.type, s.mode)},
                    {"bound", finite_json(s.error())},
                    {"unit", sensors::unit_of(*s.type)},
                    {"condition", s.bound.condition}});
    if (s.sigma > 0.0) json.back().update(noise_json(s.bound.error, s.sigma));
  }
  return json;
}

Json number_json(double value, bool whole) {
  if (whole && std::isfinite(value)) return static_cast<std::int64_t>(value);
  return value;  // printed as null if it is not finite
}

std::string_view word_of(base::QualityFlag quality) {
  constexpr std::string_view kWords[] = {"no", "not cast", "grazing", "not straight", "extrapolated", "too near"};
  return kWords[static_cast<std::size_t>(quality)];
}

/// Returns [x y yaw], or [x y z roll pitch yaw] of a robot that is tilted or not at a height of 0.
Json body_pose_json(const base::Pose& X, const base::Tilt& tilt) {
  if (X.z == 0.0 && base::is_level(tilt)) return pose_json(X);
  return {X.x, X.y, X.z, tilt.roll, tilt.pitch, base::wrap_angle(X.yaw)};
}

/// Returns the position and orientation of a spatial sensor, a unit quaternion [w x y z], in the world.
Json spatial_pose_json(const base::RigidTransform& X_WS) {
  const glm::dquat q = glm::quat_cast(X_WS.R);
  return {{"sensor_position", {X_WS.p.x, X_WS.p.y, X_WS.p.z}}, {"sensor_orientation", {q.w, q.x, q.y, q.z}}};
}

/// Returns the numbers of an image, row by row from the top left.
Json image_json(const world::World& world, const sensors::CameraSettings& camera, const base::ReadingBlock& reading) {
  const base::Lens& lens = camera.lens;
  Json depth = Json::array(), labels = Json::array(), rgb = Json::array(), normals = Json::array();
  const std::size_t width = camera.columns();
  for (std::size_t i = 0; i < reading.hits.size(); ++i) {
    const std::span<const double> pixel = reading.values.subspan(i * width, width);
    depth.push_back(pixel[0]);
    labels.push_back(reading.hits[i] == base::kNoHit ? Json() : Json(hit_name(world, reading.hits[i])));
    if (camera.rgb) rgb.push_back(static_cast<std::uint32_t>(pixel[1]) & (camera.mono ? 0xFFu : 0xFFFFFFu));
    if (camera.normals) normals.push_back({pixel[2], pixel[3], pixel[4]});
  }
  Json json{{"resolution", {camera.width, camera.height}},
            {"focal_length_px", {lens.focal.x, lens.focal.y}},
            {"principal_point_px", {lens.center.x, lens.center.y}},
            {"distortion", lens.distortion},
            {"fisheye", lens.fisheye},
            {"depth_m", std::move(depth)},
            {"labels", std::move(labels)}};
  if (camera.rgb) json[camera.mono ? "mono" : "rgb"] = std::move(rgb);
  if (camera.normals) json["normals"] = std::move(normals);
  Json unsure = Json::array();
  for (std::size_t i = 0; i < reading.quality.size(); ++i)
    if (reading.quality[i] != base::QualityFlag::none) unsure.push_back(i);
  json["unsure_pixels"] = std::move(unsure);
  return json;
}

/// Returns the columns of one element, by name. Beams also have their direction and the model that they hit.
Json element_json(const world::World& world, const sensors::SensorSet& sensor_set, const base::ReadingBlock& reading,
                  std::uint32_t i) {
  const sensors::SensorType& type = *sensors::find_sensor_type(reading.type);
  Json json = Json::object();
  if (type.is_scan) json["bearing_rad"] = bearing_of(sensor_set.row(reading), i);
  if (type.beams != nullptr) {
    const sensors::SpatialBeams beams = sensor_set.beams(reading);
    const auto [azimuth, elevation] = sensors::angles_of(beams.directions[i]);
    json["azimuth_rad"] = azimuth;
    json["elevation_rad"] = elevation;
    if (!beams.times.empty()) json["time_s"] = beams.times[i];
  }
  const std::size_t width = element_width(type, sensor_set.row(reading)), end = (i + 1) * width;
  std::size_t at = i * width;
  for (const sensors::Column& column : type.columns) {
    if (at == end) break;
    Json numbers = Json::array();
    for (std::uint32_t k = 0; k < column.width; ++k) numbers.push_back(number_json(reading.values[at++], column.whole));
    json[std::string(column.name)] = column.width == 1 ? numbers[0] : numbers;
  }
  if (type.is_scan || type.beams != nullptr)
    json["hit"] = reading.hits[i] == base::kNoHit ? Json() : Json(hit_name(world, reading.hits[i]));
  if (!type.list.empty() && !reading.quality.empty() && reading.quality[i] != base::QualityFlag::none)
    json["unsure"] = word_of(reading.quality[i]);
  return json;
}

Json error_json(const control::ErrorSummary& f) {
  return {{"steps", f.steps}, {"mean", f.mean}, {"abs_mean", f.abs_mean}};
}

Json localization_json(const control::LocalizationError& f) {
  return {{"steps", f.steps}, {"rms_m", f.rms()}, {"rms_deg", f.yaw_rms() * 180.0 / M_PI}, {"largest_m", f.max}};
}

Json control_json(const ControlReport& f) {
  Json json{{"controller", f.controller}, {"robots", f.robots}, {"done", f.done}};
  if (f.error.steps > 0) json["error"] = error_json(f.error);
  if (f.localization.steps > 0) json["localization"] = localization_json(f.localization);
  if (f.has_goals) json["checkpoints"] = f.checkpoints;
  json["standing"] = Json::array();
  for (const Standing& s : f.standing)
    json["standing"].push_back(
        {{"reason", s.reason}, {"robots", s.robots}, {"names", s.names}, {"longest_s", s.seconds}});
  return json;
}

/// Returns the non-zero counts by verdict, the states beyond the limit per tick, and the senders' clocks.
Json states_json(const RunReport& f) {
  Json json{{"by_verdict", Json::object()},
            {"by_clock", Json::object()},
            {"beyond_limit", f.states.flooded},
            {"clocks", Json::array()}};
  for (std::size_t k = 0; k < f.states.states.size(); ++k)
    if (f.states.states[k] > 0)
      json["by_verdict"][std::string(name(static_cast<estimation::Verdict>(k)))] = f.states.states[k];
  for (std::size_t k = 0; k < f.states.clocks.size(); ++k)
    if (f.states.clocks[k] > 0)
      json["by_clock"][std::string(name(static_cast<estimation::ClockVerdict>(k)))] = f.states.clocks[k];
  for (const RunReport::Clock& each : f.clocks)
    json["clocks"].push_back({{"name", each.name},
                              {"offset_s", 1e-9 * static_cast<double>(each.clock.offset)},
                              {"drift_ppm", each.clock.drift_known ? Json(1e6 * each.clock.drift) : Json()},
                              {"steps", each.clock.steps}});
  return json;
}

Json injected(const netio::DelayCounts& counts) {
  return {{"passed", counts.passed},
          {"lost", counts.lost},
          {"full", counts.full},
          {"duplicated", counts.duplicated},
          {"corrupted", counts.corrupted}};
}

Json direct_v2v_json(const netio::DirectV2vCounts& direct) {
  return {{"sent", {{"packets", direct.sent.sent}, {"failed", direct.sent.failed}, {"dropped", direct.sent.dropped}}},
          {"packets", direct.packets.total()},
          {"by_reason", reasons(direct.packets)},
          {"duplicates", direct.duplicates},
          {"out_of_radio_range", direct.far},
          {"own", direct.own},
          {"unread", direct.over_rate},
          {"socket_drops", direct.socket_drops}};
}

Json link_json(const server::LinkCounts& link) {
  const netio::ReceiverCounts& in = link.readings;
  return {{"sent", {{"packets", link.sent.sent}, {"failed", link.sent.failed}, {"dropped", link.sent.dropped}}},
          {"readings", link.whole},
          {"stale_readings", link.stale},
          {"sensor_packets",
           {{"packets", in.packets.total()},
            {"by_reason", reasons(in.packets)},
            {"late", in.late},
            {"duplicates", in.duplicates},
            {"leaps", in.jumps},
            {"lost", in.lost},
            {"restarts", in.restarts}}},
          {"relayed", {{"packets", link.packets.total()}, {"by_reason", reasons(link.packets)}}},
          {"socket_drops", link.socket_drops},
          {"injected", {{"out", injected(link.out)}, {"in", injected(link.in)}}}};
}

}  // namespace

std::string device_list_json(const gpu::DeviceList& list) {
  Json rows = Json::array();
  for (const gpu::DeviceInfo& d : list.devices)
    rows.push_back({{"name", d.name},
                    {"driver", d.driver},
                    {"api", d.api},
                    {"kind", d.kind},
                    {"software", d.software},
                    {"self_check", d.self_check},
                    {"chosen", d.chosen},
                    {"reason", d.reason}});
  Json json{{"devices", rows}};
  if (!list.problem.empty()) json["problem"] = list.problem;
  return indented(json);
}

namespace {

Json meshes_json(const world::World& world) {
  Json rows = Json::array();
  const std::vector<std::optional<MeshReport>> reports = mesh_reports(world);
  for (std::size_t i = 0; i < reports.size(); ++i) {
    rows.push_back({{"file", world.meshes[i].file}, {"triangles", world.meshes[i].corners.size() / 3}});
    if (!reports[i]) continue;
    const auto add = [&](const char* name, const MeshReport::Faults& faults) {
      rows.back()[name] = Json{{"count", faults.count}, {"first_triangle", faults.first}};
    };
    rows.back().update(Json{{"bodies", reports[i]->bodies}, {"closed_bodies", reports[i]->closed}});
    add("edges_of_one_triangle", reports[i]->single);
    add("edges_of_three_or_more", reports[i]->shared);
    add("repeated_triangles", reports[i]->repeated);
  }
  return rows;
}

Json terrain_json(const world::World& world) {
  Json rows = Json::array();
  for (const world::Terrain& terrain : world.terrain) {
    const auto [low, high] = std::ranges::minmax(terrain.heights);
    const glm::dvec2 size = world::size_of(terrain);
    rows.push_back({{"file", terrain.file},
                    {"points", {terrain.columns, terrain.rows}},
                    {"size_m", {size.x, size.y}},
                    {"heights_m", {low, high}}});
  }
  return rows;
}

}  // namespace

std::string world_report_json(const world::World& world, const sensors::SensorSet& sensor_set) {
  Json sensors = Json::object(), rates = Json::object();
  for (const sensors::SensorType* type : sensors::sensor_types()) {
    const auto* group = sensor_set.group(type->id);
    sensors[std::string(type->name)] = group == nullptr ? 0 : group->rows.size();
    if (group == nullptr) continue;
    const auto [least, most] = rates_of(*group);
    rates[std::string(type->name)] = {least, most};
  }
  const sensors::MagnetSummary field = sensors::summarize_magnets(world);
  const std::size_t docks = count_docks(world);
  std::size_t segments = world.walls.size();
  for (const world::Mover& mover : world.movers) segments += mover.body.size();
  const world::Extent& e = world.extent;
  return indented({{"world", world.name},
                   {"models", world.models.size()},
                   {"robots", count_robots(world)},
                   {"tags", world.movers.size() - count_robots(world)},
                   {"sensors", sensors},
                   {"rates_hz", rates},
                   {"between_ticks", types_between_ticks(sensor_set, world.interval)},
                   {"segments", world.walls.size()},
                   {"segments_with_movers", segments},
                   {"meshes", world.meshes.size()},
                   {"mesh_triangles", triangles_of(world.meshes)},
                   {"mesh_models", world.mesh_models.size()},
                   {"mesh_files", meshes_json(world)},
                   {"terrain", terrain_json(world)},
                   {"magnets", count_magnets(world)},
                   {"magnet_cutoff_m", field.cutoff_m},
                   {"earth_field_T", {world.earth_field.x, world.earth_field.y, world.earth_field.z}},
                   {"field_truncation_T", field.bound_T},
                   {"field_truncation_height_m", field.height_m},
                   {"paint", world.lane_markings.size()},
                   {"lights", world.lights.size()},
                   {"docks", docks},
                   {"lamps", world.lamps.size()},
                   {"heat_sources", world.heat_sources.size()},
                   {"virtual_walls", world.emitters.size() - docks},
                   {"drops", world.floor_holes.size()},
                   {"paths", world.paths.size()},
                   {"road_resolution_m", world.road_resolution},
                   {"extent", {e.x_min, e.y_min, e.x_max, e.y_max}},
                   {"interval_s", world.interval},
                   {"accuracy", statements_json(sensors::accuracy_statements(world, sensor_set))},
                   {"kept", world.unmodelled},
                   {"hash", base::hash_hex(world.hash)},
                   {"warnings", warnings_json(world.warnings)}});
}

std::string with_warnings(std::string json, const std::vector<world::Warning>& warnings) {
  const std::size_t end = json.find_last_not_of(" \n", json.rfind('}') - 1) + 1;
  return json.insert(end, ",\n  \"warnings\": " + dump_json(warnings_json(warnings)));
}

std::string run_report_json(const RunReport& f) {
  Json json{{"device", f.device},
            {"software_device", f.software},
            {"caster", f.caster},
            {"robots", f.robots},
            {"ticks", f.ticks},
            {"simulated_s", f.simulated_s},
            {"wall_s", f.wall_s},
            {"real_time_factor", f.wall_s > 0.0 ? f.simulated_s / f.wall_s : 0.0},
            {"rays", f.farm.work.rays},
            {"rays_per_s", f.wall_s > 0.0 ? static_cast<double>(f.farm.work.rays) / f.wall_s : 0.0},
            {"readings", f.farm.readings},
            {"given_again", f.farm.reused},
            {"missed", f.farm.missed},
            {"dropped", f.farm.dropped},
            {"batches", f.farm.batches},
            {"beams_in_doubt", f.farm.work.uncertain},
            {"cells_built", f.farm.work.cells_built},
            {"host_scans", f.farm.work.host_scans},
            {"contacts", f.contacts},
            {"hash", base::hash_hex(f.hash)},
            {"interrupted", f.interrupted},
            {"stages_s",
             {{"move", f.move_s},
              {"place", f.farm.place_s},
              {"lists", f.farm.lists_s},
              {"device", f.farm.device_s},
              {"collect", f.farm.collect_s},
              {"out", f.out_s}}}};
  if (f.shared)
    json["shared"] = {{"ranks", f.shared->ranks},
                      {"bytes_per_robot_and_tick", f.shared->bytes},
                      {"wait_s", f.shared->wait_s},
                      {"imbalance", f.shared->imbalance}};
  if (f.shared && f.shared->passed_on) json["shared"]["passed_on"] = *f.shared->passed_on;
  for (std::size_t kind = 0; kind < f.farm.faults.size(); ++kind)
    if (f.farm.faults[kind] > 0) json["faults"][std::string(base::kFaultNames[kind])] = f.farm.faults[kind];
  if (f.farm.work.dipoles > 0) json["dipoles"] = f.farm.work.dipoles;
  if (f.control.robots > 0) json["control"] = control_json(f.control);
  if (f.strayed) json["outside_known_space"] = *f.strayed;
  if (f.sent)
    json["packets"] = {{"sent", f.publisher.packets.sent},
                       {"bytes", f.publisher.packets.sent_bytes},
                       {"failed", f.publisher.packets.failed},
                       {"dropped", f.publisher.packets.dropped},
                       {"not_numbers", f.publisher.not_numbers},
                       {"readings_dropped", f.publisher.dropped},
                       {"first_failure", f.publisher.packets.first_failure}};
  if (f.received) {
    json["received"] = reasons(f.inbox);
    json["socket_drops"] = f.socket_drops;
    const server::LightCounts& heard = f.lights.heard;
    json["lights"] = {{"packets", heard.packets},
                      {"states", heard.states},
                      {"spat", spat_json(heard)},
                      {"silences", heard.silences},
                      {"sent", f.lights.sent}};
    json["relayed"] = {{"states", f.relayed.states}, {"datagrams", f.relayed.datagrams},  {"waited", f.relayed.waited},
                       {"starts", f.relayed.starts}, {"centre", f.relayed.centre},        {"missed", f.relayed.missed},
                       {"drives", f.drives.sent},    {"dropped_drives", f.drives.dropped}};
    json["own_readings"] = {
        {"taken", f.fusion.taken},
        {"incomplete", f.fusion.incomplete},
        {"unfit", f.fusion.unfit},
        {"overtaken", f.fusion.overtaken},
        {"mistimed", f.fusion.mistimed},
        {"fused", f.fusion.fused},
        {"too_old", f.fusion.too_old},
        {"mapped", f.fusion.mapped},
        {"mean_age_s", f.fusion.fused > 0 ? f.fusion.age_s / static_cast<double>(f.fusion.fused) : 0.0},
        {"oldest_s", f.fusion.oldest_s}};
    if (f.filtered) json["states"] = states_json(f);
    json["log_lines_left_out"] = f.lines_left_out;
  }
  if (f.lockstep)
    json["lockstep"] = {{"commands", f.lockstep->commands},
                        {"repeated", f.lockstep->repeated},
                        {"refused", f.lockstep->refused},
                        {"fetched", f.lockstep->fetched},
                        {"lost_robots", f.lockstep->lost_robots}};
  if (!f.recording.empty()) {
    json["recording"] = f.recording;
    json["recording_bytes"] = f.recorded_bytes;
    if (!f.recording_error.empty()) json["recording_error"] = f.recording_error;
  }
  if (!f.video.file.empty())
    json["video"] = {
        {"file", f.video.file}, {"frames", f.video.frames}, {"seconds", f.video.seconds}, {"bytes", f.video.bytes}};
  return indented(json);
}

std::string stream_summary_json(const netio::StreamSummary& s) {
  Json sensors = Json::object();
  for (const auto& [type, share] : s.of) sensors[type] = {{"good", share.good}, {"elements", share.elements}};
  return indented({{"packets", s.datagrams},
                   {"bytes", s.bytes},
                   {"good", s.good},
                   {"rays", count_rays(s)},
                   {"sensors", sensors},
                   {"stale_states", s.stale_states},
                   {"oldest_state_s", 1e-9 * static_cast<double>(s.oldest_state)},
                   {"lost", s.lost},
                   {"duplicates", s.duplicates},
                   {"reordered", s.reordered},
                   {"ports", s.ports},
                   {"silent_ports", s.silent_ports},
                   {"socket_drops", s.socket_drops},
                   {"by_reason", reasons(s.counts)}});
}

std::string reading_json(const world::World& world, const sensors::SensorSet& sensor_set,
                         const base::ReadingBlock& reading) {
  const sensors::SensorType& type = *sensors::find_sensor_type(reading.type);
  Json head{{"robot", world.movers[reading.mover].name},          {"sensor", reading.sensor},
            {"sensor_name", sensor_set.row(reading).name},        {"type", type.name},
            {"pose", body_pose_json(reading.X_WM, reading.tilt)}, {"sensor_pose", pose_json(reading.X_WS)}};
  if (type.bound != nullptr) {
    head["accuracy"] = sensors::word_of(type, reading.mode);
    const double sigma = sensor_set.row(reading).sigma;
    head["bound"] = sigma > 0.0 ? Json() : finite_json(reading.bound);
    if (sigma > 0.0) head.update(noise_json(reading.bound_without_noise, sigma));
  }
  if (const auto X_WS = spatial_pose(sensor_set, reading)) head.update(spatial_pose_json(*X_WS));
  if (type.id == sensors::kCamera) {
    head.update(image_json(
        world, sensor_set.settings_of<sensors::CameraSettings>(sensors::kCamera, reading.mover)[reading.sensor],
        reading));
    return dump_json(head) + "\n";
  }
  if (type.list.empty() && !reading.quality.empty()) head["unsure"] = word_of(reading.quality.front());
  if (type.list.empty()) {
    head.update(element_json(world, sensor_set, reading, 0));
    return dump_json(head) + "\n";
  }
  // Each element has a separate line.
  std::string text = dump_json(head);
  text.back() = ',';
  text += fmt::format("\n\"{}\": [", type.list);
  for (std::uint32_t i = 0; i < reading.values.size() / element_width(type, sensor_set.row(reading)); ++i)
    text += (i == 0 ? "\n  " : ",\n  ") + dump_json(element_json(world, sensor_set, reading, i));
  return text + "\n]}\n";
}

namespace {

Json constant_json(const estimation::Constant& constant) {
  return {{"value", constant.value}, {"sigma", constant.sigma}};
}

/// Errors are known for simulated robots only.
Json own_state_json(const server::OwnStateStats& own) {
  Json json{{"sigma_m", finite_json(own.sigma)}};
  if (own.cameras) json.update({{"packets", own.counts.packets.total()}, {"by_reason", reasons(own.counts.packets)}});
  const control::LocalizationError& e = own.errors;
  if (e.steps > 0)
    json.update({{"compared", e.steps}, {"rms_m", e.rms()}, {"largest_m", e.max}, {"largest_rad", e.yaw_max}});
  const estimation::Calibration& c = own.calibration;
  if (own.gyro) json["gyro"] = {{"bias_rad_s", constant_json(c.gyro_bias)}};
  json["gps"] = own.gps;
  if (own.wheels)
    json["wheels"] = {{"left_scale", constant_json(c.left_scale)},
                      {"right_scale", constant_json(c.right_scale)},
                      {"track_m", constant_json(c.track)}};
  return json;
}

}  // namespace

namespace {

Json real_robot_json(const server::RealRobotStats& real) {
  const server::RealRobotCounts& c = real.counts;
  Json json{{"type", real.type},      {"frames", c.frames}, {"wrong", c.wrong}, {"skipped_bytes", c.skipped_bytes},
            {"timeouts", c.timeouts}, {"starts", c.starts}, {"lines", c.lines}, {"refused", c.refused}};
  json["readings"] = Json::object();
  for (const auto& [type, count] : real.readings) json["readings"][type] = count;
  json["reported"] = Json::object();
  for (const server::RobotFact& fact : real.facts) json["reported"][std::string(fact.name)] = fact.value;
  return json;
}

}  // namespace

std::string robot_client_json(const server::RobotClientStats& f) {
  Json json{{"robot", f.robot},
            {"id", f.id},
            {"controller", f.controller},
            {"farm", f.farm},
            {"wall_s", f.wall_s},
            {"steps", f.steps},
            {"started", f.started},
            {"done", f.done},
            {"answered", f.answered},
            {"drives", {{"followed", f.drives}, {"ignored", f.drives_ignored}}},
            {"contacts", f.contacts},
            {"stops", f.stops},
            {"dropped_by_farm", {{"processor", f.dropped.processor}, {"network", f.dropped.network}}},
            {"log_lines_left_out", f.lines_left_out}};
  json.update(link_json(f.link));
  if (f.link.images) json["images"] = {{"whole", f.link.images->whole}, {"invalid", f.link.images->invalid}};
  if (f.link.direct) json["direct_v2v"] = direct_v2v_json(*f.link.direct);
  if (!f.stop_reason.empty()) json["stop_reason"] = f.stop_reason;
  if (f.own) json["positions"] = own_state_json(*f.own);
  if (f.map)
    json["own_map"] = {{"scans", f.map->scans},
                       {"maps", f.map->maps},
                       {"packets", f.map->sent.sent},
                       {"failed", f.map->sent.failed},
                       {"dropped", f.map->sent.dropped}};
  if (f.team)
    json["team"] = {{"sent", f.team->sent},           {"pieces", f.team->pieces},     {"repeated", f.team->repeated},
                    {"received", f.team->received},   {"changes", f.team->changes},   {"foreign", f.team->foreign},
                    {"malformed", f.team->malformed}, {"beyond_limit", f.team->full}, {"cut_claims", f.team->cut}};
  if (f.real) json["real_robot"] = real_robot_json(*f.real);
  if (f.listens_for_spat) json["spat"] = spat_json(f.lights);
  json["lights"] = {{"packets", f.lights.packets}, {"states", f.lights.states}, {"silences", f.lights.silences}};
  json["distance_m"] = f.distance_m;
  json["pose"] = pose_json(f.pose);
  if (f.error.steps > 0) json["error"] = error_json(f.error);
  return indented(json);
}

namespace {

Json accuracy_json(const scenarios::RecordedAccuracy& accuracy) {
  Json json{{"mode", accuracy.words},
            {"against", "exact"},
            {"with_noise", false},
            {"ticks", accuracy.ticks},
            {"interrupted", accuracy.interrupted},
            {"within_bounds", accuracy.within_bounds()},
            {"notes", accuracy.notes},
            {"types", Json::array()}};
  for (const scenarios::ModeErrors& t : accuracy.types) {
    const scenarios::ErrorDistribution& e = t.errors;
    json["types"].push_back({{"sensor", t.sensor},
                             {"mode", t.mode},
                             {"unit", t.unit},
                             {"recorded_with_noise", t.noisy},
                             {"count", e.count()},
                             {"zero", e.zero()},
                             {"median", finite_json(e.quantile(0.5))},
                             {"p99", finite_json(e.quantile(0.99))},
                             {"max", finite_json(e.max())},
                             {"covered", e.covered()},
                             {"covered_max", e.covered() > 0.0 ? finite_json(e.covered_max()) : Json()},
                             {"bound", finite_json(e.bound())}});
  }
  return json;
}

}  // namespace

std::string verification_json(const scenarios::Verification& verification,
                              const scenarios::RecordedAccuracy* accuracy) {
  const auto compared = [](const scenarios::Comparison& c) {
    return Json{{"type", c.type},           {"readings", c.readings}, {"numbers", c.values},
                {"different", c.different}, {"largest", c.largest},   {"first", c.first}};
  };
  Json json{{"ticks", verification.ticks},
            {"sound", verification.sound() && !verification.interrupted},
            {"interrupted", verification.interrupted},
            {"truncated", verification.truncated},
            {"missing", verification.missing},
            {"damage", verification.damage},
            {"scans", verification.scans},
            {"skipped", verification.skipped},
            {"reference", compared(verification.reference)}};
  json["again"] = Json::array();
  for (const scenarios::Comparison& c : verification.recomputed) json["again"].push_back(compared(c));
  if (accuracy != nullptr) json["accuracy"] = accuracy_json(*accuracy);
  return indented(json);
}

std::string self_test_json(const SelfTestReport& test) {
  Json json{{"device", test.device.name}, {"software", test.device.software},  {"asked", test.asked},
            {"run", test.cases.size()},   {"passed", test.passed()},           {"sound", test.sound()},
            {"seconds", test.seconds},    {"interrupted", test.interrupted()}, {"cases", Json::array()}};
  for (const auto& [c, o] : test.cases)
    json["cases"].push_back({{"group", c->group},
                             {"case", c->name},
                             {"why", c->why},
                             {"ok", o.passed()},
                             {"checks", o.checks},
                             {"failed", o.failed},
                             {"error", o.error},
                             {"allowed", o.allowed},
                             {"unit", c->unit},
                             {"failure", o.failure},
                             {"notes", o.notes},
                             {"seconds", o.seconds}});
  return indented(json);
}

std::string explanation_json(const scenarios::Explanation& e) {
  Json json{{"ticks", e.ticks},        {"build_s", e.build},
            {"first_tick_s", e.first}, {"silent_tick_s", e.silent},
            {"tick_s", e.all},         {"caster", e.caster},
            {"walls", e.walls},        {"resident_bytes", e.resident},
            {"absent", e.absent},      {"types", Json::array()},
            {"slices", Json::array()}, {"accuracy", statements_json(e.statements)}};
  for (const scenarios::WallSlice& s : e.slices)
    json["slices"].push_back({{"z_m", s.z}, {"sensors", s.sensors}, {"walls", s.walls}});
  for (const scenarios::SensorTypeCost& k : e.types) {
    Json tables = Json::array();
    for (const gpu::DeviceAllocation& h : k.tables) tables.push_back({{"name", h.name}, {"bytes", h.bytes}});
    json["types"].push_back({{"type", k.type},
                             {"sensors", k.sensors},
                             {"robots", k.robots},
                             {"rate_hz", {k.least_rate, k.most_rate}},
                             {"tick_s", k.tick},
                             {"readings_per_tick", k.readings},
                             {"given_again_per_tick", k.reused},
                             {"rays", k.work.rays},
                             {"doubts", k.work.uncertain},
                             {"cells_built", k.work.cells_built},
                             {"dipoles", k.work.dipoles},
                             {"movers_near", k.work.movers_in_range},
                             {"movers_met", k.work.movers_visible},
                             {"host_scans", k.work.host_scans},
                             {"kernels", k.kernels},
                             {"bytes", k.bytes},
                             {"tables", tables}});
  }
  return indented(json);
}

std::string mode_results_json(const std::vector<scenarios::ModeResult>& results,
                              const scenarios::AccuracyTarget& target) {
  Json json{{"modes", Json::array()},
            {"advice", scenarios::accuracy_words(results, scenarios::select_modes(results, target))}};
  for (const scenarios::ModeResult& g : results)
    json["modes"].push_back({{"sensor", g.sensor},
                             {"mode", g.mode},
                             {"unit", g.unit},
                             {"rate_per_s", g.rate},
                             {"tick_s", g.tick},
                             {"covered", g.covered},
                             {"covered_max_error", g.covered > 0.0 ? finite_json(g.covered_max) : Json()},
                             {"covered_bound", finite_json(g.bound)},
                             {"all_median_error", finite_json(g.median)},
                             {"all_p99_error", finite_json(g.p99)},
                             {"all_max_error", finite_json(g.max)},
                             {"pareto", g.front}});
  return indented(json);
}

}  // namespace sf::apps
