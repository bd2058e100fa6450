// Services of the program for clients of rmw_fastrtps and rmw_cyclonedds together: each request is executed once and
// answered once.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>

#include "tests/apps/program.h"
#include "tests/ros2/cyclone_peer.h"
#include "tests/ros2/domain.h"
#include "tests/ros2/fast_peer.h"

namespace sf::ros2 {
namespace {

const Environment kLocal{{"ROS_LOCALHOST_ONLY", "1"}};
using Fields = std::vector<std::uint8_t>;

constexpr const char* kSetBool = "std_srvs::srv::dds_::SetBool";
constexpr const char* kStep = "simulation_interfaces::srv::dds_::StepSimulation";
constexpr const char* kGetState = "simulation_interfaces::srv::dds_::GetSimulationState";
constexpr const char* kGetEntity = "simulation_interfaces::srv::dds_::GetEntityState";

Fields steps(std::uint8_t count) { return {count, 0, 0, 0, 0, 0, 0, 0}; }

/// A client like rclcpp with rmw_fastrtps.
struct FastClient {
  FastClient(FastPeer& of, const std::string& name, const std::string& type)
      : peer(of),
        requests(of.advertise("rq/" + name + "Request", type + "_Request_")),
        replies(of.subscribe("rr/" + name + "Reply", type + "_Response_")) {}
  /// `service_is_ready`: as many readers of requests as writers of replies. Here there is one of each implementation.
  bool ready() const { return peer.count_matched_writer(requests) >= 2 && peer.count_matched_reader(replies) >= 2; }
  void call(const Fields& fields) { calls.push_back(peer.call(requests, replies, encode_fields(fields))); }
  std::size_t answers(std::int64_t call) const {
    std::size_t count = 0;
    for (const auto& [sequence, message] : peer.replies(replies)) count += sequence == call ? 1 : 0;
    return count;
  }
  bool answered() const { return answers(calls.back()) > 0; }

  FastPeer& peer;
  const std::size_t requests, replies;
  std::vector<std::int64_t> calls;  ///< their sequence numbers
};

/// A client like rclcpp with rmw_cyclonedds.
struct CycloneClient {
  CycloneClient(CyclonePeer& of, const std::string& name, const std::string& type)
      : peer(of),
        requests(of.advertise("rq/" + name + "Request", type + "_Request_")),
        replies(of.subscribe("rr/" + name + "Reply", type + "_Response_")) {}
  bool ready() const { return peer.matched_writer(requests); }
  void call(const Fields& fields) {
    calls.push_back(static_cast<std::int64_t>(calls.size()) + 1);
    peer.send(requests, encode_request(kClient, calls.back(), fields));
  }
  std::size_t answers(std::int64_t call) const {
    std::size_t count = 0;
    for (const base::Bytes& message : peer.messages(replies)) {
      if (message.size() < 20) continue;  // replies to other clients have no header
      std::uint64_t client = 0;
      std::int64_t sequence = 0;
      std::memcpy(&client, message.data() + 4, sizeof client);
      std::memcpy(&sequence, message.data() + 12, sizeof sequence);
      count += client == kClient && sequence == call ? 1 : 0;
    }
    return count;
  }
  bool answered() const { return answers(calls.back()) > 0; }

  static constexpr std::uint64_t kClient = 0x123456789ABCDEFULL;
  CyclonePeer& peer;
  const std::size_t requests, replies;
  std::vector<std::int64_t> calls;
};

/// Returns the first child process; empty: none, or the kernel does not list them.
std::string child_of(const std::string& process) {
  std::string child;
  std::ifstream("/proc/" + process + "/task/" + process + "/children") >> child;
  return child;
}

/// Returns the process with Fast DDS, a child of this process or of the one that it has started.
std::string fast_process() {
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    std::string name, parent;
    std::ifstream(entry.path() / "comm") >> name;
    if (name != "sensorfarm_fast") continue;  // truncated to 15 characters
    std::ifstream stat(entry.path() / "stat");
    for (int i = 0; i < 4; ++i) stat >> parent;
    std::string grandparent;
    std::ifstream above("/proc/" + parent + "/stat");
    for (int i = 0; i < 4; ++i) above >> grandparent;
    const std::string self = std::to_string(getpid());
    if (grandparent == self || parent == self) return entry.path().filename().string();
  }
  return {};
}

struct Ros2Services : testing::Test {
  /// Calls until one call is answered, because a participant may discover the other before it is discovered itself.
  template <class Client>
  bool connect(Client& client, const Fields& fields) {
    const std::size_t from = client.calls.size();
    int looked = 0;
    return fast.wait([&] { return client.ready(); }) && fast.wait([&] {
      if (looked++ % 8 == 0) client.call(fields);
      return std::any_of(client.calls.begin() + static_cast<std::ptrdiff_t>(from), client.calls.end(),
                         [&](std::int64_t call) { return client.answers(call) > 0; });
    });
  }
  template <class Client>
  static void expect_each_answered_once(const Client& client, std::size_t from) {
    for (std::size_t i = from; i < client.calls.size(); ++i) EXPECT_EQ(client.answers(client.calls[i]), 1u) << i;
  }
  /// Returns the run's time in ns, from the stamp of an entity's state (of no entity: the stamp is given all the same).
  /// `/clock` would not do: its message may arrive after the answer to a step. < 0: no answer.
  std::int64_t time_of_run(FastClient& entity) {
    entity.call({1, 0, 0, 0, 0});
    if (!fast.wait([&] { return entity.answered(); })) return -1;
    const base::Bytes reply = fast.replies(entity.replies).back().second;
    const auto word = [&](std::size_t at) {
      std::uint32_t value = 0;
      if (at + sizeof value <= reply.size()) std::memcpy(&value, reply.data() + at, sizeof value);
      return value;
    };
    const std::size_t stamp = 12 + (word(8) + 3) / 4 * 4;  // after encapsulation, code, length and text
    return word(stamp) * 1'000'000'000LL + word(stamp + 4);
  }

