#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "holotrace/base/observer.h"
#include "holotrace/data/report.h"

namespace holotrace::python {

namespace nb = nanobind;

/// What Python learns of a verb at work: its progress, facts, curves and warnings. The verb runs without the GIL. About
/// 20 times a second, the thread that called the verb takes the GIL, looks for signals, and calls `progress`. An
/// exception there, such as KeyboardInterrupt, stops the verb and reaches the caller.
class Watch {
 public:
  /// @param progress  None, or a function (stage, fraction, status)
  explicit Watch(nb::object progress) : progress_(std::move(progress)) {}

  /// Runs work(observer) without the GIL.
  template <class Work>
  auto run(const std::string& stage, const Work& work) {
    caller_ = std::this_thread::get_id();
    try {
      nb::gil_scoped_release release;
      return work(observer(stage));
    } catch (const Stopped&) {
      std::rethrow_exception(std::exchange(failure_, nullptr));
    }
  }

  /// The observer of a stage. Verbs with several stages make one for each, within `run`.
  Observer observer(const std::string& stage);

  nb::dict facts() const;
  nb::dict curves() const;
  nb::list warnings() const;

 private:
  struct Stopped {};  // not a std::exception: nothing on its way may take it for an Error

  void look_up(const std::string& stage);

  nb::object progress_;
  std::thread::id caller_;
  std::atomic<double> fraction_{0};
  std::atomic<bool> is_stopping_{false};  ///< every thread of the verb ends its work
  std::chrono::steady_clock::time_point last_{};
  std::exception_ptr failure_;
  std::mutex mutex_;  // for what follows
  std::string status_;
  StageReport report_;
};

/// A fact as a value of Python.
nb::object to_python(const Fact& fact);

}  // namespace holotrace::python
