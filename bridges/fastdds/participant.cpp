// Fast DDS participants with the endpoints of services, for clients of rmw_fastrtps. These name the reader of their
// reply in the metadata of a request, and expect the request's number in the metadata of the reply
// (`related_sample_identity` of DDS-RPC), which Cyclone DDS neither reads nor writes. Here both are converted to the
// header of rmw_cyclonedds.

#include "bridges/fastdds/participant.h"
#include <fastdds/rtps/common/WriteParams.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <algorithm>
#include <cstring>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <vector>

namespace sf::bridges {

namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

constexpr std::size_t kEncapsulation = 4, kHeader = 16;  // [byte] of a message, and of rmw_cyclonedds
constexpr std::uint32_t kMaxRequest = 1 << 18;           // [byte] Fast DDS drops longer ones
constexpr int kMaxSamples = 32;                          // kept by a reader, of that size
constexpr std::size_t kMaxPending = 8192;                // requests without a reply; beyond it, the oldest are dropped
constexpr int kMaxWaitMs = 20;                           // per write, for slow readers
constexpr std::uint32_t kPeers = 33;  // participants per machine on the loopback interface, as for Cyclone DDS

template <class T>
T* require(T* made, const std::string& what) {
  if (made == nullptr) throw std::runtime_error("Fast DDS " + what);
  return made;
}

DdsGuid bytes_of(const rtps::GUID_t& guid) {
  DdsGuid bytes{};
  std::memcpy(bytes.data(), guid.guidPrefix.value, 12);
  std::memcpy(bytes.data() + 12, guid.entityId.value, 4);
  return bytes;
}

/// A type whose samples are messages as bytes, with their encapsulation.
class ByteType : public dds::TopicDataType {
 public:
  ByteType(const std::string& name, std::uint32_t size) {
    setName(name.c_str());
    m_typeSize = size;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<const base::Bytes*>(data);
    if (payload->max_size < bytes.size()) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<base::Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<const base::Bytes*>(data)->size()); };
  }
  void* createData() override { return new base::Bytes; }
  void deleteData(void* data) override { delete static_cast<base::Bytes*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

/// Redirects the library's log, which would otherwise go to standard output.
class LogToOptions : public dds::LogConsumer {
 public:
  explicit LogToOptions(const DdsOptions& options) : options_(options) {}
  void Consume(const dds::Log::Entry& entry) override {
    if (options_.log && entry.kind != dds::Log::Info) options_.log(entry.message);
  }

 private:
  const DdsOptions& options_;
};

/// Uses only UDP over IPv4, because shared memory would leave files behind when a process is killed. On the loopback
/// interface, searches participants at all their ports, because multicast may be unavailable.
dds::DomainParticipantQos qos_of(const DdsOptions& options) {
  dds::DomainParticipantQos qos;
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.assign(options.addresses.begin(), options.addresses.end());
  if (options.loopback) udp->interfaceWhiteList = {"127.0.0.1"};
  udp->maxInitialPeersRange = kPeers;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  auto& builtin = qos.wire_protocol().builtin;
  builtin.readerHistoryMemoryPolicy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  builtin.writerHistoryMemoryPolicy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  if (options.loopback) {
    rtps::Locator_t here;
    rtps::IPLocator::setIPv4(here, "127.0.0.1");
    builtin.initialPeersList.push_back(here);
  }
  qos.user_data().assign(options.user_data.begin(), options.user_data.end());
  return qos;
}

template <class Qos>
void set_common(Qos& qos, const DdsEndpoint& endpoint) {
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.reliability().max_blocking_time = {0, kMaxWaitMs * 1'000'000};
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = endpoint.depth;
  qos.data_sharing().off();
  qos.user_data().assign(endpoint.user_data.begin(), endpoint.user_data.end());
}

/// A request without a reply.
struct Pending {
  rtps::GUID_t writer, reply_to;
  rtps::SequenceNumber_t sequence;
};

class FastParticipant : public DdsParticipant, dds::DomainParticipantListener {
 public:
  explicit FastParticipant(const DdsOptions& options) : options_(options) {
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<LogToOptions>(options_));
    const dds::StatusMask events = dds::StatusMask::data_available()
                                   << dds::StatusMask::publication_matched() << dds::StatusMask::subscription_matched();
    auto* const factory = dds::DomainParticipantFactory::get_instance();
    participant_ = factory->create_participant(options_.domain, qos_of(options_), this, events);
    try {
      require(participant_, fmt::format("opens no participant in domain {}", options_.domain));
      publisher_ = require(participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT), "opens no publisher");
      subscriber_ = require(participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT), "opens no subscriber");
    } catch (...) {
      end();
      throw;
    }
  }
  FastParticipant(const FastParticipant&) = delete;
  FastParticipant& operator=(const FastParticipant&) = delete;
  ~FastParticipant() override { end(); }

  DdsGuid guid() const override { return bytes_of(participant_->guid()); }

  std::size_t add_writer(const DdsEndpoint& endpoint, DdsGuid& guid) override {
    dds::DataWriterQos qos;
    set_common(qos, endpoint);
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    dds::Topic* const topic = add_topic(endpoint, 1024);
    writers_.push_back(require(publisher_->create_datawriter(topic, qos), "opens no writer of " + endpoint.topic));
    guid = bytes_of(writers_.back()->guid());
    return writers_.size() - 1;
  }

  /// Uses fixed sizes, so that the size stated in a datagram cannot make the reader allocate memory.
  std::size_t add_reader(const DdsEndpoint& endpoint, DdsGuid& guid) override {
    dds::DataReaderQos qos;
    set_common(qos, endpoint);
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_MEMORY_MODE;
    auto& limits = qos.resource_limits();
    limits.max_instances = 1;
    limits.max_samples = limits.max_samples_per_instance = kMaxSamples;
    limits.allocated_samples = 1;
    dds::Topic* const topic = add_topic(endpoint, kMaxRequest);
    dds::DataReader* const made =
        require(subscriber_->create_datareader(topic, qos), "opens no reader of " + endpoint.topic);
    const std::lock_guard lock(mutex_);
    readers_.push_back(made);
    guid = bytes_of(made->guid());
    return readers_.size() - 1;
  }

  bool write(std::size_t writer, const base::Bytes& message) override {
    if (message.size() < kEncapsulation + kHeader) return false;
    std::uint64_t number = 0;
    std::memcpy(&number, message.data() + kEncapsulation, sizeof number);
    rtps::WriteParams params;
    {
      const std::lock_guard lock(mutex_);
      const auto found = pending_.find(number);
      if (found == pending_.end()) return false;
      params.related_sample_identity().writer_guid(found->second.reply_to);
      params.related_sample_identity().sequence_number(found->second.sequence);
      pending_.erase(found);
    }
    base::Bytes reply(message.begin(), message.begin() + kEncapsulation);
    reply.insert(reply.end(), message.begin() + kEncapsulation + kHeader, message.end());
    return writers_[writer]->write(&reply, params);
  }

  std::size_t count_readers(std::size_t writer) const override {
    const std::lock_guard lock(mutex_);
    const auto found = matched_.find(writers_[writer]);
    return found == matched_.end() ? 0 : found->second.size();
  }

  bool can_answer(std::size_t writer, std::size_t reader, std::uint64_t sender) const override {
    const std::lock_guard lock(mutex_);
    const auto request = pending_.find(sender);
    const auto read_by = matched_.find(writers_[writer]), written_by = matched_.find(readers_[reader]);
    const bool gone = request == pending_.end() || written_by == matched_.end() ||
                      !written_by->second.contains(request->second.writer);
    if (gone || read_by == matched_.end()) return gone;
    const rtps::GUID_t& to = request->second.reply_to;
    constexpr std::uint8_t kIsReader = 0x04;  // in entity ids; otherwise `to` is the request's writer
    if ((to.entityId.value[3] & kIsReader) != 0) return read_by->second.contains(to);
    return std::any_of(read_by->second.begin(), read_by->second.end(),
                       [&](const rtps::GUID_t& one) { return one.guidPrefix == to.guidPrefix; });
  }

 private:
  void on_data_available(dds::DataReader* reader) override {
    base::Bytes message;
    dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data) receive(reader, message, info);
  }
  void on_publication_matched(dds::DataWriter* writer, const dds::PublicationMatchedStatus& status) override {
    match(writer, rtps::iHandle2GUID(status.last_subscription_handle), status.current_count_change);
  }
  void on_subscription_matched(dds::DataReader* reader, const dds::SubscriptionMatchedStatus& status) override {
    match(reader, rtps::iHandle2GUID(status.last_publication_handle), status.current_count_change);
  }

  void match(const void* ours, const rtps::GUID_t& other, int change) {
    const std::lock_guard lock(mutex_);
    if (change > 0) matched_[ours].insert(other);
    if (change < 0) matched_[ours].erase(other);
  }

  /// Forwards a request with the header of rmw_cyclonedds: its number here and its sequence number.
  void receive(const dds::DataReader* reader, const base::Bytes& message, const dds::SampleInfo& info) {
    const rtps::SampleIdentity& from = info.sample_identity;
    if (message.size() < kEncapsulation || has_request_header(bytes_of(from.writer_guid()))) return;
    const rtps::GUID_t& named = info.related_sample_identity.writer_guid();
    DdsMessage request;
    {
      const std::lock_guard lock(mutex_);
      const auto found = std::find(readers_.begin(), readers_.end(), reader);
      if (found == readers_.end()) return;
      request.reader = static_cast<std::size_t>(found - readers_.begin());
      request.sender.writer = ++last_;
      const bool is_named = named != rtps::GUID_t::unknown();
      pending_[last_] = {from.writer_guid(), is_named ? named : from.writer_guid(), from.sequence_number()};
      if (pending_.size() > kMaxPending) pending_.erase(pending_.begin());
    }
    const std::uint64_t header[] = {request.sender.writer, from.sequence_number().to64long()};
    static_assert(sizeof header == kHeader);
    request.bytes.assign(message.begin(), message.begin() + kEncapsulation);
    base::ByteWriter(request.bytes).put_bytes(header, sizeof header);
    request.bytes.insert(request.bytes.end(), message.begin() + kEncapsulation, message.end());
    options_.receive(std::move(request));
  }

  /// @param size [byte] of a sample, for preallocation
  dds::Topic* add_topic(const DdsEndpoint& endpoint, std::uint32_t size) {
    if (types_.insert(endpoint.type).second)
      dds::TypeSupport(new ByteType(endpoint.type, size)).register_type(participant_);
    return require(participant_->create_topic(endpoint.topic, endpoint.type, dds::TOPIC_QOS_DEFAULT),
                   "opens no topic " + endpoint.topic);
  }

  void end() {
    if (participant_ != nullptr) {
      participant_->set_listener(nullptr);
      participant_->delete_contained_entities();
      dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
    }
    dds::Log::ClearConsumers();
  }

  const DdsOptions options_;
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  std::set<std::string> types_;
  std::vector<dds::DataWriter*> writers_;

  mutable std::mutex mutex_;  // protects the members below from the library's threads; not held in calls of the library
  std::vector<dds::DataReader*> readers_;
  std::map<const void*, std::set<rtps::GUID_t>> matched_;  ///< matched remote endpoints, by own endpoint
  std::map<std::uint64_t, Pending> pending_;
  std::uint64_t last_ = 0;
};

}  // namespace

std::unique_ptr<DdsParticipant> open_fast_dds(const DdsOptions& options) {
  return std::make_unique<FastParticipant>(options);
}

}  // namespace sf::bridges