  const std::uint32_t domain = own_domain();
  Program run{{"run", our_world("rooms.world"), "--ros2", std::to_string(domain)}, kLocal};
  FastPeer fast{domain};
  CyclonePeer cyclone{domain};
};

TEST_F(Ros2Services, BothClientsAreAnsweredOnce) {
  ASSERT_TRUE(run.prints("node /sensorfarm")) << run.err();
  FastClient a(fast, "get_simulation_state", kGetState);
  CycloneClient b(cyclone, "get_simulation_state", kGetState);
  ASSERT_TRUE(connect(a, {0}));
  ASSERT_TRUE(connect(b, {0}));
  const std::size_t before_a = a.calls.size(), before_b = b.calls.size();
  for (int i = 0; i < 8; ++i) a.call({0}), b.call({0});
  ASSERT_TRUE(fast.wait([&] { return a.answered() && b.answered(); }));
  a.call({0}), b.call({0});  // an extra answer would have arrived before theirs
  ASSERT_TRUE(fast.wait([&] { return a.answered() && b.answered(); }));
  expect_each_answered_once(a, before_a);
  expect_each_answered_once(b, before_b);
  EXPECT_EQ(run.stop().code, 0);
}

TEST_F(Ros2Services, BothClientsStepTheRunOnce) {
  ASSERT_TRUE(run.prints("node /sensorfarm")) << run.err();
  FastClient pause(fast, "sensorfarm/pause", kSetBool), a(fast, "step_simulation", kStep);
  CycloneClient b(cyclone, "step_simulation", kStep);
  FastClient entity(fast, "get_entity_state", kGetEntity);
  ASSERT_TRUE(connect(pause, {1}));
  const auto reply = decode_fields_of_reply(fast.replies(pause.replies).back().second);
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->code, 1) << reply->message;
  ASSERT_TRUE(connect(a, steps(0))) << "refused";
  ASSERT_TRUE(connect(b, steps(0))) << "refused";
  ASSERT_TRUE(fast.wait([&] { return entity.ready(); }));
  const std::int64_t before = time_of_run(entity);
  const std::size_t first_a = a.calls.size(), first_b = b.calls.size();
  a.call(steps(3)), b.call(steps(2));
  ASSERT_TRUE(fast.wait([&] { return a.answered() && b.answered(); }));
  EXPECT_EQ(time_of_run(entity), before + 500'000'000);
  a.call(steps(1)), b.call(steps(1));  // an extra answer would have arrived before theirs
  ASSERT_TRUE(fast.wait([&] { return a.answered() && b.answered(); }));
  EXPECT_EQ(time_of_run(entity), before + 700'000'000);
  expect_each_answered_once(a, first_a);
  expect_each_answered_once(b, first_b);
}

TEST_F(Ros2Services, UnreadableRequestsOfFastDdsAreDropped) {
  ASSERT_TRUE(run.prints("node /sensorfarm")) << run.err();
  FastClient client(fast, "step_simulation", kStep);
  ASSERT_TRUE(connect(client, steps(0)));
  const std::size_t from = client.calls.size();
  const base::Bytes whole = encode_fields(steps(0));
  const std::vector<base::Bytes> faulty{
      {},                                    // empty
      {0, 1, 0},                             // less than an encapsulation
      {0, 1, 0, 0},                          // no field
      {whole.begin(), whole.end() - 1},      // its field is truncated
      {2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0},  // another encapsulation
      base::Bytes((1 << 18) + 1, 0),         // longer than any accepted request
  };
  for (const base::Bytes& bytes : faulty) fast.call(client.requests, client.replies, bytes);
  client.call(steps(0));
  ASSERT_TRUE(fast.wait([&] { return client.answered(); })) << "later requests are answered";
  expect_each_answered_once(client, from);
}

