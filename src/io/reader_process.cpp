#include "io/reader_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <mutex>
#include <system_error>
#include <utility>

#include "anatomesh/errors.h"
#include "base/memory.h"
#include "io/cell_arrays.h"
#include "io/output_file.h"

namespace anatomesh {
namespace fs = std::filesystem;

namespace {

/// Calls of the system are begun anew where a signal came in between.
template <typename Call>
auto uninterrupted(Call&& call) {
  auto result = call();
  while (result < 0 && errno == EINTR) result = call();
  return result;
}

}  // namespace

// ---- messages

ProcessChannel::ProcessChannel(const fs::path& file, int socket) : file_(file), socket_(socket) {}
ProcessChannel::~ProcessChannel() { ::close(socket_); }

void ProcessChannel::fail() const { throw_damaged(file_, "the library that reads such files fails on it"); }

bool ProcessChannel::put_bytes(const void* bytes, std::size_t size) {
  const auto* next = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t sent = uninterrupted([&] { return ::send(socket_, next, size, MSG_NOSIGNAL); });
    if (sent <= 0) return false;
    next += sent;
    size -= static_cast<std::size_t>(sent);
  }
  return true;
}

void ProcessChannel::put_message(Kind kind, const void* bytes, std::size_t size) {
  const Head head{kind, size};
  if (put_bytes(&head, sizeof(head))) put_bytes(bytes, size);
}

void ProcessChannel::put_error() {
  const auto put_text = [this](Kind kind, const std::string& text) { put_message(kind, text.data(), text.size()); };
  try {
    throw;
  } catch (const InvalidInput& error) {
    put_text(Kind::invalid_input, error.what());
  } catch (const Error& error) {
    put_text(Kind::io_error, error.what());
  } catch (...) {
  }
}

void ProcessChannel::get_bytes(void* bytes, std::size_t size) {
  auto* next = static_cast<char*>(bytes);
  while (size > 0) {
    const ssize_t received = uninterrupted([&] { return ::recv(socket_, next, size, 0); });
    if (received <= 0) fail();
    next += received;
    size -= static_cast<std::size_t>(received);
  }
}

std::string ProcessChannel::text_of(std::uint64_t size) {
  constexpr std::uint64_t kLongest = 1 << 20;
  if (size > kLongest) fail();
  std::string text(size, '\0');
  get_bytes(text.data(), text.size());
  return text;
}

std::uint64_t ProcessChannel::next_size() {
  Head head{};
  get_bytes(&head, sizeof(head));
  if (head.kind == Kind::invalid_input) throw InvalidInput(text_of(head.bytes));
  if (head.kind == Kind::io_error) throw IoError(text_of(head.bytes));
  return head.bytes;
}

void ProcessChannel::expect(std::size_t size) {
  if (next_size() != size) fail();
}

std::string ProcessChannel::get_text() { return text_of(next_size()); }

// ---- the child

namespace {

/// What a file can fairly take.
struct Limits {
  rlim_t address_space;  ///< bytes
  rlim_t seconds;        ///< of computing
};

std::uint64_t bytes_of(const fs::path& file) {
  std::error_code none;
  if (!fs::is_directory(file, none)) return fs::is_regular_file(file, none) ? fs::file_size(file, none) : 0;
  std::uint64_t sum = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(file, none)) {
    if (entry.is_regular_file(none)) sum += entry.file_size(none);
  }
  return sum;
}

/// Of this process. The address sanitizer's shadow is a part of it.
rlim_t address_space() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

Limits limits_for(const fs::path& file) {
  constexpr double kMib = 1 << 20, kGib = 1 << 30, kLeast = kGib / 4;
  constexpr double kMostInflation = 8 * 1032;  // that of deflate, of bytes that become 64-bit numbers
  const double bytes = static_cast<double>(bytes_of(file)), free = available_memory_gib() * kGib;
  const double fair = kLeast + kMostInflation * bytes;
  const double most = free > 0 ? std::min(fair, std::max(free / 2, kLeast)) : fair;
  const rlim_t now = address_space();
  return {now == 0 ? RLIM_INFINITY : now + static_cast<rlim_t>(most), 3 + static_cast<rlim_t>(bytes / kMib)};
}

template <typename Resource>
void limit(Resource resource, rlim_t most) {
  rlimit both{};
  if (::getrlimit(resource, &both) != 0) return;
  both.rlim_cur = std::min({both.rlim_cur, both.rlim_max, most});
  ::setrlimit(resource, &both);
}

void mute(int descriptor, int nowhere) {
  if (nowhere >= 0) ::dup2(nowhere, descriptor);
}

/// Makes a crash quick and silent: without handlers of sanitizers or Python, core dumps and reports of them.
void prepare_for_crashes(const Limits& limits) {
  for (int signal = 1; signal < NSIG; ++signal) std::signal(signal, signal == SIGINT ? SIG_IGN : SIG_DFL);
  ::prctl(PR_SET_DUMPABLE, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  limit(RLIMIT_AS, limits.address_space);
  limit(RLIMIT_CPU, limits.seconds);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  mute(STDOUT_FILENO, nowhere);
  mute(STDERR_FILENO, nowhere);
}

/// Without the ends of C++ and C, which are the parent's.
[[noreturn]] void run_child(ProcessChannel& parent, const Limits& limits,
                            const std::function<void(ProcessChannel&)>& work) {
  prepare_for_crashes(limits);
  try {
    work(parent);
  } catch (...) {
    parent.put_error();
  }
  ::_exit(0);
}

[[noreturn]] void throw_no_process(const fs::path& file) {
  throw IoError(in_quotes(file) + " cannot be read: a process for it cannot be started (" +
                std::generic_category().message(errno) + ")");
}

}  // namespace

ReaderProcess::ReaderProcess(const fs::path& file, const std::function<void(ProcessChannel&)>& work) {
  // No other child may have the sockets of this one, which would keep them open.
  static std::mutex one_at_a_time;
  const Limits limits = limits_for(file);
  const std::lock_guard turn(one_at_a_time);
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) throw_no_process(file);
  constexpr int kBufferBytes = 1 << 20;  // lists are large
  ::setsockopt(ends[1], SOL_SOCKET, SO_SNDBUF, &kBufferBytes, sizeof(kBufferBytes));
  channel_ = std::make_unique<ProcessChannel>(file, ends[0]);
  auto child_end = std::make_unique<ProcessChannel>(file, ends[1]);
  child_ = ::fork();
  if (child_ < 0) throw_no_process(file);
  if (child_ > 0) return;
  ::close(ends[0]);
  run_child(*child_end, limits, work);
}

ReaderProcess::~ReaderProcess() {
  channel_.reset();
  // Whoever else waits for all children of this process may have seen to it.
  if (uninterrupted([&] { return ::waitpid(child_, nullptr, WNOHANG); }) != 0) return;
  ::kill(child_, SIGKILL);
  uninterrupted([&] { return ::waitpid(child_, nullptr, 0); });
}

}  // namespace anatomesh
