// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/supervisor.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <thread>

namespace shoal::console {
namespace {

constexpr std::chrono::milliseconds kPoll{10};

// Between fork and exec only what is safe in a signal handler: this process may have threads.
[[noreturn]] void becomeChild(pid_t parent, int log, int null, const char* program, char* const* arguments) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // the parent ended before we asked to be told
  setpgid(0, 0);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGCHLD}) ::signal(signal, SIG_DFL);
  sigset_t none;
  sigemptyset(&none);
  sigprocmask(SIG_SETMASK, &none, nullptr);
  if (dup2(null, 0) < 0 || dup2(log, 1) < 0 || dup2(log, 2) < 0) _exit(127);
  close_range(3, ~0U, 0);  // liblcm's sockets would go on collecting datagrams that nobody reads
  execv(program, arguments);
  constexpr std::array message = std::to_array("cannot be run\n");
  [[maybe_unused]] const ssize_t written = ::write(2, message.data(), message.size() - 1);
  _exit(127);
}

// An open file that closes itself.
class File {
 public:
  File(const std::string& path, int flags) : fd_(open(path.c_str(), flags | O_CLOEXEC, 0644)) {
    if (fd_ < 0) throw std::runtime_error("cannot open " + path + ": " + std::strerror(errno));
  }
  ~File() { close(fd_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

bool canRun(const std::string& path) {
  std::error_code unreadable;  // one bad folder on PATH hides no other
  return std::filesystem::is_regular_file(path, unreadable) && access(path.c_str(), X_OK) == 0;
}

}  // namespace

bool Ended::inGoodOrder() const { return WIFEXITED(status) && WEXITSTATUS(status) == 0; }

bool Ended::crashed() const { return WIFSIGNALED(status); }

std::string Ended::how() const {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return "was killed by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
  }
  return "exited with code " + std::to_string(WEXITSTATUS(status));
}

Supervisor::~Supervisor() { stopAll(std::chrono::milliseconds(0)); }

void Supervisor::start(const Command& command) {
  if (!canRun(command.program)) throw std::runtime_error("cannot run " + command.program);
  const File log(command.log, O_WRONLY | O_CREAT | (command.goes_on ? 0 : O_TRUNC) | O_APPEND);
  const File null("/dev/null", O_RDONLY);
  std::vector<std::string> words = command.arguments;
  words.insert(words.begin(), command.program);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid == 0) becomeChild(parent, log.fd(), null.fd(), command.program.c_str(), arguments.data());
  if (pid < 0) throw std::runtime_error("cannot start " + command.name + ": " + std::strerror(errno));
  running_.push_back({pid, command.name, command.log});
}

std::vector<Ended> Supervisor::reap() {
  std::vector<Ended> ended;
  std::erase_if(running_, [&](const Child& child) {
    int status = 0;
    if (waitpid(child.pid, &status, WNOHANG) != child.pid) return false;
    ended.push_back({child.name, child.log, status});
    return true;
  });
  return ended;
}

void Supervisor::signal(const std::string& name, int signal) {
  for (const Child& child : running_) {
    if (child.name == name) kill(child.pid, signal);
  }
}

void Supervisor::signalAll(int signal) {
  for (const Child& child : running_) kill(child.pid, signal);
}

std::vector<Ended> Supervisor::wait(std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  std::vector<Ended> ended = reap();
  while (!running_.empty() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(kPoll);
    for (Ended& one : reap()) ended.push_back(std::move(one));
  }
  return ended;
}

std::vector<Ended> Supervisor::stopAll(std::chrono::milliseconds patience) {
  signalAll(SIGTERM);
  std::vector<Ended> ended = wait(patience);
  while (!running_.empty()) {
    signalAll(SIGKILL);
    for (Ended& one : wait(std::chrono::seconds(1))) ended.push_back(std::move(one));
  }
  return ended;
}

bool Supervisor::isRunning(const std::string& name) const {
  return std::ranges::find(running_, name, &Child::name) != running_.end();
}

pid_t Supervisor::pidOf(const std::string& name) const {
  const auto child = std::ranges::find(running_, name, &Child::name);
  return child == running_.end() ? 0 : child->pid;
}

std::string programBeside(const std::string& name) {
  const auto path = std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
  if (!canRun(path)) throw std::runtime_error("cannot run " + path.string() + ": ./shoal build makes it");
  return path;
}

std::string programOnPath(const std::string& name, const std::string& package) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::string candidate = (folder.empty() ? "." : folder) + "/" + name;
    if (canRun(candidate)) return candidate;
  }
  throw std::runtime_error(name + " is missing: apt-get install " + package);
}

std::vector<std::string> lastLines(const std::string& path, size_t count) {
  constexpr std::streamoff kMost = 16384;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) return {};
  const std::streamoff size = file.tellg();
  file.seekg(std::max<std::streamoff>(0, size - kMost));
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  if (lines.size() > count) lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(count));
  return lines;
}

}  // namespace shoal::console
