#pragma once
// `serve` without its command line: receives the states of robots and sends them readings.
//
//   Service service(world, sensor_set, device, layout, {});
//   service.run(stop, 0.0);        // by the system clock; or, by any clock:
//   service.receive_pending(now);
//   service.tick(now);

#include <atomic>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/tick_record.h"
#include "control/model_controllers.h"
#include "farm/farm.h"
#include "farm/v2v_inputs.h"
#include "gpu/device.h"
#include "sensors/sensor_set.h"
#include "server/drive_relay.h"
#include "server/drop_notices.h"
#include "server/lane_service.h"
#include "server/light_service.h"
#include "server/no_return_filter.h"
#include "server/reading_fusion.h"
#include "server/reading_publisher.h"
#include "server/state_receiver.h"
#include "server/stream_layout.h"
#include "world/world.h"

namespace sf::server {

struct ServiceOptions {
  StateReceiverOptions receiver;
  /// [Hz] of ticks, at which due sensors are read. 0: ticks of the world, and sensors at their own rates.
  double rate = 0.0;
  std::uint64_t seed = 1;
  bool no_return_inf = false;
  // Budgets, beyond which readings are dropped by priority (docs/robots.md#budgets); 0: no limit.
  double processor_budget = 0.0;  ///< [s] processor time of readings per tick
  double network_budget = 0.0;    ///< [byte/s] of readings' datagrams
  /// Lights of the world; their peers are those of `receiver`.
  std::optional<netio::Endpoint> spat;  ///< where to receive SPaT; nullopt: nowhere
  StaleLights stale_lights = StaleLights::dark;
  std::int64_t own_age = FusionOptions{}.max_age;  ///< [ns] see FusionOptions::max_age
  std::optional<netio::Endpoint> mirror;           ///< receives a copy of each reading's packets; nullopt: none
};

struct ServiceStats {
  std::uint32_t robots = 0;  ///< in the world, connected or not
  std::uint64_t ticks = 0;
  double wall_s = 0.0;  ///< [s] of `run`
  farm::FarmStats farm;
  std::uint64_t hash = 0;
  PublisherCounts publisher;
  netio::PacketCounts inbox;
  std::uint64_t socket_drops = 0;  ///< datagrams dropped because the inbox's buffer was full
  netio::RelayCounts relayed;
  LightServiceCounts lights;
  DriveCounts drives;
  FusionCounts fusion;
  netio::OutboxCounts answers;           ///< challenges and relayed datagrams
  std::uint64_t lines_left_out = 0;      ///< dropped from the log
  std::vector<std::string> never_valid;  ///< sensors::DerivedSensors::never_valid
  bool filtered = false;                 ///< states were filtered: `states` and `clocks` are valid
  StateFilterCounts states;
  std::vector<SenderClockState> clocks;
  std::string recording_error;  ///< why the recording ended early; empty: it did not
};

/// Times [ns] are on one monotonic clock that starts at 0. The world, sensor set, device and layout must outlive it.
/// One caller at a time.
class Service {
 public:
  /// @throws netio::PortInUse, base::InputError if the address cannot be bound, as `farm::Farm`, and as
  /// `control::ModelControllers`
  Service(const world::World& world, const sensors::SensorSet& sensor_set, gpu::Device& device,
          const StreamLayout& layout, const ServiceOptions& options);

  /// Adds a sink for each tick. A sample between two ticks is written as a tick of its own. `sink` must outlive the
  /// service. If it throws base::InputError, the error is logged and no more ticks are written to it; robots are still
  /// served.
  void record_to(base::Sink& sink) { sinks_.push_back(&sink); }

  /// Lets OBJECTs and controllers of models change the shapes of objects in `world`, the one given to the constructor.
  /// Without this call OBJECTs are refused with a line in the log, and controllers with an error. Changes are applied
  /// at ticks, at most every kShapePeriod, with those of the same object since then combined.
  void change_shapes_in(world::World& world) { shapes_world_ = &world; }
  static constexpr std::int64_t kShapePeriod = 100'000'000;  ///< [ns]

