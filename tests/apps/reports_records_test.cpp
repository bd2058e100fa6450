// Reports with every count set, and with none, compared with golden records: includes rows that a run on one machine
// does not show.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "apps/reports/report.h"
#include "apps/reports/robot_report.h"
#include "apps/reports/vps_report.h"
#include "tests/apps/golden.h"
#include "tests/apps/json.h"

namespace sf::apps {

namespace {

void fill(netio::PacketCounts& counts, std::uint64_t first) {
  for (std::uint64_t& count : counts.of) count = first++;
}

netio::OutboxCounts outbox(std::uint64_t sent) {
  return {.sent = sent, .sent_bytes = 2'345'678, .failed = 3, .dropped = 4, .first_failure = "192.0.2.1:1: no route"};
}

/// Robots at rest for six reasons: one more than the text shows.
ControlReport control_report() {
  ControlReport f{.controller = "route", .robots = 9, .done = 2, .error = {11, -0.0125, 0.25}};
  f.has_goals = true;
  f.checkpoints = 12;
  f.localization = {.steps = 4, .squares = 1.0, .yaw_squares = 0.04, .max = 0.75};
  for (std::uint64_t i = 0; i < 6; ++i)
    f.standing.push_back(
        {fmt::format("reason {}", i), {"a", "b", "c"}, i < 3 ? 3 + i : 1, 3.6 + static_cast<double>(i)});
  return f;
}

void set_service(RunReport& f) {
  f.sent = f.received = f.filtered = true;
  f.publisher = {.packets = outbox(21), .dropped = 9, .not_numbers = 5};
  fill(f.inbox, 1);
  f.socket_drops = 31;
  f.relayed = {.states = 32, .datagrams = 33, .waited = 34, .starts = 35, .centre = 301, .missed = 302};
  f.drives = {.sent = 36, .dropped = 37};
  f.fusion = {.taken = 38,
              .incomplete = 39,
              .unfit = 40,
              .overtaken = 41,
              .mistimed = 42,
              .fused = 43,
              .too_old = 44,
              .mapped = 45,
              .age_s = 4.3,
              .oldest_s = 0.25};
  f.lights = {{.states = 41, .messages = 42, .others = 43, .invalid = 44, .packets = 45, .refused = 46, .silences = 47},
              48};
  for (std::size_t k = 0; k < f.states.states.size(); ++k) f.states.states[k] = 50 + k;
  f.states.clocks = {61, 62, 63, 64};
  f.states.flooded = 65;
  for (std::uint64_t i = 0; i < 7; ++i)
    f.clocks.push_back({fmt::format("robot{}", i),
                        {.offset = 1'500'000 * static_cast<std::int64_t>(i) - 3'000'000,
                         .drift = 1.25e-5,
                         .synchronised = true,
                         .drift_known = i % 2 == 0,
                         .steps = i % 3}});
  f.lines_left_out = 66;
  f.lockstep = server::LockstepCounts{71, 72, 73, 74, 75};
}

RunReport full_report() {
  RunReport f{.device = "GPU", .software = true, .caster = "host", .robots = 9, .ticks = 200, .simulated_s = 20.0};
  f.wall_s = 0.5;
  f.contacts = 13;
  f.control = control_report();
  f.move_s = 0.1, f.out_s = 0.2;
  f.farm = {.ticks = 200, .readings = 14, .missed = 15, .reused = 16, .batches = 17};
  f.farm.work = {.rays = 4'000'000, .uncertain = 18, .cells_built = 19, .dipoles = 20'000, .host_scans = 2};
  f.farm.place_s = 0.01, f.farm.lists_s = 0.02, f.farm.device_s = 0.03, f.farm.collect_s = 0.04;
  f.hash = 0x123456789abcdef0;
  f.interrupted = true;
  set_service(f);
  f.recording = "r/run.mcap", f.recorded_bytes = 4'560'000, f.recording_error = "disk full";
  f.shared = RankReport{.ranks = 4, .bytes = 80.6, .wait_s = 0.06, .passed_on = 77, .imbalance = 1.234};
  return f;
}

scenarios::Verification verification(std::uint64_t different, double largest) {
  scenarios::Verification v{.ticks = 30};
  v.recomputed.push_back({"laser", 1, 7, different, largest, "tick 3"});
  v.reference = {"laser", 5, 35, 0, 0.0, ""};
  v.scans = 6;
  v.missing = different;
  v.interrupted = largest > 0.0;
  v.skipped = {"bumpers"};
  if (different > 1) v.damage = {"chunk 3"};
  return v;
}

server::RobotClientStats robot_stats() {
  server::RobotClientStats f{.robot = "anna", .id = 7, .controller = "route", .farm = "127.0.0.1:9000", .wall_s = 2.5};
  f.steps = 25, f.drives = 5, f.drives_ignored = 6, f.contacts = 2, f.stops = 3, f.dropped = {8, 9},
  f.lines_left_out = 4, f.distance_m = 1.25, f.done = true;
  f.started = false;
  f.pose = {1.0, -2.0, 0.0, 0.5};
  f.link.sent = outbox(51);
  f.link.out = {11, 12, 13, 14, 15};
  f.link.in = {21, 22, 0, 24, 25};
  fill(f.link.readings.packets, 1);
  f.link.readings.late = 31, f.link.readings.duplicates = 1, f.link.readings.jumps = 33, f.link.readings.lost = 34;
  f.link.readings.restarts = 35;
  fill(f.link.packets, 3);
  f.link.socket_drops = 41, f.link.stale = 42, f.link.whole = {{"gps", 43}, {"laser", 44}};
  f.link.direct = netio::DirectV2vCounts{outbox(61), {}, 62, 63, 64, 65, 66, 0};
  fill(f.link.direct->packets, 4);
  f.error = {5, 0.5, 0.75};
  f.own = {.cameras = true, .wheels = true, .errors = {4, 0.0004, 0.0, 0.015, 0.1}, .sigma = 0.0125};
  fill(f.own->counts.packets, 2);
  f.own->calibration = {{1.05, 0.0025}, {1.04, 0.003}, {0.26, 0.004}, {0.0, 0.0}};
  f.real = {.type = "create",
            .counts = {71, 72, 73, 1, 75, 76, 77},
            .facts = {{"battery_V", 14.2}, {"wall", 0.0}},
            .readings = {{"bumper", 78}, {"cliff", 79}}};
  f.map = server::OwnMapCounts{81, 82, outbox(83)};
  f.team = {.sent = 101,
            .pieces = 102,
            .repeated = 103,
            .cut = 1,
            .received = 104,
            .changes = 105,
            .malformed = 106,
            .foreign = 107,
            .full = 108};
  f.listens_for_spat = true;
  f.lights = {.states = 91, .messages = 92, .others = 93, .invalid = 94, .packets = 95, .refused = 96, .silences = 97};
  return f;
}

VpsReport vps_report() {
  VpsReport r{.cameras = {"west", "east"}, .refused = 6, .processing_s = 0.5, .processing_cpu_s = 1.5};
  r.orientation = "upright";
  r.counts = {.images = 10,
              .unreadable = 1,
              .sightings = 20,
              .unwanted = 2,
              .unlisted = 3,
              .unfitted = 4,
              .misfitted = 5,
              .repeated = 8,
              .frozen = 7,
              .asleep = 4};
  r.tags[3] = {3, 1.5, {1.0, -2.0, 0.1, 0.5}, {0.3, 0.4}, -0.25, 2, 0.012, 0.05, -0.1, 0.02};
  r.reported[3] = 18;
  r.accuracy =
      vision::Accuracy{{0.0004, 0.015, 4}, {0.01, 0.06, 4}, {0.04, 0.15, 4}, {0.09, 0.2, 1}, 8, 9, {0.0004, 0.012, 4}};
  r.follow = vision::FollowCounts{.cameras = {{1, 2, 3, 2, 500, 1000}, {4, 5, 6, 0, 10, 1000}},
                                  .tags = {{3, {11, 12, 13, 0.5}}},
                                  .starts = 1,
                                  .stops = 2};
  r.sent = outbox(17);
  r.unaddressed = 2;
  r.truth = TruthCounts{3, 44, 5};
  return r;
}

netio::StreamSummary summary() {
  netio::StreamSummary s{.datagrams = 100, .bytes = 2'500'000, .good = 90, .counts = {}, .stale_states = 1};
  fill(s.counts, 0);
  s.oldest_state = 250'000'000, s.lost = 5, s.duplicates = 1, s.reordered = 7, s.ports = 1, s.silent_ports = 2;
  s.socket_drops = 8;
  s.of = {{"laser", {60, 4321}}, {"gps", {30, 30}}};
  return s;
}

template <class Report>
std::string both(std::string (&text)(const Report&), std::string (&json)(const Report&), const Report& report) {
  return text(report) + json(report);
}

}  // namespace

TEST(ReportRecords, ARunShowsEveryCount) {
  expect_golden("report_run", both(run_report_text, run_report_json, full_report()));
}

/// From a million rays per second on, rates are in millions.
TEST(ReportRecords, RatesAreInMillionsFromOneOn) {
  for (const auto& [rays, text] :
       {std::pair{999'999u, "999999/s of"}, {1'000'000u, "1.0 million/s of"}, {1'250'000u, "1.2 million/s of"}}) {
    RunReport f{.device = "GPU", .caster = "host"};
    f.wall_s = 1.0;
    f.farm.work.rays = rays;
    EXPECT_NE(run_report_text(f).find(std::string(", ") + text), std::string::npos) << run_report_text(f);
  }
}

TEST(ReportRecords, AnEmptyRunShowsNoRowsOfServices) {
  expect_golden("report_run_empty", run_report_text(RunReport{}));
}

TEST(ReportRecords, EmptyReportsHaveNoMembersOfServices) {
  const std::pair<std::string, std::vector<std::string>> reports[] = {
      {run_report_json({}),
       {"shared", "dipoles", "control", "packets", "received", "socket_drops", "lights", "relayed", "states",
        "log_lines_left_out", "lockstep", "recording"}},
      {robot_client_json({}), {"positions", "own_map", "real_robot", "spat", "error", "localization", "direct_v2v"}},
      {vps_report_json({}), {"accuracy", "truth", "packets", "follow", "refused/not_followed"}}};
  for (const auto& [json, absent] : reports)
    for (const std::string& name : absent) EXPECT_FALSE(Json(json).has("/" + name)) << name;
}

TEST(ReportRecords, ARobotShowsEveryCount) {
  expect_golden("report_robot", both(robot_client_text, robot_client_json, robot_stats()) +
                                    robot_client_text(server::RobotClientStats{}));
}

TEST(ReportRecords, AVerificationShowsDifferencesDamageAndVerdict) {
  std::string text;
  for (const auto& [different, largest] : {std::pair<std::uint64_t, double>{0, 0.0}, {0, 0.125}, {1, 0.5}, {2, 3.0}})
    text += verification_text(verification(different, largest), different == 0);
  text += verification_json(verification(2, 3.0));
  scenarios::RecordedAccuracy accuracy{.words = "skip2", .ticks = 30, .types = {}, .notes = {"a note"}};
  text += recorded_accuracy_text(accuracy);
  accuracy.types = {{.sensor = "laser", .mode = "skip2", .unit = "m", .noisy = true, .errors = {}},
                    {.sensor = "magnetometer", .mode = "near1", .unit = "T", .errors = {}}};
  for (const double error : {0.0, 0.25, 0.5}) accuracy.types[0].errors.add(error, 0.0, error < 0.5 ? 0.125 : HUGE_VAL);
  accuracy.types[1].errors.add(NAN, 1e-6, HUGE_VAL);
  accuracy.interrupted = true;
  text += recorded_accuracy_text(accuracy) + verification_json(verification(0, 0.0), &accuracy);
  expect_golden("report_verification", text);
}

TEST(ReportRecords, VpsAndStreamsShowEveryCount) {
  expect_golden("report_vps", both(vps_report_text, vps_report_json, vps_report()) + vps_report_text(VpsReport{}));
  expect_golden("report_streams", both(stream_summary_text, stream_summary_json, summary()) +
                                      stream_summary_text(netio::StreamSummary{}));
}

}  // namespace sf::apps
