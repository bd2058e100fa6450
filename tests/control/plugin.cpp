// A plug-in of tests: two controllers, one that affects its process as its setting `how` states, controllers of models,
// and dynamics.

#include <fcntl.h>
#include <sensorfarm/plugin.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>

namespace {

class Straight : public sensorfarm::Controller {
 public:
  Straight(const sensorfarm::Robot&, sensorfarm::Settings& settings)
      : speed_(settings.number("speed", 0.2, 0.0, 2.0)) {}
  sensorfarm::Twist step(const sensorfarm::Input&) override { return {speed_}; }

 private:
  double speed_;
};

class Picky : public sensorfarm::Controller {
 public:
  Picky(const sensorfarm::Robot& robot, sensorfarm::Settings&) {
    throw std::invalid_argument("robot " + robot.name + " is not good enough");
  }
  sensorfarm::Twist step(const sensorfarm::Input&) override { return {}; }
};

volatile bool yes = true;

int recurse(int depth) {
  volatile char frame[4096] = {};
  return yes ? recurse(depth + 1) + frame[depth % 4096] : 0;
}

/// Leaves a process running and writes its id to a file. @param away in a separate session
void leave_running(const std::string& file, bool away) {
  const pid_t child = fork();
  if (child > 0) {
    for (std::string text; text.empty(); usleep(1000)) std::ifstream(file) >> text;
    return;
  }
  if (away) {
    setsid();
    if (fork() > 0) _exit(0);
  }
  std::ofstream(file) << getpid() << std::flush;
  for (;;) pause();
}

void forever() {
  while (yes) sleep(60);  // signals interrupt it
}

/// The first call requests a stop, and returns when the parent has noticed it; the next call does not return.
void follow_a_stop() {
  static bool asked = false;
  if (asked) forever();
  asked = true;
  kill(getppid(), SIGINT);
  usleep(50'000);
}

void end_by(const std::string& how, const std::string& file) {
  const std::map<std::string, void (*)()> ways{
      {"exit 0", [] { std::exit(0); }},
      {"exit 3", [] { std::exit(3); }},
      {"quick_exit", [] { std::quick_exit(0); }},
      {"_exit", [] { _exit(0); }},
      {"abort", [] { std::abort(); }},
      {"terminate", [] { std::terminate(); }},
      {"segv", [] { raise(SIGSEGV); }},
      {"null", [] { *static_cast<volatile int*>(nullptr) = 1; }},
      {"bus", [] { raise(SIGBUS); }},
      {"kill", [] { raise(SIGKILL); }},
      {"term", [] { raise(SIGTERM); }},
      {"recursion", [] { recurse(0); }},
      {"thread", [] { std::thread([] { std::exit(0); }).join(); }},
      {"loop",
       [] {
         while (yes) continue;
       }},
      {"sleep", [] { forever(); }},
      {"number", [] { throw 7; }},
      {"text", [] { throw std::runtime_error("\x1b[2Jred\x07\nsensorfarm: all is well"); }},
      {"print", [] { std::puts("a controller prints"), std::fflush(stdout); }},
      {"linger", [] { std::atexit([] { forever(); }); }},
      {"cover",
       [] {
         std::atexit([] { _exit(0); });
         throw std::runtime_error("out of luck");
       }},
      {"follow", [] { follow_a_stop(); }},
      {"close", [] { close(0), close(1), close(2); }},
      {"chdir", [] { static_cast<void>(chdir("/") == 0); }},
      {"copy", [] { static_cast<void>(fork()); }},
  };
  if (how == "child" || how == "daemon") leave_running(file, how == "daemon");
  if (const auto way = ways.find(how); way != ways.end()) way->second();
}

/// Drives straight on, and at 1 s does what `how` states.
class Ends : public sensorfarm::Controller {
 public:
  Ends(const sensorfarm::Robot&, sensorfarm::Settings& settings)
      : how_(settings.text("how", "")), file_(settings.text("file", "")) {
    if (settings.flag("at_once", false)) end_by(how_, file_);
  }
  sensorfarm::Twist step(const sensorfarm::Input& input) override {
    if (!done_ && input.time >= 0.999) {
      done_ = true;
      end_by(how_, file_);
    }
    return {0.1};
  }

 private:
  std::string how_, file_;
  bool done_ = false;
};

/// Slides to and fro along its x axis; at 1 s does what `how` states.
class Slide : public sensorfarm::ModelController {
 public:
  Slide(const sensorfarm::ModelSite& site, sensorfarm::Settings& settings)
      : start_(site.pose), way_(settings.number("way", 0.5, 0.0, 10.0)), how_(settings.text("how", "")) {}
  void tick(sensorfarm::Model& model) override {
    if (model.time() >= 0.999) end_by(how_, "");
    const double gone = model.pose().x - start_.x;
    if (gone >= way_) speed_ = -0.5;
    if (gone <= 0.0) speed_ = 0.5;
    model.set_velocity({speed_});
  }

 private:
  sensorfarm::Pose start_;
  double way_, speed_ = 0.0;
  std::string how_;
};

class Shy : public Slide {
 public:
  Shy(const sensorfarm::ModelSite& site, sensorfarm::Settings& settings) : Slide(site, settings) {
    throw std::invalid_argument("not this one");
  }
};

/// Rises at the speed `rise`.
class Lift : public sensorfarm::Dynamics {
 public:
  Lift(const sensorfarm::DynamicsSite&, sensorfarm::Settings& settings)
      : rise_(settings.number("rise", 1.0, -1.0, 1e300)) {}
  std::size_t state_size() const override { return 1; }
  sensorfarm::BodyState move(const sensorfarm::BodyState& from, const sensorfarm::Twist&, double seconds,
                             const sensorfarm::Ground&, std::span<double>) const override {
    if (rise_ < 0.0) throw std::runtime_error("it cannot sink");
    sensorfarm::BodyState to = from;
    to.pose.z += rise_ * seconds;
    return to;
  }

 private:
  double rise_;  // [m/s]
};

class LargeLift : public Lift {
 public:
  using Lift::Lift;
  std::size_t state_size() const override { return 5000; }
};

class PickyLift : public Lift {
 public:
  PickyLift(const sensorfarm::DynamicsSite& site, sensorfarm::Settings& settings) : Lift(site, settings) {
    throw std::invalid_argument("no");
  }
};

}  // namespace

SENSORFARM_PLUGIN(plugin) {
  plugin.add_dynamics<Lift>("test-lift", "rises");
  plugin.add_dynamics<LargeLift>("test-large", "has a large state");
  plugin.add_dynamics<PickyLift>("test-picky-dynamics", "refuses every robot");
  plugin.add_model_controller<Slide>("test-slide", "slides to and fro");
  plugin.add_model_controller<Shy>("test-shy", "refuses every model");
  plugin.add_controller<Straight>("test-straight", "drives straight on", 5.0);
  plugin.add_controller<Ends>("test-ends", "ends its process", 10.0);
  plugin.add_controller<Picky>("test-picky", "refuses every robot");
}
