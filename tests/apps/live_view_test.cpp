// `--view` of `run` and `serve`, seen by a viewer.

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "tests/apps/program.h"
#include "tests/bridges/raw_client.h"

namespace sf {
namespace {

/// Returns the greeting that the WebSocket sends to a viewer.
std::string greeting_of(Program& program) {
  EXPECT_TRUE(program.prints("view on http://127.0.0.1:")) << program.err();
  const std::string err = program.err();
  const std::string before = "view on http://127.0.0.1:";
  const int port = std::atoi(err.c_str() + err.find(before) + before.size());
  bridges::RawClient client(static_cast<std::uint16_t>(port));
  EXPECT_EQ(client.upgrade("foxglove.websocket.v1").substr(9, 3), "101");
  return client.settle();
}

/// A viewer pauses, steps and drives a run; the robots of a service are driven by other processes.
TEST(LiveView, ARunIsDrivenAndAServiceIsWatched) {
  const std::string world = our_world("rooms.world");
  Program run({"run", world, "--view", "127.0.0.1:0"}), serve({"serve", world, "--port", "0", "--view", "127.0.0.1:0"});
  const std::string of_run = greeting_of(run), of_service = greeting_of(serve);
  for (const std::string& greeting : {of_run, of_service}) {
    EXPECT_NE(greeting.find("\"op\":\"serverInfo\""), std::string::npos) << greeting;
    EXPECT_NE(greeting.find("\"topic\":\"/fleet\""), std::string::npos) << greeting;
  }
  for (const char* part : {"clientPublish", "services", "\"/step\""}) {
    EXPECT_NE(of_run.find(part), std::string::npos) << part << ": " << of_run;
    EXPECT_EQ(of_service.find(part), std::string::npos) << part << ": " << of_service;
  }
  for (Program* program : {&run, &serve}) {
    EXPECT_EQ(program->stop(SIGTERM).signal, 0) << program->err();
  }
}

}  // namespace
}  // namespace sf
