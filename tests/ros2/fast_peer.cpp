#include "tests/ros2/fast_peer.h"

#include <fastdds/rtps/common/WriteParams.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>

#include <chrono>
#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>
#include <stdexcept>

namespace sf::ros2 {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using base::Bytes;

namespace {

/// A type whose samples are messages as bytes, with their encapsulation.
class ByteType : public dds::TopicDataType {
 public:
  explicit ByteType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 1 << 20;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<const Bytes*>(data);
    if (payload->max_size < bytes.size()) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size()); };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

dds::DomainParticipantQos on_loopback() {
  dds::DomainParticipantQos qos;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.push_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  rtps::Locator_t peer;
  rtps::IPLocator::setIPv4(peer, "127.0.0.1");
  qos.wire_protocol().builtin.initialPeersList.push_back(peer);
  return qos;
}

template <class Qos>
void set_quality(Qos& qos, bool latched, bool reliable) {
  qos.reliability().kind = reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 100;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

template <class T>
T* require(T* made, const char* what) {
  if (made == nullptr) throw std::runtime_error(what);
  return made;
}

}  // namespace

struct FastPeer::Impl : dds::DomainParticipantListener {
  mutable std::mutex mutex;
  mutable std::condition_variable changed;
  std::vector<Endpoint> others;
  std::vector<std::string> participants;
  std::map<std::string, dds::Topic*> topics;  ///< by name and type
  std::vector<dds::DataReader*> readers;
  std::vector<dds::DataWriter*> writers;
  std::map<const dds::DataReader*, std::vector<Bytes>> come;
  std::map<const dds::DataReader*, std::vector<std::pair<std::int64_t, Bytes>>> replies;
  std::map<const void*, int> matched;
  dds::DomainParticipant* participant = nullptr;
  dds::Publisher* publisher = nullptr;
  dds::Subscriber* subscriber = nullptr;

  template <class Act>
  void note(Act&& act) {
    {
      const std::lock_guard lock(mutex);
      act();
    }
    changed.notify_all();
  }

  void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& info) override {
    if (info.status != rtps::ParticipantDiscoveryInfo::DISCOVERED_PARTICIPANT) return;
    const auto& data = info.info.m_userData;
    note([&] { participants.emplace_back(data.begin(), data.end()); });
  }
  template <class Proxy>
  void add(const Proxy& proxy, bool writes) {
    const auto& data = proxy.m_qos.m_userData;
    Endpoint one{proxy.topicName().c_str(), proxy.typeName().c_str(), {data.begin(), data.end()}, writes};
    one.reliable = proxy.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
    one.latched = proxy.m_qos.m_durability.kind == dds::TRANSIENT_LOCAL_DURABILITY_QOS;
    note([&] { others.push_back(one); });
  }
  void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& info) override {
    if (info.status == rtps::WriterDiscoveryInfo::DISCOVERED_WRITER) add(info.info, true);
  }
  void on_subscriber_discovery(dds::DomainParticipant*, rtps::ReaderDiscoveryInfo&& info) override {
    if (info.status == rtps::ReaderDiscoveryInfo::DISCOVERED_READER) add(info.info, false);
  }
  void on_subscription_matched(dds::DataReader* reader, const dds::SubscriptionMatchedStatus& status) override {
    note([&] { matched[reader] = status.current_count; });
  }
  void on_publication_matched(dds::DataWriter* writer, const dds::PublicationMatchedStatus& status) override {
    note([&] { matched[writer] = status.current_count; });
  }
  void on_data_available(dds::DataReader* reader) override {
    Bytes message;
    dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK)
      if (info.valid_data)
        note([&] {
          come[reader].push_back(message);
          const rtps::SampleIdentity& to = info.related_sample_identity;
          if (to.writer_guid() == reader->guid())
            replies[reader].emplace_back(static_cast<std::int64_t>(to.sequence_number().to64long()), message);
        });
  }

  dds::Topic* topic(const std::string& name, const std::string& type) {
    dds::Topic*& known = topics[name];
    if (known == nullptr) {
      dds::TypeSupport(new ByteType(type)).register_type(participant);
      known = require(participant->create_topic(name, type, dds::TOPIC_QOS_DEFAULT), "no topic of Fast DDS");
    }
    return known;
  }
};

FastPeer::FastPeer(std::uint32_t domain) : impl_(std::make_unique<Impl>()) {
  auto* const factory = dds::DomainParticipantFactory::get_instance();
  impl_->participant =
      require(factory->create_participant(domain, on_loopback(), impl_.get(),
                                          dds::StatusMask::all() >> dds::StatusMask::data_on_readers()),
              "no participant of Fast DDS");
  impl_->publisher = require(impl_->participant->create_publisher(dds::PUBLISHER_QOS_DEFAULT), "no publisher");
  impl_->subscriber = require(impl_->participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT), "no subscriber");
}

FastPeer::~FastPeer() {
  impl_->participant->set_listener(nullptr);
  impl_->participant->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(impl_->participant);
}

std::size_t FastPeer::subscribe(const std::string& topic, const std::string& type, bool latched, bool reliable) {
  dds::DataReaderQos qos;
  set_quality(qos, latched, reliable);
  dds::Topic* const of = impl_->topic(topic, type);
  impl_->readers.push_back(require(impl_->subscriber->create_datareader(of, qos), "no reader of Fast DDS"));
  return impl_->readers.size() - 1;
}

std::size_t FastPeer::advertise(const std::string& topic, const std::string& type, bool reliable) {
  dds::DataWriterQos qos;
  set_quality(qos, false, reliable);
  dds::Topic* const of = impl_->topic(topic, type);
  impl_->writers.push_back(require(impl_->publisher->create_datawriter(of, qos), "no writer of Fast DDS"));
  return impl_->writers.size() - 1;
}

void FastPeer::send(std::size_t writer, const Bytes& message) {
  Bytes copy = message;
  if (!impl_->writers[writer]->write(&copy)) throw std::runtime_error("Fast DDS does not write");
}

std::int64_t FastPeer::call(std::size_t writer, std::size_t reader, const Bytes& message) {
  Bytes copy = message;
  rtps::WriteParams params;
  params.related_sample_identity().writer_guid(impl_->readers[reader]->guid());
  if (!impl_->writers[writer]->write(&copy, params)) throw std::runtime_error("Fast DDS does not write");
  return static_cast<std::int64_t>(params.sample_identity().sequence_number().to64long());
}

std::vector<std::pair<std::int64_t, Bytes>> FastPeer::replies(std::size_t reader) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->replies[impl_->readers[reader]];
}

int FastPeer::count_matched_reader(std::size_t reader) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->matched[impl_->readers[reader]];
}
int FastPeer::count_matched_writer(std::size_t writer) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->matched[impl_->writers[writer]];
}
bool FastPeer::matched_reader(std::size_t reader) const { return count_matched_reader(reader) > 0; }
bool FastPeer::matched_writer(std::size_t writer) const { return count_matched_writer(writer) > 0; }
std::vector<Bytes> FastPeer::messages(std::size_t reader) const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->come[impl_->readers[reader]];
}
std::vector<Endpoint> FastPeer::endpoints() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->others;
}
std::vector<std::string> FastPeer::participants() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->participants;
}

bool FastPeer::wait(const std::function<bool()>& condition) const {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!condition()) {
    std::unique_lock lock(impl_->mutex);
    impl_->changed.wait_for(lock, std::chrono::milliseconds(5));
    if (std::chrono::steady_clock::now() > end) return false;
  }
  return true;
}

}  // namespace sf::ros2
