#pragma once
// Outputs of a run: any combination of a recording, a video and the network.

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "apps/commands/run_video.h"
#include "apps/options/options.h"
#include "apps/reports/report.h"
#include "record/recorder.h"
#include "scenarios/run_info.h"
#include "server/no_return_filter.h"
#include "server/reading_publisher.h"

namespace sf::apps {

class RunOutputs {
 public:
  /// World, sensor set and layout must outlive it.
  /// @param layout of the packets; nullopt: none are sent. @param caster description of the ray caster
  /// @param record folder of the recording; empty: none. @param part of the recording that this process writes
  /// @param video file of the video; empty: none. @throws base::InputError if one of them cannot be written
  RunOutputs(const world::World& world, const sensors::SensorSet& sensor_set,
             const std::optional<server::StreamLayout>& layout, const std::string& caster, const RunOptions& options,
             const std::string& record, const record::RecordingPart& part, const std::string& video);

  /// @param wait called before a reading is sent, with the time [ns] at which it is due: the tick's time or earlier
  void write(base::TickRecord tick, const std::function<void(std::int64_t)>& wait);
  /// Adds robots that joined, in the world's last rows. They are recorded, but their readings are not sent.
  void add_movers(const std::vector<record::JoinedMover>& joined);
  std::vector<std::string> taken_names() const;  ///< see Recorder
  /// Ends recording and video. @param facts receives the counts of what was sent and recorded
  void finish(RunReport& facts);

 private:
  void send();
  void update_bodies();

  const world::World& world_;
  const sensors::SensorSet& sensor_set_;
  scenarios::RunSettings settings_;
  server::NoReturnFilter no_return_filter_;
  std::vector<server::AddressedReading> addressed_readings_;  ///< due at the same time
  std::uint32_t address_ = 0;
  netio::SessionToken session_token_;
  std::optional<server::ReadingPublisher> publisher_;
  std::optional<record::Recorder> recorder_;
  std::optional<RunVideo> video_;
  bool is_whole_;            ///< one process records everything
  std::size_t sent_movers_;  ///< number of movers whose readings have ports
  double seconds_ = 0.0;
};

}  // namespace sf::apps
