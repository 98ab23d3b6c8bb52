#include "apps/interrupt.h"

#include <pthread.h>

#include <csignal>

#include "anatomesh/errors.h"
#include "apps/messages.h"

namespace anatomesh::apps {
namespace {

constexpr int kEndOfWaiting = SIGUSR1;

sigset_t watched_signals() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGINT, SIGTERM, kEndOfWaiting}) sigaddset(&set, signal);
  return set;
}

void wait_for_signals(std::stop_source source) {
  const sigset_t watched = watched_signals();
  for (int signal = 0; sigwait(&watched, &signal) == 0 && signal != kEndOfWaiting;)
    if (source.request_stop()) print_note("interrupted, stopping");
}

}  // namespace

Interrupt::Interrupt() {
  const sigset_t watched = watched_signals();
  pthread_sigmask(SIG_BLOCK, &watched, nullptr);
  waiter_ = std::thread(wait_for_signals, source_);
}

Interrupt::~Interrupt() {
  pthread_kill(waiter_.native_handle(), kEndOfWaiting);
  waiter_.join();
}

void Interrupt::throw_if_requested() const {
  if (source_.stop_requested()) throw Cancelled();
}

}  // namespace anatomesh::apps
