// The plug-in: participants of Cyclone DDS.

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsrt/log.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "bridges/dds.h"
#include "bridges/dds/byte_type.h"

namespace sf::bridges {

namespace {

constexpr dds_duration_t kMaxWait = DDS_MSECS(20);  // per write, for slow readers

void require(dds_return_t code, const std::string& what) {
  if (code < 0) throw std::runtime_error(fmt::format("Cyclone DDS {} ({})", what, dds_strretcode(code)));
}

DdsGuid guid_of(dds_entity_t entity) {
  dds_guid_t guid{};
  require(dds_get_guid(entity, &guid), "has no identifier");
  DdsGuid bytes{};
  std::memcpy(bytes.data(), guid.v, bytes.size());
  return bytes;
}

/// Returns settings in the format of CYCLONEDDS_URI, which overrides them and is XML or a file name. The loopback
/// interface has no multicast, so participants are searched on all ports.
std::string configuration_of(const DdsOptions& options) {
  std::string text = "<CycloneDDS><Domain><Internal><MaxSampleSize>64MiB</MaxSampleSize></Internal>";
  if (options.loopback)
    text +=
        "<General><Interfaces><NetworkInterface address=\"127.0.0.1\"/></Interfaces><AllowMulticast>false"
        "</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>32"
        "</MaxAutoParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>";
  text += "</Domain></CycloneDDS>";
  const char* const users = std::getenv("CYCLONEDDS_URI");
  return users != nullptr && *users != 0 ? text + "," + users : text;
}

struct DeleteQos {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, DeleteQos>;

/// Returns the quality of service of rmw_cyclonedds, except that a write does not block indefinitely.
Qos qos_of(const DdsEndpoint& endpoint) {
  Qos qos(dds_create_qos());
  dds_qset_writer_data_lifecycle(qos.get(), false);
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, endpoint.depth);
  dds_qset_reliability(qos.get(), endpoint.best_effort ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE,
                       kMaxWait);
  dds_qset_durability(qos.get(), endpoint.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (endpoint.latched)
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, endpoint.depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  dds_qset_userdata(qos.get(), endpoint.user_data.data(), endpoint.user_data.size());
  return qos;
}

struct DeleteListener {
  void operator()(dds_listener_t* listener) const { dds_delete_listener(listener); }
};
using Listener = std::unique_ptr<dds_listener_t, DeleteListener>;

struct FreeEndpoint {
  void operator()(dds_builtintopic_endpoint_t* endpoint) const { dds_builtintopic_free_endpoint(endpoint); }
};
using EndpointData = std::unique_ptr<dds_builtintopic_endpoint_t, FreeEndpoint>;

struct Writer {
  dds_entity_t entity = 0;
  const ddsi_sertype* type = nullptr;
  std::atomic<std::size_t> readers{0};
};

struct Reader {
  dds_entity_t entity = 0;
  std::size_t number = 0;
  const DdsOptions* options = nullptr;
  bool requests = false;
};

/// Returns false for a writer that has left, because its client expects no answer.
bool is_of_own_kind(dds_entity_t reader, dds_instance_handle_t writer) {
  const EndpointData data(dds_get_matched_publication_data(reader, writer));
  if (data == nullptr) return false;
  DdsGuid guid{};
  std::memcpy(guid.data(), data->key.v, guid.size());
  return has_request_header(guid);
}

void count_readers_of(dds_entity_t, const dds_publication_matched_status_t status, void* writer) {
  static_cast<Writer*>(writer)->readers = status.current_count;
}

void receive_all(dds_entity_t entity, void* argument) {
  constexpr std::uint32_t kAtOnce = 16;
  const auto& reader = *static_cast<const Reader*>(argument);
  ddsi_serdata* samples[kAtOnce];
  dds_sample_info_t infos[kAtOnce];
  dds_return_t count = 0;
  while ((count = dds_takecdr(entity, samples, kAtOnce, infos, DDS_ANY_STATE)) > 0) {
    for (dds_return_t i = 0; i < count; ++i) {
      const auto bytes = bytes_of(samples[i]);
      const auto sender = infos[i].publication_handle;
      if (infos[i].valid_data && (!reader.requests || is_of_own_kind(entity, sender)))
        reader.options->receive({reader.number, sender, {bytes.begin(), bytes.end()}});
      ddsi_serdata_unref(samples[i]);
    }
  }
}

void pass_on(void* options, const dds_log_data_t* line) {
  static_cast<const DdsOptions*>(options)->log({line->message, line->size});
}

class CycloneParticipant : public DdsParticipant {
 public:
  explicit CycloneParticipant(const DdsOptions& options) : options_(options) {
    if (options_.log) dds_set_log_sink(pass_on, const_cast<DdsOptions*>(&options_));
    try {
      start();
    } catch (...) {
      end();
      throw;
    }
  }
  CycloneParticipant(const CycloneParticipant&) = delete;
  CycloneParticipant& operator=(const CycloneParticipant&) = delete;
  ~CycloneParticipant() override { end(); }

  DdsGuid guid() const override { return guid_of(participant_); }

