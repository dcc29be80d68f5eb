// The extension module behind `import breakaway`: each function takes the text of a TOML file and the name that stands
// for it in errors, and gives JSON, the same as the command of its name writes, with arrays beside it. What Python
// users see is in breakaway/__init__.py.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace breakaway::python {

namespace py = pybind11;

void add_axis(py::module_& module);
void add_machine(py::module_& module);

// Numbers of an object that lives as long as an array looks at them: none is copied. `stride_bytes`: from one to the
// next.
template <class Number, class Owner>
py::array_t<Number> view(const std::shared_ptr<Owner>& owner, const Number* first, std::size_t count,
                         std::size_t stride_bytes) {
  const py::capsule keeper{new std::shared_ptr<Owner>{owner},
                           [](void* held) { delete static_cast<std::shared_ptr<Owner>*>(held); }};
  py::array_t<Number> array{{static_cast<py::ssize_t>(count)}, {static_cast<py::ssize_t>(stride_bytes)}, first, keeper};
  array.attr("flags").attr("writeable") = false;
  return array;
}

// A column of records that stand in one vector.
template <class Number, class Owner, class Records, class Field>
py::array_t<Number> column(const std::shared_ptr<Owner>& owner, const Records& records, Field field) {
  if (records.empty()) return py::array_t<Number>{0};
  return view<Number>(owner, &(records.front().*field), records.size(), sizeof(records.front()));
}

// One for each processor where none are said. Throws InputError.
int threads_or_all(int threads);

// Ends a long computation on Ctrl-C: a callback for progress, from any of its threads. Only the one that Python called
// looks for signals, and not so often that other threads of Python would wait for it.
class Interruptible {
 public:
  template <class... Progress>
  void operator()(const Progress&...) {
    if (std::this_thread::get_id() != called_) return;
    const auto now = std::chrono::steady_clock::now();
    if (now < next_look_) return;
    next_look_ = now + std::chrono::milliseconds{50};
    const py::gil_scoped_acquire locked;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set{};
  }

 private:
  std::thread::id called_ = std::this_thread::get_id();
  std::chrono::steady_clock::time_point next_look_{};
};

}  // namespace breakaway::python