TEST_F(Ros2Services, ASecondPairOfEndpointsHasTheSameTypes) {
  const auto find = [&](const std::string& topic) {
    std::set<std::string> user_data;
    for (const Endpoint& one : fast.endpoints())
      if (one.topic == topic) user_data.insert(one.user_data.substr(one.user_data.find("typehash=")));
    return user_data;
  };
  const auto count = [&](const std::string& topic) {
    std::size_t found = 0;
    for (const Endpoint& one : fast.endpoints()) found += one.topic == topic ? 1 : 0;
    return found;
  };
  for (const char* topic : {"rq/set_entity_stateRequest", "rr/set_entity_stateReply"}) {
    ASSERT_TRUE(fast.wait([&] { return count(topic) == 2; })) << topic;
    EXPECT_EQ(find(topic).size(), 1u) << topic;
  }
  for (const std::string& each : fast.participants()) EXPECT_EQ(each, "enclave=/;");
}

/// A killed process would leave files in /dev/shm.
TEST_F(Ros2Services, NoSharedMemoryIsUsed) {
  ASSERT_TRUE(run.prints("node /sensorfarm")) << run.err();
  FastClient client(fast, "get_simulation_state", kGetState);
  ASSERT_TRUE(connect(client, {0}));
  for (const std::string& process : {child_of(std::to_string(getpid())), fast_process()}) {
    std::ifstream maps("/proc/" + process + "/maps");
    for (std::string line; std::getline(maps, line);) EXPECT_EQ(line.find("/dev/shm"), std::string::npos) << line;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator("/proc/" + process + "/fd", ignored))
      EXPECT_EQ(std::filesystem::read_symlink(entry, ignored).string().find("/dev/shm"), std::string::npos);
  }
}

/// Some malformed datagrams crash Fast DDS 2.9.1. The run continues, and its services answer again.
TEST_F(Ros2Services, TheRunSurvivesFastDds) {
  ASSERT_TRUE(run.prints("node /sensorfarm")) << run.err();
  FastClient before(fast, "get_simulation_state", kGetState);
  CycloneClient other(cyclone, "get_simulation_state", kGetState);
  ASSERT_TRUE(connect(before, {0}));
  ASSERT_TRUE(connect(other, {0}));
  const std::string process = fast_process();
  ASSERT_FALSE(process.empty());
  ASSERT_EQ(kill(std::stoi(process), SIGSEGV), 0);
  ASSERT_TRUE(run.prints("the process with Fast DDS was terminated by signal 11")) << run.err();
  other.call({0});
  EXPECT_TRUE(fast.wait([&] { return other.answered(); })) << "clients of Cyclone DDS are answered meanwhile";
  EXPECT_TRUE(connect(before, {0})) << "by the process that was started again";
  EXPECT_NE(fast_process(), process);
  EXPECT_EQ(run.stop().code, 0);
}

/// A killed process leaves no child behind.
TEST_F(Ros2Services, FastDdsEndsWithTheRun) {
  ASSERT_TRUE(run.prints("node /sensorfarm")) << run.err();
  const std::string process = fast_process();
  ASSERT_FALSE(process.empty());
  run.stop(SIGKILL);
  EXPECT_TRUE(fast.wait([&] {
    std::ifstream state("/proc/" + process + "/stat");
    std::string text;
    std::getline(state, text);
    return text.empty() || text.find(") Z ") != std::string::npos;
  }));
}

/// Clients of rmw_cyclonedds are still answered.
TEST(Ros2Program, WithoutFastDdsReportsWhichClientsGetNoAnswer) {
  const Folder folder;
  std::filesystem::copy_file(SF_PROGRAM, folder.path("alone"));
  std::filesystem::copy_file(std::filesystem::path(SF_PROGRAM).parent_path() / "sensorfarm_dds.so",
                             folder.path("sensorfarm_dds.so"));
  setenv("SENSORFARM_PROGRAM", folder.path("alone").c_str(), 1);
  const std::string domain = std::to_string(own_domain());
  const Outcome outcome = run_program({"run", our_world("rooms.world"), "--ros2", domain, "--duration", "0.1"}, kLocal);
  unsetenv("SENSORFARM_PROGRAM");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.err.find("services do not answer rmw_fastrtps clients"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("libfastrtps2.9"), std::string::npos) << outcome.err;
  EXPECT_EQ(count_lines(outcome.err), 1u) << outcome.err;
}

}  // namespace
}  // namespace sf::ros2
