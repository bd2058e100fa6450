#include "bridges/fast_services.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <utility>

#include "base/installation.h"

namespace sf::bridges {

namespace {

constexpr std::uint32_t kMaxFrame = kDdsMaxReceived + 64;   // [byte] from the process
constexpr std::size_t kMaxQueued = DdsOutbox::kMaxReplies;  // maximum number of queued replies; more are dropped
constexpr std::chrono::milliseconds kLeave{250};            // for the process to exit by itself
constexpr std::chrono::seconds kBeforeRestart{1};           // pause before a restart

/// One end of a pipe.
class PipeEnd {
 public:
  explicit PipeEnd(int descriptor) : descriptor_(descriptor) {}
  ~PipeEnd() { ::close(descriptor_); }
  PipeEnd(const PipeEnd&) = delete;
  PipeEnd& operator=(const PipeEnd&) = delete;
  int get() const { return descriptor_; }

 private:
  int descriptor_;
};
using Pipe = std::shared_ptr<PipeEnd>;

struct Process {
  pid_t pid = -1;
  Pipe to, from;
};

std::pair<Pipe, Pipe> new_pipe() {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe can be opened; raise the limit (ulimit -n)");
  return {std::make_shared<PipeEnd>(ends[0]), std::make_shared<PipeEnd>(ends[1])};
}

/// Runs in the new process, where only system calls are safe. Ctrl-C does not reach it; it exits when the farm does.
[[noreturn]] void become(const char* file, int in, int out) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  sigset_t none;
  ::sigemptyset(&none);
  ::sigprocmask(SIG_SETMASK, &none, nullptr);
  const int nothing = ::open("/dev/null", O_WRONLY);
  ::dup2(in, 0);
  ::dup2(out, 1);
  ::dup2(nothing, 2);
  ::close_range(3, ~0u, 0);
  char* const words[] = {const_cast<char*>(file), nullptr};
  ::execv(file, words);
  ::_exit(127);
}

base::Bytes settings_of(const FastOptions& options) {
  base::Bytes bytes;
  base::ByteWriter out(bytes);
  out.put(options.dds.domain);
  out.put(static_cast<std::uint8_t>(options.dds.loopback));
  out.put_string(options.dds.user_data);
  out.put(static_cast<std::uint32_t>(options.dds.addresses.size()));
  for (const std::string& address : options.dds.addresses) out.put_string(address);
  for (const FastService& service : options.services)
    for (const DdsEndpoint* endpoint : {&service.requests, &service.replies}) {
      for (const std::string* text : {&endpoint->topic, &endpoint->type, &endpoint->user_data}) out.put_string(*text);
      out.put(static_cast<std::uint32_t>(endpoint->depth));
    }
  return bytes;
}

class FastProcess : public FastServices {
 public:
  explicit FastProcess(const FastOptions& options) : options_(options) {
    file_ = std::filesystem::path(base::plugin_file(kDdsSymbol)).replace_filename("sensorfarm_fastdds").string();
    start();
    reader_ = std::thread([this] { read(); });
    writer_ = std::thread([this] { write(); });
  }

  ~FastProcess() override {
    {
      std::unique_lock lock(mutex_);
      stop_ = true;
      process_.to.reset();
      changed_.notify_all();
      changed_.wait_for(lock, kLeave, [this] { return process_.pid < 0; });
      if (process_.pid > 0) ::kill(process_.pid, SIGKILL);
    }
    reader_.join();
    writer_.join();
  }

  void add(DdsReply&& reply) override {
    {
      const std::lock_guard lock(mutex_);
      if (queue_.size() >= kMaxQueued) {
        ++counts_.left_out;
        return;
      }
      queue_.push_back(std::move(reply));
    }
    changed_.notify_all();
  }

