#include "apps/process.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace anatomesh::testing {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kNobody = 65534;

/// In the child, between fork and exec.
[[noreturn]] void become_program(const std::vector<std::string>& arguments, const ProcessSettings& settings,
                                 const fs::path& out, const fs::path& err) {
  const auto redirect = [](const fs::path& path, int stream) {
    dup2(open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666), stream);
  };
  redirect(out, STDOUT_FILENO);
  redirect(err, STDERR_FILENO);
  if (settings.max_file_bytes) {
    std::signal(SIGXFSZ, SIG_IGN);  // the write fails in place of ending the process
    const rlimit limit = {*settings.max_file_bytes, *settings.max_file_bytes};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  if (settings.without_privileges && geteuid() == 0 && (setgid(kNobody) != 0 || setuid(kNobody) != 0)) _exit(120);
  std::vector<std::string> words = {ANATOMESH_PROGRAM};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  execv(argv[0], argv.data());
  _exit(121);
}

int wait_for(pid_t child, const ProcessSettings& settings, const fs::path& err) {
  bool interrupted = settings.interrupt_at.empty();
  int status = 0;
  while (waitpid(child, &status, interrupted ? 0 : WNOHANG) == 0) {
    if (read_file(err).find(settings.interrupt_at) != std::string::npos) {
      kill(child, settings.interrupt_signal);
      interrupted = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

ProcessResult run_program(const std::vector<std::string>& arguments, const ProcessSettings& settings) {
  const ScratchFolder streams;
  const fs::path out = streams / "out", err = streams / "err";
  write_file(err, "");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("fork failed");
  if (child == 0) become_program(arguments, settings, out, err);
  const int status = wait_for(child, settings, err);
  return {status, read_file(out), read_file(err)};
}

ScratchFolder::ScratchFolder() {
  std::string name = (fs::temp_directory_path() / "anatomesh_test_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make " + name);
  path_ = name;
  fs::permissions(path_, fs::perms::all);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::map<std::string, std::string> ScratchFolder::files() const {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::directory_iterator(path_))
    if (entry.is_regular_file()) all[entry.path().filename().string()] = read_file(entry.path());
  return all;
}

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_file(const fs::path& path, const std::string& bytes) {
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

}  // namespace anatomesh::testing