  /// Serves by the system clock, from time 0, until `stop` is set or `duration` [s] have passed (0: no limit). Call it
  /// once only, and not after `tick`.
  void run(const std::atomic<bool>& stop, double duration);

  /// Reads and sends all due sensors, relays the states of neighbours, and calls the controllers of models.
  /// @throws base::InputError if one of these fails
  void tick(std::int64_t now);
  /// Reads and sends the sensors that are due between two ticks.
  void sample(std::int64_t now) { publish_due(now, true); }
  void receive_pending(std::int64_t now) { receiver_.receive_pending(now); }
  /// [ns] time of the next reading or delivery; farm::kNever: none, or `ServiceOptions::rate` is set.
  std::int64_t next_due() const;

  double interval() const { return interval_; }  ///< [s] per tick
  std::uint16_t port() const { return receiver_.inbox().port(); }
  std::size_t robots() const { return receiver_.robots().size(); }
  StateReceiver& receiver() { return receiver_; }
  const ReadingFusion& fusion() const { return fusion_; }
  const LightService& lights() const { return lights_; }
  const LaneService& lanes() const { return lanes_; }
  /// Takes users' commands for robots. Its packets are sent at each tick.
  DriveRelay& drives() { return drives_; }
  ServiceStats stats() const;

 private:
  class Clock;
  void run_ticks(const Clock& clock, const std::atomic<bool>& stop, double duration);
  void wait_until(const Clock& clock, std::int64_t when, const std::atomic<bool>& stop);
  void publish_due(std::int64_t now, bool between);
  base::SensorTypes subscribed_types(std::uint32_t id, std::int64_t now) const;
  void call_models(std::int64_t now);
  void warn_of_missed(std::int64_t now);
  std::span<const base::Report> update_movers(std::int64_t now);
  void receive_v2v(std::int64_t now, std::span<const base::Report> states);
  void address(std::span<const base::ReadingBlock> readings);
  void note_dropped(std::int64_t now);
  void record(std::int64_t now, std::span<const base::Report> states, std::span<const base::ReadingBlock> readings);
  void change_shapes(std::int64_t now);
  bool change_shape(std::uint32_t row, const world::ShapeChange& change, std::int64_t now);
  bool write(base::Sink& sink, const base::TickRecord& record);

  const world::World& world_;
  const sensors::SensorSet& sensor_set_;
  const StreamLayout& layout_;
  LightService lights_;
  LaneService lanes_;
  StateReceiver receiver_;
  DriveRelay drives_;
  ReadingPublisher publisher_;
  DropNotices drop_notices_;
  ReadingFusion fusion_;
  farm::Farm farm_;
  farm::V2vInputs v2v_inputs_;
  double radio_;                      ///< [m] StateReceiverOptions::radio
  control::ModelControllers models_;  ///< of the objects that no packets move
  std::vector<base::Sink*> sinks_;
  std::vector<base::Report> states_;             ///< per mover, for one tick or sample
  std::vector<base::StateQuality> qualities_;    ///< per mover, for one tick or sample
  std::vector<bool> absent_;                     ///< per mover
  std::vector<base::LightStatus> light_states_;  ///< per light, for one tick or sample
  world::World* shapes_world_ = nullptr;         ///< null: shapes do not change
  std::int64_t next_shapes_ = 0;                 ///< [ns] when shapes may change again
  std::vector<base::ShapeState> shapes_;         ///< changed since the last record
  /// By row: the last refusal of a change of shape, and its time [ns].
  std::map<std::uint32_t, std::pair<std::string, std::int64_t>> refused_;
  std::string recording_error_;
  std::uint64_t records_ = 0;  ///< number written to the sinks
  NoReturnFilter no_return_filter_;
  std::vector<AddressedReading> addressed_readings_;  ///< for one tick
  double interval_;
  bool only_at_ticks_;  ///< `ServiceOptions::rate` is set
  bool warned_of_missed_ = false;
  std::uint64_t ticks_ = 0;
  double wall_s_ = 0.0;
};

}  // namespace sf::server
