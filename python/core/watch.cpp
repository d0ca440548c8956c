#include "watch.h"

#include <nanobind/stl/string.h>

namespace holotrace::python {

nb::object to_python(const Fact& fact) {
  return std::visit([](const auto& value) { return nb::cast(value); }, fact);
}

void Watch::look_up(const std::string& stage) {
  constexpr std::chrono::milliseconds pause{50};
  if (is_stopping_) throw Stopped();
  if (std::this_thread::get_id() != caller_) return;
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < pause) return;
  last_ = now;
  std::string status;
  {
    const std::lock_guard lock(mutex_);
    status = status_;
  }
  const nb::gil_scoped_acquire acquire;
  try {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!progress_.is_none()) progress_(stage, fraction_.load(), status);
  } catch (...) {
    failure_ = std::current_exception();
    is_stopping_ = true;
    throw Stopped();
  }
}

Observer Watch::observer(const std::string& stage) {
  Observer observer;
  observer.on_progress = [this, stage](double fraction) {
    fraction_ = fraction;
    look_up(stage);
  };
  observer.on_fact = [this](const std::string& name, const Fact& value) {
    const std::lock_guard lock(mutex_);
    report_.facts.emplace_back(name, value);
  };
  observer.on_warning = [this](const std::string& sentence) {
    const std::lock_guard lock(mutex_);
    report_.warnings.push_back(sentence);
  };
  observer.on_curve = [this](const std::string& name, const std::vector<double>& values) {
    const std::lock_guard lock(mutex_);
    report_.curves.emplace_back(name, values);
  };
  observer.on_status = [this](const std::string& text) {
    const std::lock_guard lock(mutex_);
    status_ = text;
  };
  return observer;
}

nb::dict Watch::facts() const {
  nb::dict facts;
  for (const auto& [name, value] : report_.facts) facts[name.c_str()] = to_python(value);
  return facts;
}

nb::dict Watch::curves() const {
  nb::dict curves;
  for (const auto& [name, values] : report_.curves) {
    nb::list list;
    for (const double value : values) list.append(value);
    curves[name.c_str()] = list;
  }
  return curves;
}

nb::list Watch::warnings() const {
  nb::list list;
  for (const std::string& sentence : report_.warnings) list.append(nb::str(sentence.c_str()));
  return list;
}

}  // namespace holotrace::python
