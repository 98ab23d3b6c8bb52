// Ctrl-C and SIGTERM as a stop token.
#pragma once

#include <stop_token>
#include <thread>

namespace anatomesh::apps {

/// While it lives, SIGINT and SIGTERM request stop of token() and print a line, in place of ending the process.
/// Make it before any other thread: threads made later inherit that the signals are blocked, so that only the
/// waiting thread here receives them and no code runs inside a signal handler.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return source_.get_token(); }

  /// Throws Cancelled once a signal has come.
  void throw_if_requested() const;

 private:
  std::stop_source source_;
  std::thread waiter_;
};

}  // namespace anatomesh::apps
