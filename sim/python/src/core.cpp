#include "core.hpp"

#include <algorithm>
#include <thread>

#include "breakaway/input/input_error.hpp"

namespace breakaway::python {
namespace {

// Kept for good: the interpreter may translate errors until it ends.
py::handle input_error_class;

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    const py::object raised = input_error_class(error.what());
    raised.attr("file") = error.file();
    raised.attr("key") = error.key();
    raised.attr("problem") = error.problem().empty() ? std::string{error.what()} : error.problem();
    PyErr_SetObject(input_error_class.ptr(), raised.ptr());
  }
}

constexpr const char* about_input_error =
    "What was given cannot be used. The text is one line that names the place and the remedy;\n"
    "`file`, `key` and `problem` are its parts, and empty where no single one is concerned.";

}  // namespace

int threads_or_all(int threads) {
  if (threads < 0 || threads > 1024) throw InputError{"threads", "must be from 1 to 1024, or 0 for all processors"};
  return threads > 0 ? threads : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
}

}  // namespace breakaway::python

PYBIND11_MODULE(_core, module) {
  using namespace breakaway::python;
  module.doc() = "The extension module behind `import breakaway`.";
  module.attr("version") = BREAKAWAY_VERSION;
  input_error_class = PyErr_NewExceptionWithDoc("breakaway.InputError", about_input_error, PyExc_ValueError, nullptr);
  module.attr("InputError") = input_error_class;
  py::register_exception_translator(&translate);
  add_axis(module);
  add_machine(module);
}