  DdsOutbox::Counts counts() const override {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

 private:
  /// @throws std::runtime_error with the reason if it does not start
  void start() {
    Process made;
    auto [in, to] = new_pipe();
    auto [from, out] = new_pipe();
    ::fcntl(to->get(), F_SETPIPE_SZ, 1 << 20);
    made.to = to, made.from = from;
    made.pid = ::fork();
    if (made.pid == 0) become(file_.c_str(), in->get(), out->get());
    if (made.pid < 0) throw std::runtime_error("no further process can be started");
    out.reset();
    // The settings fit the pipe, and its reading end is still open here, so the write works even if the process has
    // already exited.
    write_frame(to->get(), {FrameKind::open, 0, 0, settings_of(options_)});
    in.reset();
    Frame first;
    const bool answered = read_frame(from->get(), first, kMaxFrame);
    const std::lock_guard lock(mutex_);
    if (answered && first.kind == FrameKind::ready) {
      process_ = made;
      return;
    }
    made.to.reset(), to.reset();
    ::kill(made.pid, SIGKILL);
    ::waitpid(made.pid, nullptr, 0);
    throw std::runtime_error(answered ? std::string(first.bytes.begin(), first.bytes.end())
                                      : fmt::format("{} does not start: it must be in the folder of the plug-ins, and "
                                                    "Fast DDS 2.9 (libfastrtps2.9) installed",
                                                    file_));
  }

  Pipe input() const {
    const std::lock_guard lock(mutex_);
    return process_.from;
  }

  /// Body of `reader_`: forwards requests, and restarts the process when it exits.
  void read() {
    while (true) {
      const Pipe from = input();
      for (Frame frame; from && read_frame(from->get(), frame, kMaxFrame);)
        if (!take(frame)) break;
      const std::string how = end();
      std::unique_lock lock(mutex_);
      if (stop_) return;
      lock.unlock();
      if (from) options_.dds.log(fmt::format("the process with Fast DDS {}; restarting it", how));
      lock.lock();
      if (changed_.wait_for(lock, kBeforeRestart, [this] { return stop_; })) return;
      lock.unlock();
      try {
        start();
      } catch (const std::runtime_error& error) {
        options_.dds.log(error.what());
      }
    }
  }

  /// Returns false for a frame that the process may not send.
  bool take(Frame& frame) {
    if (frame.kind == FrameKind::log) {
      options_.dds.log({reinterpret_cast<const char*>(frame.bytes.data()), frame.bytes.size()});
      return true;
    }
    if (frame.kind != FrameKind::request || frame.service >= options_.services.size()) return false;
    DdsMessage message{static_cast<std::size_t>(frame.service), frame.sender, std::move(frame.bytes)};
    message.sender.fast = true;
    options_.dds.receive(std::move(message));
    return true;
  }

  /// Ends the process if it is running.
  /// @return how it ended
  std::string end() {
    const std::lock_guard lock(mutex_);
    int status = 0;
    if (process_.pid > 0) {
      if (!stop_) ::kill(process_.pid, SIGKILL);
      ::waitpid(process_.pid, &status, 0);
    }
    process_ = {};
    changed_.notify_all();
    return WIFSIGNALED(status) ? fmt::format("was terminated by signal {}", WTERMSIG(status)) : "ended";
  }

  /// Body of `writer_`. After the process has exited, write() fails instead of raising a signal.
  void write() {
    sigset_t pipes;
    ::sigemptyset(&pipes);
    ::sigaddset(&pipes, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipes, nullptr);
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return stop_ || !queue_.empty(); });
      if (stop_) return;
      DdsReply reply = std::move(queue_.front());
      queue_.pop_front();
      Pipe to = process_.to;
      lock.unlock();
      const bool written =
          to && write_frame(to->get(), {FrameKind::reply, reply.writer, reply.sender, std::move(reply.message)});
      to.reset();
      lock.lock();
      ++(written ? counts_.written : counts_.left_out);
    }
  }

  const FastOptions options_;
  std::string file_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool stop_ = false;
  Process process_;
  std::deque<DdsReply> queue_;
  DdsOutbox::Counts counts_;
  std::thread reader_, writer_;
};

}  // namespace

std::unique_ptr<FastServices> open_fast_services(const FastOptions& options) {
  return std::make_unique<FastProcess>(options);
}

}  // namespace sf::bridges