  std::size_t add_writer(const DdsEndpoint& endpoint, DdsGuid& guid) override {
    auto& writer = *writers_.emplace_back(std::make_unique<Writer>());
    Listener listener(dds_create_listener(&writer));
    dds_lset_publication_matched(listener.get(), count_readers_of);
    const dds_entity_t topic = add_topic(endpoint, &writer.type);
    writer.entity = dds_create_writer(participant_, topic, qos_of(endpoint).get(), listener.get());
    require(writer.entity, "opens no writer of " + endpoint.topic);
    guid = guid_of(writer.entity);
    return writers_.size() - 1;
  }

  std::size_t add_reader(const DdsEndpoint& endpoint, DdsGuid& guid) override {
    auto& reader = *readers_.emplace_back(std::make_unique<Reader>());
    reader.number = readers_.size() - 1;
    reader.options = &options_;
    reader.requests = endpoint.requests;
    Listener listener(dds_create_listener(&reader));
    dds_lset_data_available(listener.get(), receive_all);
    reader.entity =
        dds_create_reader(participant_, add_topic(endpoint, nullptr), qos_of(endpoint).get(), listener.get());
    require(reader.entity, "opens no reader of " + endpoint.topic);
    guid = guid_of(reader.entity);
    return reader.number;
  }

  bool write(std::size_t writer, const base::Bytes& message) override {
    const Writer& to = *writers_[writer];
    return dds_forwardcdr(to.entity, new_byte_sample(to.type, message)) == DDS_RETCODE_OK;
  }

  std::size_t count_readers(std::size_t writer) const override { return writers_[writer]->readers; }

  bool can_answer(std::size_t writer, std::size_t reader, std::uint64_t sender) const override {
    const EndpointData asks(dds_get_matched_publication_data(readers_[reader]->entity, sender));
    if (asks == nullptr) return true;
    const dds_entity_t from = writers_[writer]->entity;
    std::vector<dds_instance_handle_t> readers(writers_[writer]->readers + 16);
    const dds_return_t count = dds_get_matched_subscriptions(from, readers.data(), readers.size());
    readers.resize(std::clamp<std::size_t>(count < 0 ? 0 : count, 0, readers.size()));
    return std::any_of(readers.begin(), readers.end(), [&](dds_instance_handle_t one) {
      const EndpointData hears(dds_get_matched_subscription_data(from, one));
      return hears != nullptr && std::memcmp(&hears->participant_key, &asks->participant_key, sizeof(dds_guid_t)) == 0;
    });
  }

 private:
  void start() {
    domain_ = dds_create_domain(options_.domain, configuration_of(options_).c_str());
    if (domain_ != DDS_RETCODE_PRECONDITION_NOT_MET)  // this process has already joined that domain
      require(domain_,
              "does not start in domain " + std::to_string(options_.domain) + "; check CYCLONEDDS_URI, if set");
    Qos qos(dds_create_qos());
    dds_qset_userdata(qos.get(), options_.user_data.data(), options_.user_data.size());
    participant_ = dds_create_participant(options_.domain, qos.get(), nullptr);
    require(participant_, "opens no participant in domain " + std::to_string(options_.domain));
  }

  void end() {
    if (participant_ > 0) dds_delete(participant_);
    if (domain_ > 0) dds_delete(domain_);
    dds_set_log_sink(nullptr, nullptr);
  }

  /// @param type out: of the topic's samples; lives as long as the topic
  dds_entity_t add_topic(const DdsEndpoint& endpoint, const ddsi_sertype** type) {
    ddsi_sertype* wanted = new_byte_type(endpoint.type.c_str());
    const dds_entity_t topic =
        dds_create_topic_sertype(participant_, endpoint.topic.c_str(), &wanted, nullptr, nullptr, nullptr);
    if (topic < 0) ddsi_sertype_unref(wanted);
    require(topic, "opens no topic " + endpoint.topic);
    if (type != nullptr) *type = wanted;
    return topic;
  }

  const DdsOptions options_;
  dds_entity_t domain_ = 0, participant_ = 0;
  std::vector<std::unique_ptr<Writer>> writers_;
  std::vector<std::unique_ptr<Reader>> readers_;
};

/// Cyclone DDS crashes if it runs out of descriptors while it starts.
void require_descriptors() {
  constexpr std::size_t kNeeded = 16;
  std::vector<int> opened;
  while (opened.size() < kNeeded) {
    const int one = ::open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (one < 0) break;
    opened.push_back(one);
  }
  for (const int one : opened) ::close(one);
  if (opened.size() < kNeeded)
    throw std::runtime_error("only " + std::to_string(opened.size()) + " more files and sockets can be opened, but " +
                             std::to_string(kNeeded) + " are required; raise the limit (ulimit -n)");
}

std::unique_ptr<DdsParticipant> open(const DdsOptions& options) {
  require_descriptors();
  return std::make_unique<CycloneParticipant>(options);
}

}  // namespace
}  // namespace sf::bridges

extern "C" {
extern const sf::bridges::DdsLibrary sensorfarm_dds;
const sf::bridges::DdsLibrary sensorfarm_dds{sf::bridges::open};
}
