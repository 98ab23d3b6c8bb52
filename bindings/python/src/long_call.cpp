#include "long_call.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "anatomesh/errors.h"

namespace anatomesh::python {
namespace {

namespace py = pybind11;

struct Report {
  std::string stage;
  double fraction;
};

/// Reports on their way from the thread that works to the one that may call Python. Of those of one stage that nobody
/// has fetched only the latest is kept.
class Mailbox {
 public:
  void put(std::string_view stage, double fraction) {
    const std::lock_guard lock(mutex_);
    if (reports_.empty() || reports_.back().stage != stage) reports_.push_back({std::string(stage), fraction});
    reports_.back().fraction = fraction;
    changed_.notify_one();
  }

  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_one();
  }

  /// Waits for something new, but not long; says whether there will be more.
  bool fetch(std::vector<Report>& reports) {
    constexpr std::chrono::milliseconds kBetweenSignals(50);
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, kBetweenSignals, [this] { return closed_ || !reports_.empty(); });
    reports = std::exchange(reports_, {});
    return !closed_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Report> reports_;
  bool closed_ = false;
};

void deliver(const std::vector<Report>& reports, const py::object& callback) {
  if (callback.is_none()) return;
  for (const Report& report : reports)
    if (callback(report.stage, report.fraction).is(py::bool_(false))) throw Cancelled();
}

/// Returns once the work is done. Throws where the caller wants no more of it.
void watch(Mailbox& mailbox, const py::object& callback) {
  for (bool is_more = true; is_more;) {
    std::vector<Report> reports;
    {
      const py::gil_scoped_release unlocked;
      is_more = mailbox.fetch(reports);
    }
    deliver(reports, callback);
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }
}

}  // namespace

void do_long_work(const py::object& report, const std::function<void(const Progress&)>& work) {
  Mailbox mailbox;
  std::stop_source stop;
  std::exception_ptr failure, refusal;
  std::thread worker([&] {
    try {
      work({[&](std::string_view stage, double fraction) { mailbox.put(stage, fraction); }, stop.get_token()});
    } catch (...) {
      failure = std::current_exception();
    }
    mailbox.close();
  });
  try {
    watch(mailbox, report);
  } catch (...) {
    refusal = std::current_exception();
    stop.request_stop();
  }
  {
    const py::gil_scoped_release unlocked;
    worker.join();
  }
  if (refusal) std::rethrow_exception(refusal);
  if (failure) std::rethrow_exception(failure);
}

}  // namespace anatomesh::python
